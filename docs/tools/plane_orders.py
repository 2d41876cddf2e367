"""Orders of the exact cases on planes, for docs/planes.md: python docs/tools/plane_orders.py [CELLS ...].

Centroidal Voronoi meshes of random points, and both schemes. 400, 1600, 6400 and 25600 cells take some minutes.
"""

import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass

import numpy as np
from scipy.sparse.linalg import spsolve

from cases import InertiaGravityWave, Manufactured
from cases.plane.base import ExactCase
from mesh import VoronoiMesh, mesh_on_plane
from mesh.arrays import Array
from mesh.discrete.operators import build_operators, normal_component
from mesh.integrals.quadrature import normal_means
from mesh.mesh_request import MeshRequest
from postprocess.compare.norms import scalar_norms
from swe import Simulation
from swe.configuration import SchemeName

CASES: tuple[ExactCase, ...] = (InertiaGravityWave(), Manufactured())
SCHEMES: tuple[SchemeName, ...] = ("ringler2010", "consistent")
CELLS = (400, 1600, 6400, 25600)
PLANE = (1e6, 5e5 * math.sqrt(3.0))


@dataclass(frozen=True)
class Errors:
    """Relative l2 errors of a run when it has ended.

    The velocity is compared with its normal component at the midpoints between cells (`midpoints`), and with what it
    stands for in the equations of the model (`velocity`): see `velocity_of_the_equations`.
    """

    height: float
    velocity: float
    midpoints: float


def velocity_of_the_equations(mesh: VoronoiMesh, case: ExactCase, time: float) -> Array:
    """The exact velocity as one along the normals of edges (n_edges,) that has its vorticity and its divergence.

    Its circulation round triangles is that of the values at the midpoints between cells, on the edges of triangles; its
    flow out of cells is that of the means over their sides. Both sets of values differ by the first order in the
    spacing where a side has its middle elsewhere, so that neither of them has both. From the first to the solution
    leads the gradient of a potential, which solves a Poisson equation at cells.
    """
    velocity, operators = case.evaluated_velocity(time), build_operators(mesh)
    midpoints = normal_component(mesh, *velocity(*mesh.coordinates("edge")))
    missing = operators.divergence @ (normal_means(mesh, velocity) - midpoints)
    # The potential is zero in the first cell: only its differences count.
    laplacian = (operators.divergence @ operators.gradient).tocsc()[1:, 1:]
    potential = np.concatenate([[0.0], spsolve(laplacian, missing[1:])])
    return midpoints + operators.gradient @ potential


def errors_of(case: ExactCase, mesh: VoronoiMesh, scheme: SchemeName) -> Errors:
    """Errors of a run of the days that are recommended for the case."""
    simulation = Simulation(mesh, case, scheme=scheme)
    simulation.run(days=case.recommended_days, progress=False)
    mesh, time, state = simulation.mesh, simulation.time, simulation.state
    height = case.evaluated(case.thickness, time)(*mesh.coordinates("cell"))
    midpoints = normal_component(mesh, *case.evaluated_velocity(time)(*mesh.coordinates("edge")))
    at_edges = [
        scalar_norms(state.normal_velocity, exact, mesh.dc_edge * mesh.dv_edge).l2
        for exact in (velocity_of_the_equations(mesh, case, time), midpoints)
    ]
    return Errors(scalar_norms(state.thickness - case.depth, height - case.depth, mesh.area_cell).l2, *at_edges)


def measured(cells: Sequence[int]) -> Iterator[tuple[ExactCase, SchemeName, int, Errors]]:
    """Case, scheme, number of cells and errors of each run, made while they are asked for."""
    meshes = [mesh_on_plane(MeshRequest(number, plane=PLANE, periodic="xy", start="random")) for number in cells]
    for case in CASES:
        for scheme in SCHEMES:
            for mesh in meshes:
                yield case, scheme, mesh.n_cells, errors_of(case, mesh, scheme)


def orders(coarse: Errors, fine: Errors) -> Errors:
    """Orders of the errors on a mesh of four times as many cells."""
    return Errors(*(math.log2(before / after) for before, after in zip(astuple(coarse), astuple(fine), strict=True)))


def table(cells: Sequence[int]) -> Iterator[str]:
    """Lines of the table of `measured`."""
    yield "| case, scheme | cells | l2 of height | order | l2 of normal velocity | order | at midpoints | order |"
    yield "|---|---|---|---|---|---|---|---|"
    last: Errors | None = None
    for case, scheme, number, errors in measured(cells):
        first = number == cells[0]
        told = [""] * 3 if first or last is None else [f"{order:.2f}" for order in astuple(orders(last, errors))]
        name = f"`{case.name}`, `{scheme}`" if first else ""
        pairs = zip(astuple(errors), told, strict=True)
        yield f"| {name} | {number} | " + " | ".join(f"{_short(value)} | {order}" for value, order in pairs) + " |"
        last = errors


def _short(value: float) -> str:
    return f"{value:.2e}".replace("e-0", "e-")


if __name__ == "__main__":
    for line in table([int(argument) for argument in sys.argv[1:]] or CELLS):
        print(line, flush=True)

"""Local truncation errors of the discrete operators on a mesh: what they make of exact samples of smooth fields.

The flow is that of `postprocess.compare.sphere_flow`, or of `plane_flow` beside it. Operators are given the exact
normal component at the edge points, which lie midway between cell centres, and compared with the exact result at the
place where theirs lives.
"""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import build_operators
from mesh.geometry.sphere import dot
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import Place, VoronoiMesh
from postprocess.compare.norms import Norms, scalar_norms
from postprocess.compare.places import points_at
from postprocess.compare.plane_flow import plane_flow
from postprocess.compare.sphere_flow import SphereFlow
from swe.configuration import Options, SchemeName
from swe.run.composition import SCHEMES

PLACES: tuple[Place, ...] = ("cell", "edge", "vertex")


@dataclass(frozen=True)
class Result:
    """Result of an operator beside the exact one, and the areas that weight them, all on the unit sphere or the plane.

    Values are at edges for the gradient and perp, at cells for the divergence and the kinetic energy, and at vertices
    for the curl.
    """

    values: Array
    exact: Array
    area: Array


@dataclass(frozen=True)
class Results:
    """One result for each operator; names and definitions as in `mesh.discrete.operators.Operators`."""

    gradient: Result
    divergence: Result
    curl: Result
    perp: Result
    kinetic_energy: Result


@dataclass(frozen=True)
class TruncationErrors:
    """Norms of the truncation error of each operator relative to those of the exact result."""

    gradient: Norms
    divergence: Norms
    curl: Norms
    perp: Norms
    kinetic_energy: Norms


def truncation_errors(mesh: VoronoiMesh, scheme: SchemeName = Options.scheme) -> TruncationErrors:
    """Norms, weighted by area, of the truncation errors on `mesh`, which do not depend on its radius."""
    results = vars(apply_operators(mesh, scheme))
    return TruncationErrors(**{name: scalar_norms(one.values, one.exact, one.area) for name, one in results.items()})


def apply_operators(mesh: VoronoiMesh, scheme: SchemeName = Options.scheme) -> Results:
    """Apply the operators of `mesh`, from a sphere scaled to the unit sphere, to the flow.

    The gradient is applied to its streamfunction.

    The kinetic energy is that of the scheme, all others are the same for every scheme.
    """
    mesh = mesh.scaled(1.0) if mesh.on_a_sphere else mesh
    flow = SphereFlow() if mesh.on_a_sphere else plane_flow(mesh)
    operators, surface = build_operators(mesh), surface_of(mesh)
    cells, edges, vertices = (points_at(surface, *mesh.coordinates(place)) for place in PLACES)
    east, north = surface.axes(mesh.lon_edge, mesh.lat_edge)
    normal = np.cos(mesh.angle_edge)[:, None] * east + np.sin(mesh.angle_edge)[:, None] * north
    tangent = np.cross(surface.outward(edges), normal)
    normal_velocity = dot(flow.velocity(edges), normal)
    speed = np.linalg.norm(flow.velocity(cells), axis=1)
    kinetic_energy = np.empty(mesh.n_cells)
    SCHEMES[scheme](mesh).kinetic_energy(normal_velocity, kinetic_energy)
    # Twice the quadrilateral of an edge's cells and vertices; only the ratios of the weights matter.
    area_edge = mesh.dc_edge * mesh.dv_edge
    return Results(
        Result(
            operators.gradient @ flow.streamfunction(cells),
            dot(flow.streamfunction_gradient(edges), normal),
            area_edge,
        ),
        Result(operators.divergence @ normal_velocity, flow.divergence(cells), mesh.area_cell),
        Result(operators.curl @ normal_velocity, flow.vorticity(vertices), mesh.area_triangle),
        Result(operators.perp @ normal_velocity, dot(flow.velocity(edges), tangent), area_edge),
        Result(kinetic_energy, 0.5 * speed**2, mesh.area_cell),
    )

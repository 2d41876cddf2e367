"""Families of meshes that a study compares: same number of cells, different quality."""

from collections.abc import Callable
from dataclasses import dataclass

from mesh.density.named import NAMED
from mesh.discrete.build import mesh_from_points
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits
from mesh.generation.pipeline import generate_mesh, mesh_of
from mesh.generation.scvt import UNIFORM_TOLERANCE, VARIABLE_TOLERANCE, generate_scvt, starting_mesh
from mesh.mesh_request import MeshRequest
from mesh.voronoi_mesh import VoronoiMesh

STOPPED_RESIDUALS = (2e-2, 1e-2, 1e-3)
"""Centroid residuals, in mean spacings, at which Lloyd's method is stopped early; bisected icosahedra have 0.037."""

NESTED_SHARE = 4
"""A nested mesh refines an SCVT with a fourth of the cells asked for, and has somewhat more than half of them."""


@dataclass(frozen=True)
class Family:
    """A way to make a mesh of about a given number of cells."""

    description: str
    make: Callable[[int], VoronoiMesh]


def _bisection(cells: int) -> VoronoiMesh:
    points, triangles = starting_mesh(cells, "icosahedral")
    return mesh_from_points(points, triangles)


def _scvt(
    tolerance: float, start: str | None = None, density: str = "uniform", method: str = "lbfgs"
) -> Callable[[int], VoronoiMesh]:
    """A function that makes an SCVT, the first iterate whose residual is below `tolerance`."""

    def make(cells: int) -> VoronoiMesh:
        return generate_mesh(MeshRequest(cells, density, start, method, tolerance)).mesh

    return make


def _nested(cells: int) -> VoronoiMesh:
    coarse = generate_scvt(MeshRequest((cells - 2) // NESTED_SHARE + 2))
    density = NAMED["refined-box"]
    result = nested_scvt(coarse.points, coarse.triangles, density, limits=Limits(VARIABLE_TOLERANCE))
    return mesh_of(result, density)


FAMILIES = {
    "bisection": Family("bisected icosahedron, not optimised", _bisection),
    **{
        f"stopped-{residual:.0e}": Family(
            f"icosahedral SCVT, Lloyd's method stopped at a residual of {residual:g} mean spacings",
            _scvt(residual, "icosahedral", method="lloyd"),
        )
        for residual in STOPPED_RESIDUALS
    },
    "scvt": Family("icosahedral SCVT, converged", _scvt(UNIFORM_TOLERANCE)),
    "random": Family("SCVT from random points, converged", _scvt(VARIABLE_TOLERANCE, "random")),
    "refined-circle": Family(
        "SCVT refined in a circle, converged", _scvt(VARIABLE_TOLERANCE, None, "refined-circle", "multilevel")
    ),
    "nested": Family("SCVT of a fourth of the cells, refined in a box", _nested),
}
"""Families by name."""

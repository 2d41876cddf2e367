"""Spherical centroidal Voronoi tessellations: from a number of cells to converged generators."""

from dataclasses import dataclass, field

import numpy as np

from mesh.arrays import Array, Index
from mesh.density import Density, uniform
from mesh.errors import MeshError
from mesh.generators import DEFAULT_SEED, MAXIMUM_CELLS, bisect, icosahedral_level, icosahedral_mesh, starting_points
from mesh.optimizer import Callback, Limits, Optimizer, ScvtResult
from mesh.ordering import hilbert_order, renumber
from mesh.probabilistic import MACQUEEN, Weights, probabilistic_lloyd

METHODS = ("lbfgs", "lloyd", "multilevel", "probabilistic", "macqueen")
COARSEST_LEVEL = 3
"""Bisection level of the coarsest mesh that the multilevel method converges."""

COARSE_TOLERANCE = 1e-3
"""Residual at which the multilevel method goes on to the next finer mesh; tighter ones save no time."""

ADVICE = {
    "iterations": "allow more iterations",
    "seconds": "allow more time",
    "round-off": "round-off allows no further step; ask for a larger tolerance",
}


@dataclass(frozen=True)
class Request:
    """What an SCVT is to be: see `starting_points` for `start`, `mesh.density` for `density`.

    `method` is `lbfgs`, `lloyd`, `multilevel` (L-BFGS on icosahedral meshes from coarse to fine), `probabilistic` or
    `macqueen`. `weights` steer the probabilistic method, `seed` all that is random.
    """

    cells: int
    start: str | None = None
    method: str = "lbfgs"
    density: Density = uniform
    seed: int = DEFAULT_SEED
    weights: Weights = field(default_factory=Weights)


def optimize(
    points: Array,
    triangles: Index | None = None,
    request: Request | None = None,
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move unit vectors `points` (n_cells, 3) towards an SCVT with the method and density of `request`.

    `triangles` may give a valid triangulation. Stops at the `limits`. Raises `MeshError` for an unknown method, or
    where the points cannot be triangulated or the density cannot be used.
    """
    request = Request(len(points)) if request is None else request
    limits = Limits() if limits is None else limits
    if request.method in ("probabilistic", "macqueen"):
        weights = MACQUEEN if request.method == "macqueen" else request.weights
        return probabilistic_lloyd(points, request.density, weights, request.seed, limits, callback)
    method = "lbfgs" if request.method == "multilevel" else request.method
    density = None if request.density is uniform else request.density
    return Optimizer(points, triangles, method, density).run(limits, callback)


def generate_scvt(request: Request, limits: Limits | None = None, callback: Callback | None = None) -> ScvtResult:
    """Converged generators of an SCVT, numbered along a space-filling curve.

    Raises `MeshError` for unknown names, fewer than 12 cells, or where the tolerance of the `limits` is not reached.
    """
    if request.method not in METHODS:
        raise MeshError(f"there is no optimisation method named '{request.method}'; choose one of {', '.join(METHODS)}")
    limits = Limits() if limits is None else limits
    start = _multilevel_start(request, limits) if request.method == "multilevel" else starting_mesh(request)
    result = optimize(*start, request, limits, callback)
    check_converged(result, limits)
    return result


def check_converged(result: ScvtResult, limits: Limits) -> None:
    """Raise `MeshError`, with what would help, where the tolerance is not reached."""
    residual = result.history.residual[-1]
    if residual > limits.tolerance:
        raise MeshError(
            f"the mesh of {len(result.points)} cells stands at a centroid residual of {residual:.1e} mean spacings "
            f"after {result.history.iterations} iterations and does not reach the tolerance {limits.tolerance:.1e}: "
            f"{ADVICE[result.reason]}"
        )


def starting_mesh(request: Request) -> tuple[Array, Index | None]:
    """Starting points along a space-filling curve, and their triangles where bisection gives them."""
    level = icosahedral_level(request.cells) if request.start in (None, "icosahedral") else None
    if level is not None and request.cells <= MAXIMUM_CELLS:
        return renumber(*icosahedral_mesh(level))
    points = starting_points(request.cells, request.start, request.density, request.seed)
    return np.ascontiguousarray(points[hilbert_order(points)]), None


def _multilevel_start(request: Request, limits: Limits) -> tuple[Array, Index]:
    """Points and triangles bisected from a converged mesh of the next coarser level, and so on down."""
    level = icosahedral_level(request.cells)
    if level is None or request.start not in (None, "icosahedral"):
        raise MeshError(
            f"the multilevel method bisects the icosahedron, which gives no mesh of {request.cells} cells from "
            f"{request.start or 'any start'}; choose another number, such as 10242, or the method lbfgs"
        )
    points, triangles = renumber(*icosahedral_mesh(min(COARSEST_LEVEL, level)))
    for _ in range(COARSEST_LEVEL, level):
        loose = Limits(max(COARSE_TOLERANCE, limits.tolerance), limits.iterations, limits.seconds)
        coarse = optimize(points, triangles, request, loose)
        refined, children, _ = bisect(coarse.points, coarse.triangles)
        points, triangles = renumber(refined, children)
    return points, triangles

"""Spherical centroidal Voronoi tessellations: from a number of cells to converged generators."""

from mesh.arrays import Array, Index
from mesh.errors import MeshError
from mesh.generators import MINIMUM_CELLS, bisect, icosahedral_level, icosahedral_mesh, starting_points
from mesh.optimizer import Callback, Limits, Optimizer, ScvtResult
from mesh.ordering import hilbert_order, renumber

METHODS = ("lbfgs", "lloyd", "multilevel")
COARSEST_LEVEL = 3
"""Bisection level of the coarsest mesh that the multilevel method converges."""

COARSE_TOLERANCE = 1e-3
"""Residual at which the multilevel method goes on to the next finer mesh; tighter ones save no time."""


def optimize(
    points: Array,
    triangles: Index | None = None,
    method: str = "lbfgs",
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move unit vectors `points` (n_cells, 3) towards an SCVT; see `Optimizer` for the arguments.

    Raises `MeshError` for an unknown method, or where the points cannot be triangulated.
    """
    return Optimizer(points, triangles, method).run(Limits() if limits is None else limits, callback)


def generate_scvt(
    cells: int,
    start: str | None = None,
    method: str = "lbfgs",
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> ScvtResult:
    """Converged generators of an SCVT with this number of cells, numbered along a space-filling curve.

    `method` is `lbfgs`, `lloyd` or `multilevel`, which converges coarse icosahedral meshes first. Raises `MeshError`
    for unknown names, fewer than 12 cells, or where the tolerance is not reached.
    """
    if method not in METHODS:
        raise MeshError(f"there is no optimisation method named '{method}'; choose one of {', '.join(METHODS)}")
    limits = Limits() if limits is None else limits
    if method == "multilevel":
        result = _multilevel(cells, start, limits, callback)
    else:
        result = optimize(*starting_mesh(cells, start), method, limits, callback)
    residual = result.history.residual[-1]
    if residual > limits.tolerance:
        raise MeshError(
            f"the mesh of {cells} cells stands at a centroid residual of {residual:.1e} mean spacings after "
            f"{result.history.iterations} iterations and does not reach the tolerance {limits.tolerance:.1e}: "
            f"{ADVICE[result.reason]}"
        )
    return result


ADVICE = {
    "iterations": "allow more iterations",
    "seconds": "allow more time",
    "round-off": "round-off allows no further step; ask for a larger tolerance",
}


def starting_mesh(cells: int, start: str | None) -> tuple[Array, Index | None]:
    """Starting points along a space-filling curve, and their triangles where bisection gives them."""
    level = icosahedral_level(cells) if start in (None, "icosahedral") else None
    if level is not None and cells >= MINIMUM_CELLS:
        return renumber(*icosahedral_mesh(level))
    points = starting_points(cells, start)
    return points[hilbert_order(points)], None


def _multilevel(cells: int, start: str | None, limits: Limits, callback: Callback | None) -> ScvtResult:
    level = icosahedral_level(cells)
    if level is None or start not in (None, "icosahedral"):
        raise MeshError(
            f"the multilevel method bisects the icosahedron, which gives no mesh of {cells} cells from "
            f"{start or 'any start'}; choose another number, such as 10242, or the method lbfgs"
        )
    points, triangles = renumber(*icosahedral_mesh(min(COARSEST_LEVEL, level)))
    for _ in range(COARSEST_LEVEL, level):
        coarse = optimize(points, triangles, limits=Limits(max(COARSE_TOLERANCE, limits.tolerance)))
        refined, children, _ = bisect(coarse.points, coarse.triangles)
        points, triangles = renumber(refined, children)
    return optimize(points, triangles, "lbfgs", limits, callback)

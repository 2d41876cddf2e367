"""Spherical centroidal Voronoi tessellations: from a number of cells to converged generators."""

import time
import warnings
from dataclasses import dataclass, replace

import numpy as np

from mesh.arrays import Array, Index
from mesh.density.named import Density, uniform
from mesh.errors import HemisphereError, MeshError, MeshWarning
from mesh.generation.generators import (
    DEFAULT_SEED,
    MAXIMUM_CELLS,
    bisect,
    icosahedral_level,
    icosahedral_mesh,
    starting_points,
)
from mesh.generation.optimizer import Callback, Limits, Optimizer, ScvtResult
from mesh.generation.probabilistic import MACQUEEN, Blend, probabilistic_lloyd
from mesh.triangulation.ordering import hilbert_order, renumber

SAMPLING_METHODS = {"probabilistic": Blend(), "macqueen": MACQUEEN}
METHODS = ("lbfgs", "lloyd", "multilevel", *SAMPLING_METHODS)
COARSEST_LEVEL = 3
"""Bisection level of the coarsest mesh that the multilevel method converges."""

COARSE_TOLERANCE = 1e-3
"""Residual at which the multilevel method goes on to the next finer mesh; tighter ones save no time."""

ADVICE = {
    "iterations": "allow more iterations",
    "seconds": "allow more time",
    "round-off": "round-off allows no further step; ask for a larger tolerance",
    "quadrature": "the density jumps or changes much within a cell; smooth it, start from random-root, ask for more "
    "cells or for a larger tolerance",
}


@dataclass(frozen=True)
class Request:
    """What an SCVT is to be: see `starting_points` for `start`, `mesh.density.named` for `density`.

    `method` is `lbfgs`, `lloyd`, `multilevel` (L-BFGS on icosahedral meshes from coarse to fine), `probabilistic` or
    `macqueen`; `seed` steers all that is random.
    """

    cells: int
    start: str | None = None
    method: str = "lbfgs"
    density: Density = uniform
    seed: int = DEFAULT_SEED


def optimize(
    points: Array,
    triangles: Index | None = None,
    method: str = "lbfgs",
    density: Density = uniform,
    limits: Limits | None = None,
    callback: Callback | None = None,
    seed: int = DEFAULT_SEED,
) -> ScvtResult:
    """Move unit vectors `points` (n_cells, 3) towards an SCVT of the `density`; see `Request` for the methods.

    `triangles` may give a valid triangulation. Stops at the `limits`. Raises `MeshError` for an unknown method, or
    where the points cannot be triangulated or the density cannot be used.
    """
    limits = Limits() if limits is None else limits
    if method in SAMPLING_METHODS:
        return probabilistic_lloyd(points, density, SAMPLING_METHODS[method], seed, limits, callback)
    descent = "lbfgs" if method == "multilevel" else method
    if density is uniform:
        return Optimizer(points, triangles, descent).run(limits, callback)
    try:
        return Optimizer(points, triangles, descent, density).run(limits, callback)
    except HemisphereError as error:
        raise MeshError(
            f"the density draws {len(points)} generators to one hemisphere; ask for more cells, or give it a floor"
        ) from error


def generate_scvt(request: Request, limits: Limits | None = None, callback: Callback | None = None) -> ScvtResult:
    """Converged generators of an SCVT, numbered along a space-filling curve.

    The seconds of the `limits` are for the whole call, the iterations for each optimisation in it. Raises
    `MeshError` for unknown names, fewer than 12 cells, or where the tolerance of the `limits` is not reached.
    """
    if request.method not in METHODS:
        raise MeshError(f"there is no optimisation method named '{request.method}'; choose one of {', '.join(METHODS)}")
    begin = time.perf_counter()
    limits = Limits() if limits is None else limits
    start = _multilevel_start(request, limits, begin) if request.method == "multilevel" else starting_mesh(request)
    result = optimize(*start, request.method, request.density, limits.since(begin), callback, request.seed)
    check_converged(result, limits)
    return result


def check_converged(result: ScvtResult, limits: Limits) -> None:
    """Raise `MeshError`, with what would help, where the tolerance is not reached.

    Warns with `MeshWarning` where the residual is acceptable only (see `Limits`).
    """
    residual = result.history.residual[-1]
    if result.reason == "quadrature" and residual <= limits.acceptable:
        warnings.warn(
            f"the mesh of {len(result.points)} cells is taken as converged at a centroid residual of {residual:.1e} "
            f"mean spacings; kinks of the density do not let it fall to {limits.tolerance:.1e}",
            MeshWarning,
            stacklevel=3,
        )
    elif residual > limits.tolerance:
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


def _multilevel_start(request: Request, limits: Limits, begin: float) -> tuple[Array, Index]:
    """Points and triangles bisected from a converged mesh of the next coarser level, and so on down.

    The seconds of the `limits` count from `begin`.
    """
    level = icosahedral_level(request.cells)
    if level is None or request.start not in (None, "icosahedral"):
        raise MeshError(
            f"the multilevel method bisects the icosahedron, which gives no mesh of {request.cells} cells from "
            f"{request.start or 'any start'}; choose another number, such as 10242, or the method lbfgs"
        )
    points, triangles = renumber(*icosahedral_mesh(min(COARSEST_LEVEL, level)))
    for _ in range(COARSEST_LEVEL, level):
        loose = replace(limits.since(begin), tolerance=max(COARSE_TOLERANCE, limits.tolerance))
        coarse = optimize(points, triangles, request.method, request.density, loose)
        refined, children, _ = bisect(coarse.points, coarse.triangles)
        points, triangles = renumber(refined, children)
    return points, triangles

"""Spherical centroidal Voronoi tessellations: from a number of cells to converged generators."""

import os
import time
import warnings
from dataclasses import replace

import numpy as np

from mesh.arrays import Array, Index
from mesh.density.gridded import Shaping, find_density
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
from mesh.mesh_request import MeshRequest
from mesh.triangulation.ordering import hilbert_order, renumber

SAMPLING_METHODS = {"probabilistic": Blend(), "macqueen": MACQUEEN}
METHODS = ("lbfgs", "lloyd", "multilevel", *SAMPLING_METHODS)

UNIFORM_TOLERANCE, VARIABLE_TOLERANCE = Limits.tolerance, 1e-6
"""Centroid residuals, in mean spacings, at which an SCVT counts as converged."""

ACCEPTABLE = 1e-4
"""The same where quadrature of the density ends the descent: kinks between values of a coarse field leave less."""

SAMPLING_TOLERANCES = {"probabilistic": (0.02, 0.2), "macqueen": (0.1, 0.5)}
"""The same, under uniform and any other density, for the methods whose residual falls like the root of the samples."""

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


def density_of(request: MeshRequest) -> Density:
    """The density that is asked for, as a function, read where it is the name of a file.

    Raises `MeshError` where there is none of that name, or where one is to be shaped that is not from a file.
    """
    shaping = Shaping(request.density_floor, request.density_power, request.density_smoothing)
    if isinstance(request.density, str | os.PathLike):
        return find_density(os.fspath(request.density), request.density_variable, shaping)
    if (shaping, request.density_variable) != (Shaping(), MeshRequest.density_variable):
        raise MeshError(
            "a density that is a function cannot be shaped; variable, floor, power and smoothing are for fields from "
            "files"
        )
    return request.density


def cells_of(request: MeshRequest) -> int:
    """The number of cells that is asked for; raise `MeshError` where there is none."""
    if request.cells is None:
        raise MeshError("the number of cells is missing; give --cells N")
    return request.cells


def default_tolerance(density: object, method: str = MeshRequest.method) -> float:
    """The residual to ask for under a density: quadrature does not allow as small a one as uniform density does.

    Methods that sample the density have the error of their samples: what thousands of cells reach in a minute or so.
    """
    uniform_tolerance, other = SAMPLING_TOLERANCES.get(method, (UNIFORM_TOLERANCE, VARIABLE_TOLERANCE))
    return uniform_tolerance if density in ("uniform", uniform) else other


def limits_of(request: MeshRequest) -> Limits:
    """Limits of the optimisation that is asked for; without a tolerance, the default one.

    Kinks of a density may not allow that, and then a residual of `ACCEPTABLE` will do.
    """
    if request.tolerance is not None:
        return Limits(request.tolerance, request.max_iterations, request.max_seconds)
    tolerance = default_tolerance(request.density, request.method)
    return Limits(tolerance, request.max_iterations, request.max_seconds, ACCEPTABLE)


def optimize(
    points: Array,
    triangles: Index | None = None,
    method: str = MeshRequest.method,
    density: Density = uniform,
    limits: Limits | None = None,
    callback: Callback | None = None,
    seed: int = DEFAULT_SEED,
) -> ScvtResult:
    """Move unit vectors `points` (n_cells, 3) towards an SCVT of the `density`; see `MeshRequest` for the methods.

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


def generate_scvt(request: MeshRequest, callback: Callback | None = None) -> ScvtResult:
    """Converged generators of an SCVT as asked for, without regard to `nested` and `well_centered`.

    They are numbered along a space-filling curve. Raises `MeshError` as `converge` does.
    """
    return converge(request, density_of(request), limits_of(request), callback)


def converge(request: MeshRequest, density: Density, limits: Limits, callback: Callback | None = None) -> ScvtResult:
    """Converged generators by number, start, method and seed of the `request`, along a space-filling curve.

    The seconds of the `limits` are for the whole call, the iterations for each optimisation in it. Raises
    `MeshError` for unknown names, fewer than 12 cells, or where the tolerance of the `limits` is not reached.
    """
    begin = time.perf_counter()
    cells, method = cells_of(request), request.method
    if method not in METHODS:
        raise MeshError(f"there is no optimisation method named '{method}'; choose one of {', '.join(METHODS)}")
    points, triangles = (
        _multilevel_start(cells, request.start, density, limits, begin)
        if method == "multilevel"
        else starting_mesh(cells, request.start, density, request.seed)
    )
    result = optimize(points, triangles, method, density, limits.since(begin), callback, request.seed)
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


def starting_mesh(
    cells: int, start: str | None = None, density: Density = uniform, seed: int = DEFAULT_SEED
) -> tuple[Array, Index | None]:
    """Starting points along a space-filling curve, and their triangles where bisection gives them."""
    level = icosahedral_level(cells) if start in (None, "icosahedral") else None
    if level is not None and cells <= MAXIMUM_CELLS:
        return renumber(*icosahedral_mesh(level))
    points = starting_points(cells, start, density, seed)
    return np.ascontiguousarray(points[hilbert_order(points)]), None


def _multilevel_start(
    cells: int, start: str | None, density: Density, limits: Limits, begin: float
) -> tuple[Array, Index]:
    """Points and triangles bisected from a converged mesh of the next coarser level, and so on down.

    The seconds of the `limits` count from `begin`.
    """
    level = icosahedral_level(cells)
    if level is None or start not in (None, "icosahedral"):
        raise MeshError(
            f"the multilevel method bisects the icosahedron, which gives no mesh of {cells} cells from "
            f"{start or 'any start'}; choose another number, such as 10242, or the method lbfgs"
        )
    points, triangles = renumber(*icosahedral_mesh(min(COARSEST_LEVEL, level)))
    for _ in range(COARSEST_LEVEL, level):
        loose = replace(limits.since(begin), tolerance=max(COARSE_TOLERANCE, limits.tolerance))
        coarse = optimize(points, triangles, "multilevel", density, loose)
        refined, children, _ = bisect(coarse.points, coarse.triangles)
        points, triangles = renumber(refined, children)
    return points, triangles

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
    refine,
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
"""Residual that will do where quadrature of the density ends the descent: kinks of a coarse field allow no better."""

SAMPLING_TOLERANCES = {"probabilistic": (0.02, 0.2), "macqueen": (0.1, 0.5)}
"""Tolerances, under uniform and any other density, of the methods whose residual falls like the root of the samples."""

COARSEST_LEVEL = 3
"""Bisection level of the coarsest mesh that the multilevel method converges."""

COARSE_TOLERANCE = 1e-3
"""Residual at which the multilevel method moves to the next finer mesh; a smaller one saves no time."""

MOST_COARSEST_CELLS = 400
"""A mesh under a density starts with one of no more cells than this, which converges in no time from any start."""

ADVICE = {
    "iterations": "allow more iterations",
    "seconds": "allow more time",
    "round-off": "round-off allows no further step; ask for a larger tolerance",
    "quadrature": "the density jumps or changes much within a cell; smooth it, start from random-root, ask for more "
    "cells or for a larger tolerance",
}


def density_of(request: MeshRequest) -> Density:
    """The requested density as a function, read if it is the name of a file.

    Raises `MeshError` if there is none of that name, or if one that is not from a file should be shaped.
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
    """The requested number of cells; raise `MeshError` if there is none."""
    if request.cells is None:
        raise MeshError("the number of cells is missing; give --cells N")
    return request.cells


def default_tolerance(density: object, method: str = MeshRequest.method) -> float:
    """The residual to ask for: quadrature of a density does not allow one as small as uniform density does.

    Methods that sample the density carry sampling errors; theirs is what thousands of cells reach in about a minute.
    """
    uniform_tolerance, other = SAMPLING_TOLERANCES.get(method, (UNIFORM_TOLERANCE, VARIABLE_TOLERANCE))
    return uniform_tolerance if density in ("uniform", uniform) else other


def limits_of(request: MeshRequest) -> Limits:
    """Limits of the requested optimisation, with the default tolerance if none is given.

    Where kinks of the density do not allow that, a residual of `ACCEPTABLE` will do.
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
    """Converged generators of the requested SCVT; `nested` and `well_centered` are ignored.

    They are numbered along a space-filling curve. Raises `MeshError` as `converge` does.
    """
    return converge(request, density_of(request), limits_of(request), callback)


def converge(request: MeshRequest, density: Density, limits: Limits, callback: Callback | None = None) -> ScvtResult:
    """Converged generators by number, start, method and seed of the `request`, along a space-filling curve.

    The seconds of the `limits` are for the whole call, the iterations for each optimisation in it. Raises
    `MeshError` for unknown names, fewer than 12 cells, or if the tolerance of the `limits` is not reached.
    """
    begin = time.perf_counter()
    cells, method = cells_of(request), request.method
    triangles: Index | None
    if method not in METHODS:
        raise MeshError(f"there is no optimisation method named '{method}'; choose one of {', '.join(METHODS)}")
    if method == "multilevel":
        points, triangles = _multilevel_start(cells, request.start, density, limits, begin)
    elif method == "lbfgs" and request.start is None and density is not uniform:
        points, triangles = _refined_start(cells, density, limits, begin)
    else:
        points, triangles = starting_mesh(cells, request.start, density, request.seed)
    result = optimize(points, triangles, method, density, limits.since(begin), callback, request.seed)
    check_converged(result, limits)
    return result


def check_converged(result: ScvtResult, limits: Limits) -> None:
    """Raise `MeshError`, saying what would help, if the tolerance is not reached.

    Warns with `MeshWarning` if the residual is merely acceptable (see `Limits`).
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
        coarse = optimize(points, triangles, "multilevel", density, _loose(limits, begin))
        refined, children, _ = bisect(coarse.points, coarse.triangles)
        points, triangles = renumber(refined, children)
    return points, triangles


def _refined_start(cells: int, density: Density, limits: Limits, begin: float) -> tuple[Array, Index | None]:
    """Points refined from a converged mesh of a quarter as many cells, and so on down, and triangles if known.

    They are spread as the density asks, which takes a mesh of its full size hundreds of iterations. A coarse mesh
    whose generators the density draws to one hemisphere is left out.
    """
    counts = [cells]
    while counts[0] > MOST_COARSEST_CELLS:
        counts.insert(0, (counts[0] + 6) // 4)
    points, triangles = starting_mesh(counts[0])
    for finer in counts[1:]:
        try:
            coarse = Optimizer(points, triangles, density=density).run(_loose(limits, begin))
        except HemisphereError:
            points, triangles = starting_mesh(finer)
        else:
            points, triangles = renumber(*refine(coarse.points, coarse.triangles, finer))
    return points, triangles


def _loose(limits: Limits, begin: float) -> Limits:
    """Limits for a coarse mesh, with the rest of the seconds since `begin`."""
    return replace(limits.since(begin), tolerance=max(COARSE_TOLERANCE, limits.tolerance))

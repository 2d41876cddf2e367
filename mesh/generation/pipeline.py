"""From a number of cells to an SCVT: defaults, and the mesh that comes of the generators."""

import os
from dataclasses import replace

from mesh.density.gridded import find_density
from mesh.density.named import Density, uniform
from mesh.density.record import name_of, source_of
from mesh.discrete.build import mesh_from_points
from mesh.generation.generators import DEFAULT_SEED
from mesh.generation.optimizer import Callback, Limits, ScvtResult
from mesh.generation.scvt import Request, generate_scvt
from mesh.plain import plain_count, plain_number
from mesh.voronoi_mesh import VoronoiMesh

UNIFORM_TOLERANCE, VARIABLE_TOLERANCE = 1e-8, 1e-6
"""Centroid residuals, in mean spacings, at which an SCVT counts as converged."""

ACCEPTABLE = 1e-4
"""The same where quadrature of the density ends the descent: kinks between values of a coarse field leave less."""

SAMPLING_TOLERANCES = {"probabilistic": (0.02, 0.2), "macqueen": (0.1, 0.5)}
"""The same, under uniform and any other density, for the methods whose residual falls like the root of the samples."""


def default_tolerance(density: str | Density, method: str = "lbfgs") -> float:
    """The residual to ask for under a density: quadrature does not allow as small a one as uniform density does.

    Methods that sample the density have the error of their samples: what thousands of cells reach in a minute or so.
    """
    uniform_tolerance, other = SAMPLING_TOLERANCES.get(method, (UNIFORM_TOLERANCE, VARIABLE_TOLERANCE))
    return uniform_tolerance if density in ("uniform", uniform) else other


def default_limits(
    density: str | Density,
    method: str,
    tolerance: float | None = None,
    iterations: int = 10_000,
    seconds: float = float("inf"),
) -> Limits:
    """Limits of an optimisation; without a tolerance, the default one.

    Kinks of a density may not allow that, and then a residual of `ACCEPTABLE` will do.
    """
    if tolerance is not None:
        return Limits(tolerance, iterations, seconds)
    return Limits(default_tolerance(density, method), iterations, seconds, ACCEPTABLE)


def mesh_of(result: ScvtResult, density: Density) -> VoronoiMesh:
    """The validated mesh, on the unit sphere, of generators that were optimised for a `density`, and tells of that."""
    mesh = mesh_from_points(result.points, result.triangles, density, name_of(density))
    return replace(mesh, density_source=source_of(density), fixed_cells=result.fixed)


def scvt_mesh(
    cells: int,
    density: str | os.PathLike[str] | Density = "uniform",
    start: str | None = None,
    method: str = "lbfgs",
    tolerance: float | None = None,
    max_iterations: int = 10_000,
    seed: int = DEFAULT_SEED,
    callback: Callback | None = None,
) -> VoronoiMesh:
    """A validated SCVT on the unit sphere; see `mesh.generation.scvt.Request` for the arguments.

    `density` is a name, the name of a NetCDF file, or any callable (see `mesh.density.named`). It decides, with the
    method, on the tolerance where none is given. Starts from the bisected icosahedron where that has this number of
    cells, else from the Fibonacci spiral.
    """
    function = find_density(os.fspath(density)) if isinstance(density, str | os.PathLike) else density
    cells, seed = plain_count("the number of cells", cells), plain_count("the seed", seed)
    max_iterations = plain_count("the largest number of iterations", max_iterations)
    if tolerance is not None:
        tolerance = plain_number("the tolerance", tolerance)
    request = Request(cells, start, method, function, seed)
    limits = default_limits(function, method, tolerance, max_iterations)
    return mesh_of(generate_scvt(request, limits, callback), function)

"""From generators to a validated mesh, and from a number of cells to an SCVT."""

import os
from dataclasses import replace

import numpy as np

from mesh.arrays import Array, Index
from mesh.delaunay import delaunay
from mesh.density import Density, density_at, uniform
from mesh.density_record import name_of, source_of
from mesh.errors import MeshError
from mesh.generators import DEFAULT_SEED
from mesh.gridded_density import find_density
from mesh.metrics import compute_metrics
from mesh.optimizer import Callback, Limits, ScvtResult
from mesh.plain import plain_count, plain_number
from mesh.scvt import Request, generate_scvt
from mesh.sphere import normalize
from mesh.topology import build_topology
from mesh.validate import validate_mesh
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES, VoronoiMesh

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


def mesh_from_points(
    points: Array, triangles: Index | None = None, density: Density = uniform, density_name: str = ""
) -> VoronoiMesh:
    """The validated Voronoi mesh, on the unit sphere, of generators `points` (n_cells, 3).

    Points are projected onto the sphere. `triangles` may give their Delaunay triangulation, `density` and its name
    what the mesh was generated for. Raises `MeshError` where points are not finite, coincide or do not surround the
    sphere.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError(f"generators must have shape (n_cells, 3), not {points.shape}")
    lengths = np.linalg.norm(points, axis=1)
    wrong = np.flatnonzero(~(np.isfinite(lengths) & (lengths > 0.0)))
    if len(wrong):
        raise MeshError(f"generator {wrong[0]} is {points[wrong[0]].tolist()}, which is no point on a sphere")
    points = normalize(points)
    topology = build_topology(delaunay(points) if triangles is None else triangles, len(points))
    metrics = compute_metrics(points, topology)
    mesh = VoronoiMesh(
        **{name: getattr(topology, name) for name in TOPOLOGY_NAMES},
        **{name: getattr(metrics, name) for name in METRICS_NAMES},
        mesh_density=density_at(density, points),
        sphere_radius=1.0,
        density_name=density_name,
    )
    validate_mesh(mesh, fresh_metrics=True)
    return mesh


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
    """A validated SCVT on the unit sphere; see `mesh.scvt.Request` for the arguments.

    `density` is a name, the name of a NetCDF file, or any callable (see `mesh.density`). It decides, with the method,
    on the tolerance where none is given. Starts from the bisected icosahedron where that has this number of cells, else
    from the Fibonacci spiral.
    """
    function = find_density(os.fspath(density)) if isinstance(density, str | os.PathLike) else density
    cells, seed = plain_count("the number of cells", cells), plain_count("the seed", seed)
    max_iterations = plain_count("the largest number of iterations", max_iterations)
    if tolerance is not None:
        tolerance = plain_number("the tolerance", tolerance)
    request = Request(cells, start, method, function, seed)
    limits = default_limits(function, method, tolerance, max_iterations)
    return mesh_of(generate_scvt(request, limits, callback), function)

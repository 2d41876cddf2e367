"""From generators to a validated mesh."""

from typing import Any

import numpy as np

from mesh.arrays import Array, Index
from mesh.density.named import Density, density_at, uniform
from mesh.discrete.metrics import compute_metrics
from mesh.discrete.topology import build_topology
from mesh.discrete.validate import validate_mesh
from mesh.errors import MeshError
from mesh.geometry.sphere import normalize
from mesh.triangulation.delaunay import delaunay
from mesh.validated import remember_validated
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES, Metrics, Topology, VoronoiMesh


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
        raise MeshError(f"generator {wrong[0]} is {points[wrong[0]].tolist()}, which is not a point on the sphere")
    points = normalize(points)
    topology = build_topology(delaunay(points) if triangles is None else triangles, len(points))
    metrics = compute_metrics(points, topology)
    return validated(topology, metrics, mesh_density=density_at(density, points), density_name=density_name)


def validated(topology: Topology, metrics: Metrics, sphere_radius: float = 1.0, **others: Any) -> VoronoiMesh:
    """The mesh of this connectivity, these metrics, and `others` of its attributes; raise `MeshError` if it is none."""
    mesh = VoronoiMesh(
        **{name: getattr(topology, name) for name in TOPOLOGY_NAMES},
        **{name: getattr(metrics, name) for name in METRICS_NAMES},
        sphere_radius=sphere_radius,
        **others,
    )
    validate_mesh(mesh, fresh_metrics=True)
    remember_validated(mesh)
    return mesh

"""From generators to a validated mesh."""

import numpy as np

from mesh.arrays import Array, Index
from mesh.density.named import Density, density_at, uniform
from mesh.discrete.metrics import compute_metrics
from mesh.discrete.topology import build_topology
from mesh.discrete.validate import validate_mesh
from mesh.errors import MeshError
from mesh.geometry.plane import Plane
from mesh.geometry.sphere import normalize
from mesh.triangulation.delaunay import delaunay
from mesh.validated import remember_validated
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES, VoronoiMesh


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
    mesh = VoronoiMesh(
        **{name: getattr(topology, name) for name in TOPOLOGY_NAMES},
        **{name: getattr(metrics, name) for name in METRICS_NAMES},
        mesh_density=density_at(density, points),
        sphere_radius=1.0,
        density_name=density_name,
    )
    validate_mesh(mesh, fresh_metrics=True)
    remember_validated(mesh)
    return mesh


def plane_mesh(points: Array, triangles: Index, plane: Plane) -> VoronoiMesh:
    """The validated Voronoi mesh of generators `points` (n_cells, 3), metres, on a plane periodic in both directions.

    `triangles` is their Delaunay triangulation across the seams, counter-clockwise seen from above. Raises `MeshError`
    where it does not close the plane.
    """
    topology = build_topology(triangles, len(points), plane.handles)
    metrics = compute_metrics(points, topology, surface=plane)
    mesh = VoronoiMesh(
        **{name: getattr(topology, name) for name in TOPOLOGY_NAMES},
        **{name: getattr(metrics, name) for name in METRICS_NAMES},
        mesh_density=np.ones(len(points)),
        sphere_radius=0.0,
        density_name="uniform",
        x_period=plane.x_period,
        y_period=plane.y_period,
    )
    validate_mesh(mesh, fresh_metrics=True)
    remember_validated(mesh)
    return mesh

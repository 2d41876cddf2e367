"""The Voronoi mesh of generators on a plane that repeats itself in both directions."""

from collections.abc import Sequence

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.plane.domain import rectangle
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import FEWEST_PERIODIC
from mesh.voronoi_mesh import VoronoiMesh


def periodic_mesh(points: Array, periods: Sequence[float]) -> VoronoiMesh:
    """The validated Voronoi mesh of generators `points` (n_cells, 2), metres, on a plane with these two `periods`.

    Points are brought to where the plane begins, from zero up to the periods. Raises `MeshError` where they are not
    finite, coincide, are too few or too uneven for a mesh across the seams, or where four stand on one circle, so that
    their triangles differ from seam to seam.
    """
    plane = rectangle(periods, "xy")
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < FEWEST_PERIODIC:
        raise MeshError(
            f"generators must have shape (n_cells, 2), at least {FEWEST_PERIODIC} of them, not {points.shape}"
        )
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise MeshError(f"generator {wrong[0]} is {points[wrong[0]].tolist()}, which is no point of a plane")
    return plane_mesh(np.column_stack([points, np.zeros(len(points))]), plane)

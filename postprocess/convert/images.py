"""Points of polygons and lines that are whole: on a plane that repeats itself, those beyond its seams are images."""

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh


def whole_points(mesh: VoronoiMesh, corners: Index, beside: Array) -> tuple[Array, Index, NDArray[np.int64]]:
    """Points for `corners` (m,), which are vertices, as near as they come to the points `beside` (m, 3) them.

    Points (n, 3), the vertex (n,) of which each is an image, and the point (m,) of each corner. All vertices come first
    as they are, then images, each once.
    """
    vertices, periods = mesh.vertex_points, surface_of(mesh).periods
    repeats = periods > 0.0
    ways = (beside - vertices[corners])[:, :2]
    steps = np.where(repeats, np.rint(ways / np.where(repeats, periods, 1.0)), 0.0).astype(np.int64)
    moved = np.flatnonzero(steps.any(axis=1))
    images, numbers = np.unique(np.column_stack([corners[moved], steps[moved]]), axis=0, return_inverse=True)
    points = vertices[images[:, 0]]
    points[:, :2] += images[:, 1:] * periods
    used = corners.astype(np.int64)
    used[moved] = mesh.n_vertices + numbers.ravel()
    sources = np.concatenate([np.arange(mesh.n_vertices), images[:, 0]])
    return np.concatenate([vertices, points]), sources, used

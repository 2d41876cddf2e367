"""Half-edges: how the triangles of a closed triangulation hang together.

Half-edge 3 t + k is the side of triangle t opposite to its corner k; it runs from corner k + 1 to corner k + 2
(modulo 3), counter-clockwise seen from outside. Its twin is the same side of the neighbouring triangle, which runs
back: `twins[t, k] // 3` is that triangle, and `triangles.flat[twins[t, k]]` its corner across the side. The same
number 3 t + k also names corner k of triangle t.
"""

import numba
import numpy as np

from mesh.arrays import Index
from mesh.errors import MeshError


def build_twins(triangles: Index, n_points: int) -> Index:
    """Twins (m, 3), int32, of closed triangles (m, 3).

    Raises `MeshError` where a side does not lie between exactly two triangles of equal orientation.
    """
    twins = _match_half_edges(triangles, n_points)
    open_triangles = np.flatnonzero((twins < 0).any(axis=1))
    if len(open_triangles):
        corners = triangles[open_triangles[0]].tolist()
        raise MeshError(
            f"the triangles do not close the sphere: some side of the triangle of generators {corners} does not lie "
            "between exactly two triangles"
        )
    return twins


@numba.njit(cache=True)
def _match_half_edges(triangles: Index, n_points: int) -> Index:
    """Twins (m, 3) by a bucket sort of the half-edges by origin; -1 where there is none."""
    corners = triangles.ravel()
    starts = np.zeros(n_points + 1, np.int32)
    for corner in range(triangles.size):
        starts[corners[corner] + 1] += 1
    for point in range(n_points):
        starts[point + 1] += starts[point]
    filled = starts[:-1].copy()
    bucket = np.empty(triangles.size, np.int32)
    targets = np.empty(triangles.size, np.int32)
    for triangle in range(len(triangles)):
        for k in range(3):
            slot = filled[triangles[triangle, (k + 1) % 3]]
            bucket[slot] = 3 * triangle + k
            targets[slot] = triangles[triangle, (k + 2) % 3]
            filled[triangles[triangle, (k + 1) % 3]] += 1
    twins = np.full(triangles.shape, -1, np.int32)
    for triangle in range(len(triangles)):
        for k in range(3):
            origin = triangles[triangle, (k + 1) % 3]
            target = triangles[triangle, (k + 2) % 3]
            for slot in range(starts[target], starts[target + 1]):
                if targets[slot] == origin:
                    twins[triangle, k] = bucket[slot]
                    break
    return twins


@numba.njit(cache=True)
def first_corners(triangles: Index, n_points: int) -> tuple[Index, Index]:
    """One corner (n,) and the number of triangles (n,) of each point, int32."""
    first_corner = np.full(n_points, -1, np.int32)
    degrees = np.zeros(n_points, np.int32)
    for triangle in range(len(triangles)):
        for k in range(3):
            point = triangles[triangle, k]
            degrees[point] += 1
            if first_corner[point] < 0:
                first_corner[point] = 3 * triangle + k
    return first_corner, degrees


def fill_rings(twins: Index, first_corner: Index, degrees: Index, ring_starts: Index, rings: Index) -> None:
    """Write the triangles round each point, counter-clockwise, to `rings[ring_starts[i]:ring_starts[i + 1]]`."""
    ring_starts[0] = 0
    np.cumsum(degrees, out=ring_starts[1:])
    _walk_rings(twins.ravel(), first_corner, ring_starts, rings)


@numba.njit(parallel=True, cache=True)
def _walk_rings(twins: Index, first_corner: Index, ring_starts: Index, rings: Index) -> None:
    for point in numba.prange(len(first_corner)):
        triangle = first_corner[point] // 3
        corner = first_corner[point] - 3 * triangle
        for slot in range(ring_starts[point], ring_starts[point + 1]):
            rings[slot] = triangle
            twin = twins[3 * triangle + (corner + 1) % 3]
            triangle = twin // 3
            corner = (twin - 3 * triangle + 1) % 3

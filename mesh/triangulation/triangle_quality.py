"""Quality of triangles in compiled code, and which cells lie near the bad ones.

q = (b + c - a)(c + a - b)(a + b - c)/(abc) of the chords a, b, c is one for equilateral triangles; above
2 sqrt(2) - 2 = 0.8285 a triangle has no right or obtuse angle.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.geometry.vectors import chord, determinant


@numba.njit(cache=True)
def quality_of_triangle(points: Array, a: int, b: int, c: int) -> float:
    """The quality q of one triangle, negative if it is inverted."""
    u, v, w = chord(points, b, c), chord(points, c, a), chord(points, a, b)
    q = (v + w - u) * (w + u - v) * (u + v - w) / (u * v * w)
    return q if determinant(points, a, b, c) > 0.0 else -q


@numba.njit(cache=True)
def qualities(points: Array, triangles: Index) -> Array:
    """The qualities q (m,) of all triangles (m, 3)."""
    values = np.empty(len(triangles))
    for triangle in range(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        values[triangle] = quality_of_triangle(points, a, b, c)
    return values


def near_bad_triangles(points: Array, triangles: Index, wanted: float, rings: int) -> NDArray[np.bool_]:
    """Mask (n,) of the cells within a number of `rings` of a triangle whose q is below `wanted`."""
    marked = np.zeros(len(points), bool)
    marked[triangles[qualities(points, triangles) < wanted]] = True
    for _ in range(rings):
        marked[triangles[marked[triangles].any(axis=1)]] = True
    return marked

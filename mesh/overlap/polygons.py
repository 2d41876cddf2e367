"""Convex polygons of great circles in compiled code: what two have in common, its area and its first moment.

A polygon is the first rows of an array (n, 3) of unit vectors, counter-clockwise from outside.
"""

import math

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import (
    Vector,
    area_parts,
    cross_product,
    difference,
    dot_product,
    triple_product,
    vector_between,
    vector_to,
)

compiled = numba.njit(cache=True, fastmath=False)


@compiled
def corners_of(vertices: Array, ring: Index, polygon: Array) -> int:
    """Write the `vertices` (n_vertices, 3) of a `ring` (n,) to a polygon; the number of its corners."""
    for corner in range(len(ring)):
        for axis in range(3):
            polygon[corner, axis] = vertices[ring[corner], axis]
    return len(ring)


@compiled
def _side(polygon: Array, corner: int, a: Vector, way: Vector) -> float:
    """det(a, a + way, corner), positive to the left of the arc from a along `way`."""
    x, y, z = polygon[corner, 0], polygon[corner, 1], polygon[corner, 2]
    return triple_product((x - a[0], y - a[1], z - a[2]), a, way)


@compiled
def cut_off(polygon: Array, corners: int, vertices: Array, start: int, end: int, result: Array) -> int:
    """Write what of a polygon lies to the left of the arc between two `vertices`; the number of its corners."""
    a, way = vector_to(vertices, start), vector_between(vertices, start, vertices, end)
    kept = 0
    for corner in range(corners):
        following = corner + 1 if corner + 1 < corners else 0
        here, there = _side(polygon, corner, a, way), _side(polygon, following, a, way)
        if here >= 0.0:
            result[kept] = polygon[corner]
            kept += 1
        if (here > 0.0 > there) or (here < 0.0 < there):
            share = here / (here - there)
            x = polygon[corner, 0] + share * (polygon[following, 0] - polygon[corner, 0])
            y = polygon[corner, 1] + share * (polygon[following, 1] - polygon[corner, 1])
            z = polygon[corner, 2] + share * (polygon[following, 2] - polygon[corner, 2])
            length = math.sqrt(x * x + y * y + z * z)
            result[kept, 0], result[kept, 1], result[kept, 2] = x / length, y / length, z / length
            kept += 1
    return kept


@compiled
def common_polygon(polygon: Array, corners: int, vertices: Array, ring: Index, buffer: Array) -> int:
    """Leave of a polygon what lies within the convex `ring` (n,) of `vertices`; the number of its corners.

    Polygon and buffer must have as many rows as both have corners.
    """
    for corner in range(len(ring)):
        following = corner + 1 if corner + 1 < len(ring) else 0
        corners = cut_off(polygon, corners, vertices, ring[corner], ring[following], buffer)
        if corners < 3:
            return 0
        polygon[:corners] = buffer[:corners]
    return corners


@compiled
def area_and_moment(polygon: Array, corners: int) -> tuple[float, float, float, float]:
    """Area, steradians, and the integral of the position over a polygon.

    The latter is half the sum over the sides of their lengths times their normals.
    """
    area, x, y, z = 0.0, 0.0, 0.0, 0.0
    origin = vector_to(polygon, 0)
    for corner in range(corners):
        following = corner + 1 if corner + 1 < corners else 0
        a, b = vector_to(polygon, corner), vector_to(polygon, following)
        if corner > 0 and following > 0:
            numerator, denominator = area_parts(origin, a, b)
            area += 2.0 * math.atan2(numerator, denominator)
        normal = cross_product(a, difference(b, a))
        sine = math.sqrt(dot_product(normal, normal))
        if sine > 0.0:
            half = 0.5 * math.atan2(sine, dot_product(a, b)) / sine
            x += half * normal[0]
            y += half * normal[1]
            z += half * normal[2]
    return area, x, y, z


@numba.njit(cache=True, parallel=True, fastmath=False)
def areas_and_moments(vertices: Array, rings: Index, counts: Index) -> tuple[Array, Array]:
    """Areas (n,) and moments (n, 3) of cells, whose corners are the first `counts` (n,) of `rings` (n, m)."""
    areas, moments = np.empty(len(rings)), np.empty((len(rings), 3))
    for cell in numba.prange(len(rings)):
        polygon = np.empty((counts[cell], 3))
        corners = corners_of(vertices, rings[cell, : counts[cell]], polygon)
        areas[cell], moments[cell, 0], moments[cell, 1], moments[cell, 2] = area_and_moment(polygon, corners)
    return areas, moments

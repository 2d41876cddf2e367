"""Plain numpy twins of the kernels of `mesh.integrals.moments`, from other formulae."""

import numpy as np

from mesh.arrays import Array, Index, sum_by_index
from mesh.geometry.sphere import arc_length, circumcenter, dot, triangle_area
from mesh.triangulation.half_edges import build_twins


def mass_and_moment(points: Array, triangles: Index) -> tuple[Array, Array]:
    """Area (n,) and integral of position (n, 3) of every Voronoi cell.

    The moment is half the sum over the sides of arc length times unit normal; the plane of a side bisects two
    generators, so that its normal is their difference.
    """
    n = len(points)
    twins = build_twins(triangles, n).ravel()
    vertices = circumcenter(*(points[triangles[:, k]] for k in range(3)))
    half_edge = np.flatnonzero(np.arange(len(twins)) < twins)
    first, second = (np.roll(triangles, shift, axis=1).ravel()[half_edge] for shift in (-1, 1))
    left, right = vertices[half_edge // 3], vertices[twins[half_edge] // 3]
    difference = points[first] - points[second]
    arc = 0.5 * arc_length(left, right) / np.sqrt(dot(difference, difference))
    mass = sum_by_index(first, triangle_area(points[first], right, left), n)
    mass += sum_by_index(second, triangle_area(points[second], left, right), n)
    parts = arc[:, None] * difference
    moment = [sum_by_index(first, part, n) - sum_by_index(second, part, n) for part in parts.T]
    return mass, np.stack(moment, axis=1)


def is_delaunay(points: Array, triangles: Index, rounding: float = 1e-13) -> bool:
    """Whether no generator lies inside the circumcircle of any triangle, all pairs tried."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.sqrt(dot(normals, normals))[:, None]
    oriented = np.all(dot(normals, a) > 0.0)
    return bool(oriented and (normals @ points.T - dot(normals, a)[:, None]).max() <= rounding)

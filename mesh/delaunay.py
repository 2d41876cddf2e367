"""Spherical Delaunay triangulation by the convex hull, and the test whether one is still Delaunay."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from mesh.arrays import Array, Index
from mesh.errors import MeshError
from mesh.sphere import dot


def delaunay(points: Array) -> Index:
    """Triangles (2n - 4, 3) of the spherical Delaunay triangulation of unit vectors `points` (n, 3).

    The facets of the convex hull are the Delaunay triangles (Renka 1997). Corners run counter-clockwise seen
    from outside. Raises `MeshError` where points coincide or lie in one hemisphere.
    """
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise MeshError(
            f"the {len(points)} generators span no closed surface (they may coincide or lie on one circle); "
            "give at least 4 points that are spread over the sphere"
        ) from error
    triangles = hull.simplices.astype(np.int32)
    expected = 2 * len(points) - 4
    if len(triangles) != expected:
        missing = np.setdiff1d(np.arange(len(points)), triangles)
        raise MeshError(
            f"the triangulation has {len(triangles)} triangles instead of {expected}: "
            f"generators {missing[:5].tolist()} coincide with others; remove the duplicates"
        )
    if np.any(hull.equations[:, 3] >= 0.0):
        raise MeshError("the generators lie in one hemisphere; spread them over the whole sphere")
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = dot(np.cross(b - a, c - a), a + b + c) < 0.0
    triangles[inward, 1], triangles[inward, 2] = triangles[inward, 2], triangles[inward, 1].copy()
    return triangles


def half_edge_twins(triangles: Index) -> Index:
    """For half-edge 3 t + k, from corner k of triangle t to corner k + 1, the half-edge that runs back.

    Returns shape (3 n_triangles,). Raises `MeshError` where a side does not belong to exactly two triangles
    of equal orientation.
    """
    start = triangles.ravel().astype(np.int64)
    end = np.roll(triangles, -1, axis=1).ravel().astype(np.int64)
    size = int(triangles.max()) + 1
    order = np.argsort(np.minimum(start, end) * size + np.maximum(start, end), kind="stable")
    first, second = order[0::2], order[1::2]
    if not (np.array_equal(start[first], end[second]) and np.array_equal(end[first], start[second])):
        raise MeshError("the triangles do not close the sphere: some side does not lie between exactly two triangles")
    twins = np.empty_like(order)
    twins[first], twins[second] = second, first
    return twins


def is_delaunay(points: Array, triangles: Index, twins: Index) -> bool:
    """Whether a closed triangulation of moved points is still Delaunay.

    True where every triangle keeps its orientation and no corner across a side lies beyond the plane of the
    triangle by more than round-off: a triangulation that is locally Delaunay at every side is so globally.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    if np.any(dot(normals, a + b + c) <= 0.0):
        return False
    opposite = triangles[twins // 3, (twins % 3 + 2) % 3].reshape(-1, 3)
    heights = dot(normals[:, None, :], points[opposite] - a[:, None, :])
    # Coordinates carry rounding errors of one unit in the last place, so a height times the doubled area of the
    # triangle is known to a few units of the latter.
    rounding = 16.0 * np.finfo(float).eps * np.sqrt(dot(normals, normals))
    return bool(np.all(heights <= rounding[:, None]))

"""Spherical Delaunay triangulation by the convex hull."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from mesh.arrays import Array, Index
from mesh.errors import HemisphereError, MeshError
from mesh.geometry.sphere import dot


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
        raise HemisphereError("the generators lie in one hemisphere; spread them over the whole sphere")
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = dot(np.cross(b - a, c - a), a + b + c) < 0.0
    triangles[inward, 1], triangles[inward, 2] = triangles[inward, 2], triangles[inward, 1].copy()
    return triangles

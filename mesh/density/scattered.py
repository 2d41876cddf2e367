"""Interpolation between values at scattered points of the sphere, such as the cell centres of a mesh.

A value at y is the barycentric mean of those at the corners of the Delaunay triangle that holds y, with y projected
from the centre of the sphere onto the plane of the triangle: the share of corner a is det(b, c, y) over the sum of the
three such determinants. It is continuous, equal to the given values at the given points, and never beyond them.
"""

import math
import warnings

import numba
import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index
from mesh.density.named import Density
from mesh.errors import MeshError, MeshWarning
from mesh.geometry.cube import patch_centers, patch_of
from mesh.geometry.sphere import fibonacci_points, mean_spacing
from mesh.geometry.vectors import triple_product, vector_between, vector_to
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins, first_corners

COINCIDENT = 1e-9
"""Points closer than this are one; the first of them has the value."""

FILLERS = 2000
"""Points of the whole sphere of which those far from all values take the nearest one."""

FAR = 2.0
"""How far that is, in spacings of the points."""


def density_from_cells(centers: Array, values: Array, triangles: Index | None = None) -> Density:
    """Interpolate `values` (n,) between unit vectors `centers` (n, 3); see the module.

    `triangles` may give the Delaunay triangulation of the centres. Raises `MeshError` where they lie in one hemisphere.
    """
    if triangles is None:
        triangles = delaunay(centers)
    twins = build_twins(triangles, len(centers))
    buckets = _Buckets(centers, triangles)

    def density(points: Array) -> Array:
        result = np.empty(len(points))
        _interpolate(np.ascontiguousarray(points), centers, values, triangles, twins, buckets.triangle, result)
        return result

    return density


def density_from_points(points: Array, values: Array, name: str) -> Density:
    """Interpolate `values` (n,) of any unit vectors `points` (n, 3), which may coincide or cover a part of the sphere.

    Beyond that part the nearest value holds; a `MeshWarning` says so with the `name` of the field. Raises `MeshError`
    where the points are so few that they and the part beyond do not go round the sphere.
    """
    tree = cKDTree(points)
    first = np.ones(len(points), bool)
    first[tree.query_pairs(COINCIDENT, output_type="ndarray")[:, 1]] = False
    points, values = points[first], values[first]
    tree = cKDTree(points)
    spacing = max(float(tree.query(points, k=2)[0][:, 1].max()), mean_spacing(len(points)))
    fillers = fibonacci_points(FILLERS)
    distance, nearest = tree.query(fillers)
    far = distance > FAR * spacing
    if far.any():
        tell_of_part(name)
        points = np.concatenate([points, fillers[far]])
        values = np.concatenate([values, values[nearest[far]]])
    try:
        return density_from_cells(points, values)
    except MeshError as error:
        raise MeshError(f"{name} lies on points that do not go round the sphere ({error})") from error


def tell_of_part(name: str) -> None:
    """Warn that a field covers a part of the sphere only."""
    warnings.warn(
        f"{name} covers a part of the globe only; beyond it the nearest value is taken", MeshWarning, stacklevel=3
    )


class _Buckets:
    """A nearby triangle for each patch of the sphere, as `mesh.geometry.cube` numbers them.

    `triangle` (6 * resolution^2,) has about as many patches as there are points.
    """

    def __init__(self, centers: Array, triangles: Index) -> None:
        resolution = math.ceil(math.sqrt(len(centers) / 6.0))
        nearest = cKDTree(centers).query(patch_centers(resolution))[1]
        self.triangle = first_corners(triangles, len(centers))[0][nearest] // 3


@numba.njit(cache=True)
def _determinant(points: Array, point: int, centers: Array, a: int, b: int) -> float:
    """det(a, b, point), from differences, so that it vanishes exactly where the point is a or b."""
    to_a, to_b = vector_between(points, point, centers, a), vector_between(points, point, centers, b)
    return triple_product(vector_to(points, point), to_a, to_b)


@numba.njit(cache=True)
def _determinants(
    points: Array, point: int, centers: Array, triangles: Index, triangle: int
) -> tuple[float, float, float]:
    """Determinants of the sides opposite the three corners of a triangle; none is negative inside it."""
    a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
    return (
        _determinant(points, point, centers, b, c),
        _determinant(points, point, centers, c, a),
        _determinant(points, point, centers, a, b),
    )


@numba.njit(cache=True)
def _walk(points: Array, point: int, centers: Array, triangles: Index, twins: Index, start: int) -> int:
    """The triangle that holds a point: from `start` on, cross the side that the point is furthest beyond.

    Among Delaunay triangles this cannot go round in circles but by round-off; then all are tried.
    """
    triangle = start
    for _ in range(len(triangles)):
        u, v, w = _determinants(points, point, centers, triangles, triangle)
        least = min(u, v, w)
        if least >= 0.0:
            return triangle
        side = 0 if u == least else (1 if v == least else 2)
        triangle = twins[triangle, side] // 3
    best, best_margin = start, -np.inf
    for triangle in range(len(triangles)):
        margin = min(_determinants(points, point, centers, triangles, triangle))
        if margin > best_margin:
            best, best_margin = triangle, margin
    return best


@numba.njit(cache=True, parallel=True)
def _interpolate(
    points: Array, centers: Array, values: Array, triangles: Index, twins: Index, near: Index, result: Array
) -> None:
    """Write the barycentric mean at each point to `result`; `near` is that of `_Buckets`."""
    resolution = int(np.sqrt(len(near) // 6) + 0.5)
    for point in numba.prange(len(points)):
        start = near[patch_of(points[point, 0], points[point, 1], points[point, 2], resolution)]
        triangle = _walk(points, point, centers, triangles, twins, start)
        u, v, w = _determinants(points, point, centers, triangles, triangle)
        u, v, w = max(u, 0.0), max(v, 0.0), max(w, 0.0)
        total = u + v + w
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        result[point] = u / total * values[a] + v / total * values[b] + w / total * values[c]

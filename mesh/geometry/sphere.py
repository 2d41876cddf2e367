"""Geometry of the unit sphere: arcs, triangle areas, circumcentres, longitude and latitude, tangent vectors.

Points are rows of arrays of shape (..., 3) with unit length unless stated otherwise. The formulae work on
differences of nearby points, so that their relative error does not grow as meshes get finer.
"""

import numpy as np

from mesh.arrays import Array
from mesh.geometry.angles import eastward_of_half_turns


def dot(a: Array, b: Array) -> Array:
    """Scalar product of vectors (..., 3); result (...)."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def normalize(vectors: Array) -> Array:
    """Vectors (..., 3) scaled to unit length."""
    return vectors / np.sqrt(dot(vectors, vectors))[..., None]


def arc_length(a: Array, b: Array) -> Array:
    """Length of the great-circle arc between unit vectors a and b, radians, in [0, pi]."""
    chord = a - b
    return 2.0 * np.arcsin(np.minimum(1.0, 0.5 * np.sqrt(dot(chord, chord))))


def triangle_area(a: Array, b: Array, c: Array) -> Array:
    """Signed area of spherical triangles, steradians; positive where a, b, c run counter-clockwise from outside.

    tan(area/2) = a.(b x c) / (1 + a.b + b.c + c.a) (Oosterom and Strackee 1983); the triple product is taken
    of differences, and the denominator is four less half the squared sides.
    """
    ab, ac, bc = b - a, c - a, c - b
    triple = dot(a, np.cross(ab, ac))
    denominator = 4.0 - 0.5 * (dot(ab, ab) + dot(ac, ac) + dot(bc, bc))
    return 2.0 * np.arctan2(triple, denominator)


def circumcenter(a: Array, b: Array, c: Array) -> Array:
    """Unit vectors equidistant from a, b and c, on the side from which a, b, c run counter-clockwise."""
    return normalize(np.cross(b - a, c - a))


def to_lonlat(points: Array) -> tuple[Array, Array]:
    """Longitude in [0, 2 pi) and latitude in [-pi/2, pi/2], radians, of points (..., 3) of any length."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return eastward_of_half_turns(np.arctan2(y, x)), np.arctan2(z, np.hypot(x, y))


def from_lonlat(longitude: Array, latitude: Array) -> Array:
    """Unit vectors (..., 3) at longitude and latitude in radians."""
    cosine = np.cos(latitude)
    return np.stack([cosine * np.cos(longitude), cosine * np.sin(longitude), np.sin(latitude)], axis=-1)


def east_north(longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """Unit tangent vectors (..., 3) that point east and north at longitude and latitude in radians."""
    sin_lon, cos_lon = np.sin(longitude), np.cos(longitude)
    sin_lat, cos_lat = np.sin(latitude), np.cos(latitude)
    east = np.stack([-sin_lon, cos_lon, np.zeros_like(sin_lon)], axis=-1)
    north = np.stack([-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat], axis=-1)
    return east, north


def fibonacci_points(count: int) -> Array:
    """Points (count, 3) on the Fibonacci spiral (Swinbank and Purser 2006): nearly uniform for any number."""
    index = np.arange(count)
    z = 1.0 - (2.0 * index + 1.0) / count
    longitude = index * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(longitude), radius * np.sin(longitude), z], axis=1)


def hexagon_spacing(area: Array) -> Array:
    """Distance between neighbours where cells are plane hexagons of these areas (n,), in the unit of their root."""
    return np.sqrt(area * 2.0 / np.sqrt(3.0))


def mean_spacing(n_cells: int) -> float:
    """Distance (radians) between neighbours if all cells were equal plane hexagons."""
    return float(np.sqrt(8.0 * np.pi / (np.sqrt(3.0) * n_cells)))

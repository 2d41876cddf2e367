"""Vectors in space for compiled code: three numbers each, formed of rows of arrays of points (n, 3).

`mesh.geometry.sphere` does the same for whole arrays. Products take differences of nearby points where that keeps their
relative error from growing as meshes get finer.
"""

import numba
import numpy as np

from mesh.arrays import Array

Vector = tuple[float, float, float]

compiled = numba.njit(cache=True, fastmath=False)
"""A function without options would get those of whatever calls it first, and with them other last digits."""


@compiled
def vector_to(points: Array, point: int) -> Vector:
    """The vector from the origin to a point."""
    return (points[point, 0], points[point, 1], points[point, 2])


@compiled
def vector_between(origins: Array, start: int, points: Array, end: int) -> Vector:
    """The vector from origins[start] to points[end]."""
    return (
        points[end, 0] - origins[start, 0],
        points[end, 1] - origins[start, 1],
        points[end, 2] - origins[start, 2],
    )


@compiled
def nearest_image(way: Vector, periods: Array) -> Vector:
    """A vector less whole periods (2,) of x and y, where these are not zero: at most half of them long."""
    x, y, z = way
    if periods[0] > 0.0:
        x -= periods[0] * np.rint(x / periods[0])
    if periods[1] > 0.0:
        y -= periods[1] * np.rint(y / periods[1])
    return (x, y, z)


@compiled
def outward(points: Array, point: int, is_flat: bool) -> Vector:
    """Normal of the surface at a point: the vector to it on the unit sphere, along z in the plane."""
    if is_flat:
        return (0.0, 0.0, 1.0)
    return vector_to(points, point)


@compiled
def dot_product(u: Vector, v: Vector) -> float:
    """The product u.v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@compiled
def cross_product(u: Vector, v: Vector) -> Vector:
    """The product u x v."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


@compiled
def triple_product(u: Vector, v: Vector, w: Vector) -> float:
    """The product u.(v x w), the determinant of the three: positive where they run counter-clockwise from outside."""
    return dot_product(u, cross_product(v, w))


@compiled
def chord(points: Array, a: int, b: int) -> float:
    """Distance, in a straight line, of two points."""
    way = vector_between(points, b, points, a)
    return np.sqrt(dot_product(way, way))


@compiled
def triangle_normal(points: Array, a: int, b: int, c: int) -> Vector:
    """(b - a) x (c - a): twice the area of the flat triangle; its direction is that of the circumcentre."""
    return cross_product(vector_between(points, a, points, b), vector_between(points, a, points, c))


@compiled
def determinant(points: Array, a: int, b: int, c: int) -> float:
    """Triple product of three points, from their positions."""
    return triple_product(vector_to(points, a), vector_to(points, b), vector_to(points, c))


@compiled
def difference(u: Vector, v: Vector) -> Vector:
    """The vector u - v."""
    return (u[0] - v[0], u[1] - v[1], u[2] - v[2])


@compiled
def area_parts(a: Vector, b: Vector, c: Vector) -> tuple[float, float]:
    """Numerator and denominator of the tangent of half the area of a spherical triangle.

    To the last digit those of `mesh.geometry.sphere.triangle_area`.
    """
    ab, ac, bc = difference(b, a), difference(c, a), difference(c, b)
    squares = dot_product(ab, ab) + dot_product(ac, ac) + dot_product(bc, bc)
    return triple_product(a, ab, ac), 4.0 - 0.5 * squares

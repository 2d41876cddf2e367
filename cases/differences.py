"""Derivatives on the sphere of a function known at any point, by differences along great circles.

They serve cases that define a streamfunction but neither velocity nor vorticity. Sixth-order central differences
with `STEP` are accurate to about 1e-11 for a field with the scale of the sphere; their error grows with the sixth power
of the wave number. There is no singularity at the poles.
"""

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import east_north, from_lonlat, to_lonlat
from mesh.integrals.quadrature import SphereFunction

STEP = 0.01
"""Distance between neighbouring points of a difference, rad."""

FIRST = (3 / 4, -3 / 20, 1 / 60)
"""Weights of f(k STEP) - f(-k STEP), k = 1, 2, 3, in the first derivative times STEP."""

SECOND = (3 / 2, -3 / 20, 1 / 90)
"""Weights of f(k STEP) + f(-k STEP) - 2 f(0), k = 1, 2, 3, in the second derivative times STEP squared."""


def gradient(function: SphereFunction, longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """Eastward and northward components of the gradient on the unit sphere, in units of `function` per radian."""
    point = from_lonlat(longitude, latitude)
    east, north = east_north(longitude, latitude)
    return _first_derivative(function, point, east), _first_derivative(function, point, north)


def laplacian(function: SphereFunction, longitude: Array, latitude: Array) -> Array:
    """Laplacian on the unit sphere: the sum of second derivatives along two great circles at right angles."""
    point = from_lonlat(longitude, latitude)
    east, north = east_north(longitude, latitude)
    return _second_derivative(function, point, east) + _second_derivative(function, point, north)


def _first_derivative(function: SphereFunction, point: Array, tangent: Array) -> Array:
    total = np.zeros(point.shape[:-1])
    for k, weight in enumerate(FIRST, start=1):
        total += weight * (_ahead(function, point, tangent, k) - _ahead(function, point, tangent, -k))
    return total / STEP


def _second_derivative(function: SphereFunction, point: Array, tangent: Array) -> Array:
    here, total = _ahead(function, point, tangent, 0), np.zeros(point.shape[:-1])
    for k, weight in enumerate(SECOND, start=1):
        total += weight * (_ahead(function, point, tangent, k) + _ahead(function, point, tangent, -k) - 2.0 * here)
    return total / STEP**2


def _ahead(function: SphereFunction, point: Array, tangent: Array, steps: int) -> Array:
    """Value of `function`, `steps` away from `point` (..., 3) along the great circle in direction `tangent`."""
    angle = steps * STEP
    return function(*to_lonlat(np.cos(angle) * point + np.sin(angle) * tangent))

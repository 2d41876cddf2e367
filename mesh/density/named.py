"""Density functions: how closely generators are spaced.

A density is any callable that takes unit vectors (m, 3) and returns m numbers, not negative and not all zero. In a
centroidal Voronoi tessellation the widths of the cells go like density^(-1/4) (Gersho's conjecture; Ju, Ringler and
Gunzburger 2011, section 3), so only ratios of values matter.

`refined-circle` and `refined-box` are equations (12) and (13) of that paper; both have the form

    rho = ((1 - s) gamma + s)^4,    s = d / alpha restricted to [0, 1],

where d is the distance from the refined region in the plane of latitude and longitude, alpha the width of the
transition, and gamma the ratio of widths far outside and inside. They are continuous, with kinks.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np

from mesh.arrays import Array, by_blocks
from mesh.errors import MeshError
from mesh.geometry.arctangent import arctangent
from mesh.geometry.sphere import arc_length, from_lonlat
from mesh.geometry.surface import UNIT_SPHERE, Surface

Density = Callable[[Array], Array]

values_loop = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
"""Loops without branches, which take several points at a time; a check of each division would forbid that."""


def uniform(points: Array) -> Array:
    """Density one everywhere."""
    return np.ones(len(points))


@dataclass(frozen=True)
class RefinedCircle:
    """Equation (12): cells are `ratio` times narrower within a circle of the latitude-longitude plane; radians."""

    latitude: float = np.pi / 6.0
    longitude: float = 1.5 * np.pi
    radius: float = np.pi / 6.0
    transition: float = np.pi / 12.0
    ratio: float = 3.0

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        shape = (self.latitude, self.longitude, self.radius, self.transition, self.ratio)
        return by_blocks(lambda rows: _circle_values(_components(rows), *shape), points)


@dataclass(frozen=True)
class RefinedBox:
    """Equation (13): cells are `ratio` times narrower within a box of latitudes and longitudes; radians."""

    south: float = np.radians(-5.0)
    north: float = np.radians(60.0)
    west: float = np.radians(225.0)
    east: float = np.radians(310.0)
    transition: float = 0.24
    ratio: float = 3.0

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        shape = (self.south, self.north, self.west, self.east, self.transition, self.ratio)
        return by_blocks(lambda rows: _box_values(_components(rows), *shape), points)


@dataclass(frozen=True)
class SmoothTransition:
    """Cell width `inner_width` within the arc `radius` of a centre and `outer_width` beyond: the density is width^-4.

    Between them the width changes like tanh((arc - radius) / transition). Angles in radians; only the ratio of the
    widths matters.
    """

    inner_width: float = 1.0
    outer_width: float = 3.0
    latitude: float = np.pi / 6.0
    longitude: float = 1.5 * np.pi
    radius: float = np.pi / 6.0
    transition: float = np.pi / 20.0

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        return by_blocks(self._values, points)

    def _values(self, points: Array) -> Array:
        center = from_lonlat(np.array(self.longitude), np.array(self.latitude))
        arc = arc_length(points, np.broadcast_to(center, points.shape))
        share = 0.5 * (1.0 + np.tanh((arc - self.radius) / self.transition))
        return (self.inner_width + share * (self.outer_width - self.inner_width)) ** -4.0


NAMED: dict[str, Density] = {
    "uniform": uniform,
    "refined-circle": RefinedCircle(),
    "refined-box": RefinedBox(),
    "smooth-transition": SmoothTransition(),
}


def density_at(density: Density, points: Array, surface: Surface = UNIT_SPHERE) -> Array:
    """Values (m,) of a density at points (m, 3) of a surface: unit vectors, or places on a plane.

    Takes what a user's function may give: any numeric type, lists, a column (m, 1), or one number for all points.
    Raises `MeshError` where the values are of another shape or type, negative or not finite.
    """
    given = density(points)
    try:
        values = np.asarray(given)
    except ValueError:  # a list of lists of different lengths
        values = np.empty(0, object)
    if values.dtype.kind not in "biuf":
        raise MeshError(f"the density gives {type(given).__name__} instead of real numbers; return one per point")
    if values.shape == ():
        values = np.full(len(points), values)
    if values.shape not in ((len(points),), (len(points), 1)):
        raise MeshError(
            f"the density gives values of shape {values.shape} at {len(points)} points; return one per point"
        )
    values = np.ascontiguousarray(values.reshape(len(points)), dtype=np.float64)
    _check(values, points, surface)
    return values


def _check(values: Array, points: Array, surface: Surface) -> None:
    """Raise `MeshError` where a value (m,) at points (m, 3) is negative or not finite."""
    wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
    if len(wrong):
        raise MeshError(
            f"the density is {values[wrong[0]]:g} at {surface.in_words(points[wrong[0]])}; "
            "it must be finite and not negative"
        )


def _components(points: Array) -> Array:
    """Components (3, m) of points (m, 3), each in one row: what loops can load several of."""
    return np.ascontiguousarray(points.T)


@values_loop
def _circle_values(
    components: Array, latitude: float, longitude: float, radius: float, transition: float, ratio: float
) -> Array:
    """Values (m,) of `RefinedCircle` at unit vectors of such `_components` (3, m)."""
    x, y, z = components[0], components[1], components[2]
    values = np.empty(len(x))
    east_x, east_y = np.cos(longitude), np.sin(longitude)
    for row in range(len(x)):
        rise = _latitude(x[row], y[row], z[row]) - latitude
        side = _longitude_from(x[row], y[row], east_x, east_y)
        values[row] = _blend(np.sqrt(rise * rise + side * side) - radius, transition, ratio)
    return values


@values_loop
def _box_values(
    components: Array, south: float, north: float, west: float, east: float, transition: float, ratio: float
) -> Array:
    """Values (m,) of `RefinedBox` at unit vectors of such `_components` (3, m)."""
    x, y, z = components[0], components[1], components[2]
    values = np.empty(len(x))
    middle, half_width = 0.5 * (west + east), 0.5 * (east - west)
    east_x, east_y = np.cos(middle), np.sin(middle)
    for row in range(len(x)):
        latitude = _latitude(x[row], y[row], z[row])
        end = max(south - latitude, latitude - north, 0.0)
        side = max(abs(_longitude_from(x[row], y[row], east_x, east_y)) - half_width, 0.0)
        values[row] = _blend(np.sqrt(side * side + end * end), transition, ratio)
    return values


@values_loop
def _latitude(x: float, y: float, z: float) -> float:
    """Latitude of a direction, radians."""
    return arctangent(z, np.sqrt(x * x + y * y))


@values_loop
def _longitude_from(x: float, y: float, east_x: float, east_y: float) -> float:
    """Longitude of a direction, in [-pi, pi], from the meridian through (east_x, east_y, 0)."""
    return arctangent(y * east_x - x * east_y, x * east_x + y * east_y)


@values_loop
def _blend(distance: float, transition: float, ratio: float) -> float:
    """ratio^4 where `distance` is not positive, one beyond the transition, the fourth power of a line in between."""
    share = min(max(distance / transition, 0.0), 1.0)
    width = (1.0 - share) * ratio + share
    return (width * width) * (width * width)

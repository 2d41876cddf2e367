"""Points of a plane lifted to the unit sphere by stereographic projection.

Circles stay circles, and what is inside stays inside: so the Delaunay triangulation of the points on the sphere is that
of the points in the plane, and `mesh.triangulation` serves both.
"""

import numba

from mesh.arrays import Array
from mesh.geometry.sphere import fibonacci_points

SURROUNDING = 1000
"""Points on a whole sphere of which those far from the lifted ones surround it."""

SOUTH = -0.2
"""Height below which these are: lifted points have heights above zero, up to the north pole."""


@numba.njit(parallel=True, cache=True, fastmath=False)
def lift(places: Array, centre: Array, radius: float, lifted: Array) -> None:
    """Write unit vectors for places (m, 2) to `lifted` (m, 3).

    The `centre` (2,) goes to the north pole, the circle of this radius about it to the equator.
    """
    for row in numba.prange(len(places)):
        x, y = (places[row, 0] - centre[0]) / radius, (places[row, 1] - centre[1]) / radius
        factor = 1.0 / (1.0 + x * x + y * y)
        lifted[row, 0], lifted[row, 1] = 2.0 * factor * x, 2.0 * factor * y
        lifted[row, 2] = 2.0 * factor - 1.0


@numba.njit(cache=True, error_model="numpy", fastmath=False)
def to_circumcenter(places: Array, a: int, b: int, c: int) -> tuple[float, float]:
    """The way from place a to the circumcentre of three `places` (m, 2 or more)."""
    ux, uy = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1]
    vx, vy = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1]
    uu, vv, twice = ux * ux + uy * uy, vx * vx + vy * vy, 2.0 * (ux * vy - uy * vx)
    return (vy * uu - uy * vv) / twice, (ux * vv - vx * uu) / twice


def far_points() -> Array:
    """Unit vectors (k, 3) in the south, which together with lifted points surround the sphere."""
    points = fibonacci_points(SURROUNDING)
    return points[points[:, 2] < SOUTH]


def lowered(points: Array, centre: Array, radius: float) -> Array:
    """Places (k, 2) in the plane of unit vectors (k, 3)."""
    return centre + radius * points[:, :2] / (1.0 + points[:, 2:])

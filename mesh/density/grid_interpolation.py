"""Interpolation on grids of latitude and longitude, of the whole globe or of a part of it."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from mesh.arrays import Array, by_blocks, row_loop
from mesh.density.field_coordinates import QUARTER
from mesh.density.named import Density
from mesh.density.scattered import tell_of_part
from mesh.errors import MeshError
from mesh.geometry.angles import TURN, eastward
from mesh.geometry.arctangent import arctangent
from mesh.geometry.vectors import compiled

Smooth = Callable[[Array], Array]

WIDEST_GAP = 1.5
"""A grid covers the globe where no gap between its rows or columns is wider than the others by more than this."""

SAME = 1e-9
"""Radians; a row closer than this to a pole is at the pole."""


def density_on_grid(
    latitude: Array, longitude: Array, values: Array, shape: Callable[[Array, Smooth], Array], name: str
) -> Density:
    """Bilinear interpolation of values (n, m) at latitudes (n,) and longitudes (m,), radians in any order.

    It is continuous at the poles and round the circle. `shape` makes the density of the values and a pass of smoothing.
    Beyond the edges of a grid of a part of the globe, the nearest value holds for two thirds of the way to the pole,
    and for a third of the way round on either side.
    """
    latitude, rows = np.unique(latitude, return_index=True)
    # Both ends of a full circle are one meridian.
    longitude, columns = np.unique(eastward(np.round(eastward(longitude), 12)), return_index=True)
    if len(latitude) < 2:
        raise MeshError(f"{name} has one latitude; a grid needs at least two")
    gaps = np.diff(longitude, append=longitude[0] + TURN)
    whole_circle = len(gaps) == 1 or gaps.max() <= WIDEST_GAP * np.delete(gaps, gaps.argmax()).max()
    beyond = max(QUARTER + latitude[0], QUARTER - latitude[-1])
    whole_height = beyond <= WIDEST_GAP * np.diff(latitude).max()
    if not (whole_circle and whole_height):
        tell_of_part(name)
    # Where there is a gap, the columns begin after it.
    first = 0 if whole_circle else (int(gaps.argmax()) + 1) % len(gaps)
    west = 0.0 if whole_circle else longitude[first]
    longitude, columns = eastward(np.roll(longitude, -first) - west), np.roll(columns, -first)
    edge: Literal["wrap", "edge"] = "wrap" if whole_circle else "edge"
    values = shape(values[np.ix_(rows, columns)], lambda values: _smooth_grid(values, edge))
    south, north = (_cap(latitude[end], sign, values[end], whole_height) for end, sign in ((0, -1.0), (-1, 1.0)))
    latitude = np.concatenate([south[0], latitude[1:-1], north[0][::-1]])
    values = np.concatenate([south[1], values[1:-1], north[1][::-1]])
    longitude, values = _closed_circle(longitude, values, whole_circle)

    def density(points: Array) -> Array:
        return by_blocks(lambda rows: _bilinear(rows, west, latitude, longitude, values), np.ascontiguousarray(points))

    return density


@row_loop
def _bilinear(points: Array, west: float, latitude: Array, longitude: Array, values: Array) -> Array:
    """Bilinear interpolation at unit vectors (m, 3) of values (rows, columns) that hold the whole sphere.

    Latitudes (rows,) ascend from pole to pole; longitudes (columns,) ascend from `west` and hold [0, 2 pi].
    """
    result = np.empty(len(points))
    west_x, west_y = np.cos(west), np.sin(west)
    for point in range(len(points)):
        x, y, z = points[point, 0], points[point, 1], points[point, 2]
        east = arctangent(y * west_x - x * west_y, x * west_x + y * west_y)
        if east < 0.0:
            east += TURN
        row, up = _interval(latitude, arctangent(z, np.sqrt(x * x + y * y)))
        column, along = _interval(longitude, east)
        # In this form equal values give just that value between them.
        low = values[row, column] + along * (values[row, column + 1] - values[row, column])
        high = values[row + 1, column] + along * (values[row + 1, column + 1] - values[row + 1, column])
        result[point] = low + up * (high - low)
    return result


@compiled
def _interval(edges: Array, place: float) -> tuple[int, float]:
    """The interval of ascending `edges` (n,) that holds a place, and how far along it lies, from zero to one."""
    interval = min(max(int(np.searchsorted(edges, place, side="right")) - 1, 0), len(edges) - 2)
    share = (place - edges[interval]) / (edges[interval + 1] - edges[interval])
    return interval, min(max(share, 0.0), 1.0)


def _smooth_grid(values: Array, edge: Literal["wrap", "edge"]) -> Array:
    """Mean of each value, twice weighted, with those to its east, west, north and south."""
    high, wide = np.pad(values, ((1, 1), (0, 0)), mode="edge"), np.pad(values, ((0, 0), (1, 1)), mode=edge)
    return 0.5 * values + 0.125 * (high[:-2] + high[2:] + wide[:, :-2] + wide[:, 2:])


def _closed_circle(longitude: Array, values: Array, whole: bool) -> tuple[Array, Array]:
    """Columns (m,) in [0, 2 pi) and values (n, m) with more columns, so that they hold all of [0, 2 pi]."""
    if whole:  # one column more on each side makes the grid periodic
        longitude = np.concatenate([longitude[-1:] - TURN, longitude, longitude[:1] + TURN])
        return longitude, np.concatenate([values[:, -1:], values, values[:, :1]], axis=1)
    east, third = longitude[-1], (TURN - longitude[-1]) / 3.0
    longitude = np.concatenate([longitude, [east + third, TURN - third, TURN]])
    return longitude, np.concatenate([values, values[:, -1:], values[:, :1], values[:, :1]], axis=1)


def _cap(latitude: float, sign: float, row: Array, whole: bool) -> tuple[Array, Array]:
    """Latitudes and rows of values from the pole of this sign to the last row (m,), its own mean being at the pole."""
    pole = sign * QUARTER
    mean = np.full_like(row, row.mean() if np.ptp(row) else row[0])
    if abs(latitude - pole) < SAME:
        return np.array([pole]), mean[None]
    if whole:
        return np.array([pole, latitude]), np.stack([mean, row])
    return np.array([pole, pole + (latitude - pole) / 3.0, latitude]), np.stack([mean, row, row])

"""Places on the surface of a mesh as points, and the sites of a mesh that are nearest to them."""

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index
from mesh.geometry.sphere import from_lonlat
from mesh.geometry.surface import Surface


def points_at(surface: Surface, first: Array, second: Array) -> Array:
    """Points (..., 3) at the coordinates (...,) of functions of the place: longitude and latitude, or x and y."""
    if not surface.is_flat:
        return from_lonlat(first, second)
    return np.stack(np.broadcast_arrays(first, second, 0.0), axis=-1)


def nearest_sites(surface: Surface, sites: Array, points: Array) -> Index:
    """Which of the `sites` (m, 3) is the nearest to each of the points (n, 3), or has the nearest image."""
    if not surface.is_flat:
        return np.asarray(cKDTree(sites).query(points)[1])
    # The tree wants what repeats itself within a period; a period of zero is none.
    periods = surface.periods
    flat = (_within(each[:, :2], periods) for each in (sites, points))
    return np.asarray(cKDTree(next(flat), boxsize=periods).query(next(flat))[1])


def _within(points: Array, periods: Array) -> Array:
    """The images of points (n, 2) from zero up to the periods."""
    repeats = periods > 0.0
    wrapped = points % np.where(repeats, periods, 1.0)
    return np.where(repeats, np.where(wrapped < periods, wrapped, 0.0), points)

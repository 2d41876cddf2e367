"""Distance on the sphere to lines made of short arcs of great circles."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, dot, from_lonlat, normalize

LONGEST_ARC = np.radians(0.1)
"""Radians; lines that are straight in longitude and latitude are divided into arcs no longer than this."""

SAME = 1e-12
"""Radians; ends closer than this, as they are at a pole, make no arc."""

NEAREST = 4
"""Arcs, by their midpoints, among which the nearest is sought."""

FARTHEST = np.pi
"""Radians; the distance to a line of no arcs."""


class Outline:
    """Arcs of great circles from `starts` (n, 3) to `ends` (n, 3), unit vectors; each at most about a degree long."""

    def __init__(self, starts: Array, ends: Array) -> None:
        self.starts, self.ends = starts, ends
        self._tree = cKDTree(normalize(starts + ends)) if len(starts) else None

    def distance(self, points: Array) -> Array:
        """Distance (m,) of unit vectors (m, 3) to the nearest arc, radians, not negative."""
        if self._tree is None:
            return np.full(len(points), FARTHEST)
        count = min(NEAREST, len(self.starts))
        arcs = self._tree.query(points, k=count)[1].reshape(len(points), count)
        return _distance_to_arcs(points[:, None], self.starts[arcs], self.ends[arcs]).min(axis=1)


def _distance_to_arcs(points: Array, starts: Array, ends: Array) -> Array:
    """Distance between unit vectors and short arcs, of the shapes (..., 3)."""
    along = ends - starts
    share = dot(points - starts, along) / np.maximum(dot(along, along), np.finfo(float).tiny)
    return arc_length(points, normalize(starts + np.clip(share, 0.0, 1.0)[..., None] * along))


def straight_on_the_map(longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """Starts and ends, unit vectors (m, 3), of the short arcs of a line through points (n,), radians.

    The line is straight in longitude and latitude between two points. What runs along a pole is left out.
    """
    steps = np.hypot(np.diff(longitude), np.diff(latitude))
    pieces = np.maximum(1, np.ceil(steps / LONGEST_ARC)).astype(int)
    places = np.concatenate([index + np.arange(count) / count for index, count in enumerate(pieces)] + [[len(pieces)]])
    knots = np.arange(len(longitude))
    vertices = from_lonlat(np.interp(places, knots, longitude), np.interp(places, knots, latitude))
    starts, ends = vertices[:-1], vertices[1:]
    long = arc_length(starts, ends) > SAME
    return starts[long], ends[long]


def joined(lines: list[tuple[Array, Array]]) -> Outline:
    """The outline of all lines, each as `straight_on_the_map` gives it."""
    nothing = np.empty((0, 3))
    return Outline(
        np.concatenate([nothing, *(starts for starts, _ in lines)]),
        np.concatenate([nothing, *(ends for _, ends in lines)]),
    )


def signed(distance: Array, inside: NDArray[np.bool_]) -> Array:
    """Distances (n,) that are positive where a point is `inside` (n,), else negative."""
    return np.where(inside, distance, -distance)

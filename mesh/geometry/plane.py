"""The plane z = 0 as a surface of meshes (`mesh.geometry.surface`), which may repeat itself in x and in y."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks
from mesh.geometry.sphere import dot, hexagon_spacing

UPWARD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Plane:
    """See `mesh.geometry.surface.Surface`; lengths in metres, periods zero in directions without one.

    Points that are made lie from zero up to the periods.
    """

    x_period: float
    y_period: float

    @property
    def name(self) -> str:
        """What it is."""
        return "plane"

    @property
    def is_flat(self) -> bool:
        """Yes."""
        return True

    @property
    def handles(self) -> int:
        """One if it repeats itself in both directions."""
        return int(self.x_period > 0.0 and self.y_period > 0.0)

    @property
    def area(self) -> float:
        """Product of both periods."""
        return self.x_period * self.y_period if self.handles else float("nan")

    @cached_property
    def periods(self) -> Array:
        """Both periods (2,)."""
        return np.array([self.x_period, self.y_period])

    @cached_property
    def _steps(self) -> list[tuple[int, float]]:
        """Axes along which it repeats itself, with their periods."""
        return [(axis, period) for axis, period in enumerate((self.x_period, self.y_period)) if period > 0.0]

    def shortest(self, vectors: Array) -> Array:
        """The vectors less whole periods, at most half a period long in each direction."""
        if not self._steps:
            return vectors
        image = vectors.copy()
        for axis, period in self._steps:
            image[..., axis] -= period * np.rint(vectors[..., axis] / period)
        return image

    def distance(self, a: Array, b: Array) -> Array:
        """Length (...) of the straight way to the nearest image."""
        way = self.shortest(b - a)
        return np.sqrt(dot(way, way))

    def midpoint(self, a: Array, b: Array) -> Array:
        """Half the way (..., 3) to the nearest image."""
        return self.wrapped(a + 0.5 * self.shortest(b - a))

    def circumcenter(self, a: Array, b: Array, c: Array) -> Array:
        """Where the perpendicular bisectors (..., 3) of the sides meet."""
        u, v = self.shortest(b - a), self.shortest(c - a)
        uu, vv = dot(u, u), dot(v, v)
        twice = 2.0 * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
        x = (v[..., 1] * uu - u[..., 1] * vv) / twice
        y = (u[..., 0] * vv - v[..., 0] * uu) / twice
        return self.wrapped(a + np.stack([x, y, np.zeros_like(x)], axis=-1))

    def triangle_area(self, a: Array, b: Array, c: Array) -> Array:
        """Half the product of two sides."""
        u, v = self.shortest(b - a), self.shortest(c - a)
        return 0.5 * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    def kite_areas(self, points: Array, edges: Array, cells: Index, sides: Index, corners: Array) -> Array:
        """Each kite is two triangles with a corner in the vertex."""

        def kites(cells: Index, sides: Index, corners: Array) -> Array:
            areas = np.empty((len(cells), 3))
            for j in range(3):
                center = self.shortest(points[cells[:, j]] - corners)
                before = self.shortest(edges[sides[:, j]] - corners)
                after = self.shortest(edges[sides[:, (j + 1) % 3]] - corners)
                areas[:, j] = 0.5 * (_turn(before, center) + _turn(center, after))
            return areas

        return by_blocks(kites, cells, sides, corners)

    def onto(self, points: Array) -> Array:
        """The points themselves."""
        return points

    def kept_on(self, points: Array) -> Array:
        """The points themselves."""
        return points

    def is_off(self, points: Array, unit: float, slack: float) -> NDArray[np.bool_]:
        """Whether z is not zero, beside the extent of the points in x and y."""
        extent = np.ptp(points[:, :2], axis=0).max(initial=0.0) if len(points) else 0.0
        off: NDArray[np.bool_] = ~(np.abs(points[:, 2]) <= slack * extent)
        return off

    def outward(self, points: Array) -> Array:
        """Along z."""
        return np.broadcast_to(UPWARD, points.shape)

    def stretch(self, points: Array) -> Array:
        """One."""
        return np.ones(points.shape[:-1])

    def right_of(self, tail: Array, head: Array) -> Array:
        """The way from `tail` to `head`, turned clockwise."""
        way = self.shortest(head - tail)
        return np.stack([way[..., 1], -way[..., 0], np.zeros_like(way[..., 0])], axis=-1)

    def feet(self, points: Array, tail: Array, head: Array, short: float) -> Array:
        """On the straight line through `tail` and `head`."""
        right = self.right_of(tail, head)
        size, spoke = dot(right, right), self.shortest(tail - points)
        middle = self.midpoint(tail, head)
        to_middle = self.shortest(middle - points)
        is_short = size < short**2 * dot(to_middle, to_middle)
        across = dot(spoke, right) / np.where(is_short, 1.0, size)
        return np.where(is_short[:, None], middle, self.wrapped(points + across[:, None] * right))

    def angles(self, points: Array) -> tuple[Array, Array]:
        """Zero, as in files of others."""
        return np.zeros(points.shape[:-1]), np.zeros(points.shape[:-1])

    def coordinates(self, points: Array) -> tuple[Array, Array]:
        """The coordinates x and y."""
        return points[..., 0], points[..., 1]

    def in_words(self, point: Array) -> str:
        """The coordinates x and y."""
        return f"x = {point[0]:.6g}, y = {point[1]:.6g} m"

    def axes(self, longitude: Array, latitude: Array) -> tuple[Array, Array]:
        """Along x and y."""
        shape = (*np.shape(longitude), 3)
        return np.broadcast_to(np.array([1.0, 0.0, 0.0]), shape), np.broadcast_to(np.array([0.0, 1.0, 0.0]), shape)

    def seen_from(self, centers: Array, axes: Array, points: Array) -> tuple[Array, Array]:
        """Along straight lines to the nearest images."""
        seen = self.shortest(points - centers[:, None])[..., :2]
        length = np.linalg.norm(seen, axis=-1)
        return seen / np.where(length > 0.0, length, 1.0)[..., None], length

    def extent(self, points: Array) -> float:
        """Metres, along x or y."""
        return float(np.abs(points).max(initial=0.0))

    def mean_spacing(self, n_cells: int, area: float) -> float:
        """Metres."""
        return float(hexagon_spacing(np.array(area / n_cells)))

    def to_centroid(self, square: float) -> float:
        """Its root."""
        return math.sqrt(square)

    def curve_places(self, points: Array) -> Array:
        """The smallest square that holds the points, as the first face of the cube."""
        low = points[:, :2].min(axis=0)
        size = max(float(np.ptp(points[:, :2], axis=0).max()), np.finfo(float).tiny)
        square = np.clip(2.0 * (points[:, :2] - low) / size - 1.0, -1.0, 1.0)
        return np.column_stack([np.ones(len(points)), square])

    def wrapped(self, points: Array) -> Array:
        """The images of the points (..., 3) from zero up to the periods."""
        for axis, period in self._steps:
            value = points[..., axis] % period
            points[..., axis] = np.where(value < period, value, 0.0)
        return points


def _turn(u: Array, v: Array) -> Array:
    """The vertical part (n,) of the product u x v of vectors (n, 3) in the plane."""
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]

"""Images of generators beyond the borders of a rectangle: shifted by its periods, mirrored by its walls.

The Voronoi cells of generators among all their images are those of the periodic plane. And a straight wall is the
bisector of each generator and its mirror image, while no other image is nearer to a point on this side of it than its
generator is: so cells among mirror images are the cells that the wall clips.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from mesh.arrays import Array, Index
from mesh.plane.domain import Rectangle


@dataclass(frozen=True, eq=False)
class Images:
    """Image k of m is at `signs[k]` times generator `numbers[k]`, plus `shifts[k]`.

    `numbers` (m,), `signs` (m, 2) and `shifts` (m, 2), metres. They are all those that stood between the corners `low`
    and `high` (2,) of a rectangle when they were made.
    """

    numbers: Index
    signs: Array
    shifts: Array
    low: Array
    high: Array

    def places(self, points: Array) -> Array:
        """Where the images (m, 2) of generators `points` (n, 3) are."""
        return self.signs * points[self.numbers, :2] + self.shifts


def images_of(points: Array, plane: Rectangle, reach: float) -> Images:
    """All images of `points` (n, 3) within `reach` of the rectangle and of the points."""
    low = np.minimum(points[:, :2].min(axis=0), 0.0) - reach
    high = np.maximum(points[:, :2].max(axis=0), plane.lengths) + reach
    found = [_along(points, plane, axis, low, high) for axis in range(2)]
    numbers, signs, shifts = [], [], []
    for first, second in product(*found):
        inside = np.intersect1d(first[2], second[2], assume_unique=True)
        sign, shift = (first[0], second[0]), (first[1], second[1])
        if (sign, shift) == ((1.0, 1.0), (0.0, 0.0)):
            continue
        numbers.append(inside)
        signs.append(np.broadcast_to(sign, (len(inside), 2)))
        shifts.append(np.broadcast_to(shift, (len(inside), 2)))
    return Images(np.concatenate(numbers), np.concatenate(signs), np.concatenate(shifts), low, high)


def _along(points: Array, plane: Rectangle, axis: int, low: Array, high: Array) -> list[tuple[float, float, Index]]:
    """Signs and shifts of images along one axis, with the points that they bring between its bounds."""
    length, repeats = plane.lengths[axis], plane.repeats[axis]
    period, signs = (length, [1.0]) if repeats else (2.0 * length, [1.0, -1.0])
    value = points[:, axis]
    found: list[tuple[float, float, Index]] = []
    for sign in signs:
        least, most = (sign * value).min(), (sign * value).max()
        first, last = np.ceil((low[axis] - most) / period), np.floor((high[axis] - least) / period)
        for shift in np.arange(first, last + 1.0) * period:
            place = sign * value + shift
            inside = np.flatnonzero((place >= low[axis]) & (place <= high[axis]))
            if len(inside):
                found.append((sign, float(shift), inside))
    return found

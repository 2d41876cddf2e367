"""Where a function on the sphere is zero: closed rings, found on triangles that get smaller only near them.

The triangles are those of an octahedron, bisected again and again. The function changes at most as fast as the
distance does, as the distance to a line does, so that most triangles are known to have one sign throughout. Within a
triangle the function is taken to be linear, so that rings neither cross each other nor themselves.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, sum_by_index
from mesh.geometry.sphere import arc_length, normalize, triangle_area
from mesh.graphs import connected_parts

CORNERS = np.concatenate([np.eye(3), -np.eye(3)])
"""Corners (6, 3) of the octahedron."""

FACES = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
"""Its triangles (8, 3), counter-clockwise seen from outside."""

REACH = 0.7
"""In longest sides: no point of a triangle is farther from the nearest corner, with room for rounding."""

LEAST_SHARE, MOST_SHARE = 0.02, 0.98
"""Rings cross a side between these shares of it, so that their vertices stay apart."""


@dataclass(frozen=True, eq=False)
class LevelSet:
    """The rings on which a function is zero; it is positive to their left.

    Vertex i of them is the unit vector `vertices[i]` (n, 3), and `following[i]` (n,) comes after it. `sea[i]` (n,)
    numbers the connected part of the sphere, with positive values, to the left. That of the largest area has the number
    `largest_sea`, None where the function is positive nowhere.
    """

    vertices: Array
    following: Index
    sea: Index
    largest_sea: int | None

    def rings(self) -> list[Index]:
        """The vertices of each ring in their order."""
        following = self.following.tolist()
        seen = np.zeros(len(following), bool)
        found = []
        for first in range(len(following)):
            if seen[first]:
                continue
            ring = [first]
            while (vertex := following[ring[-1]]) != first:
                ring.append(vertex)
            seen[ring] = True
            found.append(np.array(ring))
        return found


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Corners, unit vectors (n, 3), with the values (n,) of the function; triangles (m, 3), counter-clockwise.

    `whole` holds triangles of one sign, `crossed` the smallest ones, of which some have both signs.
    """

    points: Array
    values: Array
    whole: Index
    crossed: Index


def level_set(function: Callable[[Array], Array], fineness: float) -> LevelSet:
    """Where `function` of unit vectors (n, 3) is zero, on triangles whose sides are at most `fineness` long, radians.

    Between two points it must not differ by more than their distance in radians.
    """
    found = _refined(function, fineness)
    positive = found.values > 0.0
    sea_of, areas = _seas(found, positive)
    wet_areas = np.bincount(sea_of[positive], minlength=len(areas)) > 0
    starts, ends = _crossings(found.crossed, positive)
    sides, number = _distinct(np.concatenate([starts, ends]))
    following = np.empty(len(sides), np.intp)
    following[number[: len(starts)]] = number[len(starts) :]
    low, high = found.values[sides[:, 0]], found.values[sides[:, 1]]
    share = np.clip(low / (low - high), LEAST_SHARE, MOST_SHARE)[:, None]
    vertices = normalize((1.0 - share) * found.points[sides[:, 0]] + share * found.points[sides[:, 1]])
    wet = np.where(positive[sides[:, 0]], sides[:, 0], sides[:, 1])
    largest = int(np.where(wet_areas, areas, 0.0).argmax()) if wet_areas.any() else None
    return LevelSet(vertices, following, sea_of[wet], largest)


def _refined(function: Callable[[Array], Array], fineness: float) -> _Triangles:
    """Triangles, bisected where the function may be zero until their sides are short enough."""
    points, triangles = CORNERS, FACES
    values = function(points)
    whole = [np.empty((0, 3), np.intp)]
    while True:
        a, b, c = (points[corner] for corner in triangles.T)
        longest = max(float(arc_length(*ends).max(initial=0.0)) for ends in ((a, b), (b, c), (c, a)))
        near = np.abs(values[triangles]).min(axis=1) <= REACH * longest
        whole.append(triangles[~near])
        triangles = triangles[near]
        if longest <= fineness:
            return _Triangles(points, values, np.concatenate(whole), triangles)
        triangles, halves = _bisected(triangles, len(points))
        middle = normalize(points[halves[:, 0]] + points[halves[:, 1]])
        points, values = np.concatenate([points, middle]), np.concatenate([values, function(middle)])


def _sides(triangles: Index) -> Index:
    """Sides (3 m, 2) of triangles (m, 3): all first ones, then all second and third ones."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _bisected(triangles: Index, size: int) -> tuple[Index, Index]:
    """Four triangles for each, and the sides (k, 2) whose middles are the new points, numbered from `size`."""
    halves, number = _distinct(np.sort(_sides(triangles), axis=1))
    a, b, c = triangles.T
    ab, bc, ca = size + number.reshape(3, -1)
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts]), halves


def _distinct(pairs: Index) -> tuple[Index, Index]:
    """The distinct ones (k, 2) among pairs (n, 2) of numbers, and which of them each is (n,)."""
    base = int(pairs.max(initial=0)) + 1
    keys, number = np.unique(pairs[:, 0] * base + pairs[:, 1], return_inverse=True)
    return np.stack([keys // base, keys % base], axis=1), number


def _seas(found: _Triangles, positive: NDArray[np.bool_]) -> tuple[Index, Array]:
    """The number (n,) of the connected part, of one sign, in which each corner lies, and the area of each part.

    A side between two corners of one sign joins them, also where one of its triangles is smaller than the other.
    """
    triangles = np.concatenate([found.whole, found.crossed])
    sides = _sides(triangles)
    sides = sides[positive[sides[:, 0]] == positive[sides[:, 1]]]
    count, sea_of = connected_parts(len(found.points), sides)
    third = np.abs(triangle_area(*(found.points[corner] for corner in triangles.T))) / 3.0
    return sea_of.astype(np.intp), sum_by_index(sea_of[triangles], np.repeat(third[:, None], 3, axis=1), count)


def _crossings(triangles: Index, positive: NDArray[np.bool_]) -> tuple[Index, Index]:
    """Sides (k, 2) through which rings enter and leave triangles, the smaller number first; positive corners left."""
    starts, ends = [np.empty((0, 2), np.intp)], [np.empty((0, 2), np.intp)]
    for corner in range(3):
        a, b, c = (triangles[:, (corner + turn) % 3] for turn in range(3))
        alone = (positive[b] == positive[c]) & (positive[a] != positive[b])
        first, last = np.stack([a, b], axis=1), np.stack([a, c], axis=1)
        for wet in (True, False):
            chosen = alone & (positive[a] == wet)
            starts.append((first if wet else last)[chosen])
            ends.append((last if wet else first)[chosen])
    return np.sort(np.concatenate(starts), axis=1), np.sort(np.concatenate(ends), axis=1)

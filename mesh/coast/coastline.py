"""A coast as closed rings of great-circle arcs, with the sea to their left."""

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index
from mesh.errors import MeshError
from mesh.geometry.sphere import dot, normalize, triangle_area
from mesh.geometry.surface import UNIT_SPHERE, Surface

NEAREST_VERTICES = 8
"""Vertices of the coast, near a point, whose arcs are tried for the one that is nearest to it."""

FEWEST_VERTICES = 3


class Coast(Protocol):
    """What clips cells: closed rings of straight arcs, or of straight lines in the plane, the sea to their left.

    Ring r has the points `ring_starts[r]` to `ring_starts[r + 1] - 1`.
    """

    @property
    def surface(self) -> Surface:
        """What it lies on."""

    @property
    def points(self) -> Array:
        """Its points (m, 3)."""

    @property
    def ring_starts(self) -> Index:
        """Where each ring begins (n_rings + 1,)."""

    @property
    def n_rings(self) -> int:
        """Number of closed rings."""

    @property
    def area(self) -> float:
        """Area of the sea, in squares of the lengths of the surface."""

    @property
    def corners(self) -> NDArray[np.bool_]:
        """Which of its points (m,) are vertices of a mesh; at others an edge of the coast bends."""

    @property
    def wider(self) -> str:
        """What to ask for where cells are too large for it, in words."""

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in the sea."""


def joined_rings(rings: Sequence[Array]) -> tuple[Array, Index, Index]:
    """The points (m, 3) of all rings, where each ring begins (n_rings + 1,), and the next point (m,) of its ring."""
    points = np.concatenate([np.asarray(ring, np.float64) for ring in rings])
    ring_starts = np.concatenate([[0], np.cumsum([len(ring) for ring in rings])]).astype(np.int32)
    following = np.arange(1, len(points) + 1, dtype=np.int32)
    following[ring_starts[1:] - 1] = ring_starts[:-1]
    return points, ring_starts, following


class Coastline:
    """Closed rings of arcs between `points` (m, 3), unit vectors; the sea, a connected part of the sphere, to the left.

    Ring r has the points `ring_starts[r]` to `ring_starts[r + 1] - 1`; `following` (m,) is the next point of the ring.
    """

    surface: Surface = UNIT_SPHERE
    wider = "a smoother coast"

    def __init__(self, rings: Sequence[Array]) -> None:
        """Take rings (m_r, 3) of unit vectors, without repetition of the first point.

        Raises `MeshError` where there is no ring, or where one is too short or not finite.
        """
        if not rings:
            raise MeshError("the region has no coast; make a mesh of the whole sphere, or give a region with land")
        for number, ring in enumerate(rings):
            if len(ring) < FEWEST_VERTICES or not np.isfinite(ring).all():
                raise MeshError(
                    f"ring {number} of the coast has {len(ring)} points; give at least {FEWEST_VERTICES}, all finite"
                )
        points, self.ring_starts, self.following = joined_rings(rings)
        self.points = normalize(points)
        repeated = np.flatnonzero(dot(self._steps, self._steps) == 0.0)
        if len(repeated):
            raise MeshError(f"the coast has its point {repeated[0]} twice in a row; leave one of them out")

    @property
    def n_rings(self) -> int:
        """Number of closed rings."""
        return len(self.ring_starts) - 1

    @property
    def corners(self) -> NDArray[np.bool_]:
        """None: a coast is smooth."""
        return np.zeros(len(self.points), np.bool_)

    @cached_property
    def area(self) -> float:
        """Area of the sea, in steradians."""
        pole = np.broadcast_to(-normalize(self.points.sum(axis=0)[None]), self.points.shape)
        fan = triangle_area(pole, self.points, self.points[self.following])
        return float(np.mod(np.sum(fan), 4.0 * np.pi))

    @cached_property
    def lengths(self) -> Array:
        """Chords (m,) from each point to the following one."""
        return np.sqrt(dot(self._steps, self._steps))

    def distance(self, points: Array) -> Array:
        """Chords (n,) from points (n, 3) to the coast, positive at sea and negative on land.

        The nearest arc is sought among those that meet in the nearest vertices, as lengths of arcs differ little.
        """
        _, near = self._tree.query(points, min(NEAREST_VERTICES, len(self.points)))
        arcs = np.concatenate([near, self._preceding[near]], axis=1)
        start, step = self.points[arcs], self._steps[arcs]
        from_start = points[:, None, :] - start
        part = np.clip(dot(from_start, step) / dot(step, step), 0.0, 1.0)
        offset = from_start - part[..., None] * step
        best = np.argmin(dot(offset, offset), axis=1)
        row = np.arange(len(points))
        arc, part, offset = arcs[row, best], part[row, best], offset[row, best]
        left = self._left[arc].copy()
        at_start, at_end = part == 0.0, part == 1.0
        left[at_start] += self._left[self._preceding[arc[at_start]]]
        left[at_end] += self._left[self.following[arc[at_end]]]
        return np.where(dot(offset, left) >= 0.0, 1.0, -1.0) * np.sqrt(dot(offset, offset))

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in the sea."""
        return self.distance(points) > 0.0

    @cached_property
    def _steps(self) -> Array:
        return self.points[self.following] - self.points

    @cached_property
    def _left(self) -> Array:
        """Unit vectors (m, 3) to the left of each arc."""
        return normalize(np.cross(self.points, self._steps))

    @cached_property
    def _preceding(self) -> Index:
        preceding = np.empty_like(self.following)
        preceding[self.following] = np.arange(len(self.points), dtype=np.int32)
        return preceding

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.points)

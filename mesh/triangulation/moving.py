"""A Delaunay triangulation that follows its moving points: flips where they do, a convex hull where they do not."""

from typing import Protocol

import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.sphere import normalize
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins, fill_rings, first_corners
from mesh.triangulation.ordering import sort_triangles
from mesh.triangulation.repair import TRIANGLE_BLOCK, count_covers, flip_marked, survey, untangle

UNTANGLING_ROUNDS = 4
"""How often inverted triangles are set right by flips before other means are tried."""

FOLLOWING_FRACTIONS = np.arange(8) / 8
"""Parts of a move at which the triangulation is repaired where it cannot follow the move as a whole."""


class MovingCells(Protocol):
    """Cells of moving points, bounded by places on the sphere, as `Triangulation` has them."""

    circumcenters: Array

    @property
    def ring_starts(self) -> Index:
        """Where the ring of each cell begins (n + 1,)."""

    @property
    def rings(self) -> Index:
        """Triangles round cells, one ring after the other."""

    @property
    def triangles(self) -> Index:
        """Delaunay triangles (m, 3)."""

    def update(self, points: Array, previous: Array | None = None) -> None:
        """Make the cells those of `points` (n, 3), which come from the `previous` ones if these are given."""


class Triangulation:
    """The Delaunay triangulation of n points on the unit sphere that move.

    `triangles` and `twins` (2n - 4, 3) are numbered as `mesh.triangulation.half_edges` says, `circumcenters` (2n - 4,
    3) are unit vectors, and the triangles round point i are `rings[ring_starts[i]:ring_starts[i + 1]]`,
    counter-clockwise. `flips` and `rebuilds` count what was needed so far.
    """

    def __init__(self, points: Array, triangles: Index | None = None) -> None:
        """Triangulate unit vectors `points` (n, 3); `triangles` may give a valid triangulation to start from.

        Raises `MeshError` where points coincide or do not surround the sphere.
        """
        n_triangles = 2 * len(points) - 4
        n_blocks = (n_triangles + TRIANGLE_BLOCK - 1) // TRIANGLE_BLOCK
        self.circumcenters = np.empty((n_triangles, 3))
        self.rings = np.empty(3 * n_triangles, np.int32)
        self.ring_starts = np.empty(len(points) + 1, np.int32)
        self.flips = 0
        self.rebuilds = 0
        self._marks = np.empty(n_triangles, np.uint8)
        self._violations = np.empty(n_blocks, np.int64)
        self._inversions = np.empty(n_blocks, np.int64)
        self._connect(sort_triangles(delaunay(points)) if triangles is None else triangles, len(points))
        self.update(points)

    def update(self, points: Array, previous: Array | None = None) -> None:
        """Make the triangulation that of `points` (n, 3).

        Where flips alone fail, the points are followed on their way from the `previous` ones, if these are given;
        where that fails too, the triangulation is rebuilt by a convex hull.
        """
        if self._repair(points) or (previous is not None and self._follow(previous, points)):
            return
        self.rebuilds += 1
        self._connect(sort_triangles(delaunay(points)), len(points))
        # The hull decides sides within round-off in its own way; what the repair makes of it is as good.
        self._repair(points)

    def _connect(self, triangles: Index, n_points: int) -> None:
        """Set the triangles and what follows from them, apart from positions."""
        self.triangles: Index = np.array(triangles, dtype=np.int32, order="C")
        self.twins = build_twins(self.triangles, n_points)
        self._first_corner, self._degrees = first_corners(self.triangles, n_points)
        self._fill_rings()

    def _fill_rings(self) -> None:
        fill_rings(self.twins, self._first_corner, self._degrees, self.ring_starts, self.rings)

    def _survey(self, points: Array) -> tuple[int, int]:
        """Set circumcentres and marks for `points`; give the numbers of inverted triangles and of marked sides."""
        survey(points, self.triangles, self.twins, self.circumcenters, self._marks, self._violations, self._inversions)
        return int(self._inversions.sum()), int(self._violations.sum())

    def _repair(self, points: Array) -> bool:
        """Flip sides until all are Delaunay for `points`; False where that does not succeed."""
        arrays = (self.triangles, self.twins, self._first_corner, self._degrees)
        flips = 0
        inverted, marked = self._survey(points)
        for _ in range(UNTANGLING_ROUNDS):
            if not inverted:
                break
            flips += untangle(points, *arrays, self._marks, self._inversions)
            inverted, marked = self._survey(points)
        if inverted:
            return False
        if marked:
            made = flip_marked(points, *arrays, self.circumcenters, self._marks, self._violations)
            if made < 0:
                return False
            flips += made
        if flips:
            self._fill_rings()
            self.flips += flips
            return self._covers_once(points)
        return True

    def _covers_once(self, points: Array) -> bool:
        """Whether triangles that are Delaunay to their neighbours cover the sphere once, and so are so to all points.

        Triangles that cover it d times without turning over cover a point d times too, unless all d sheets meet in it;
        and that they do in two points at most, by the formula of Riemann and Hurwitz. So three points tell.
        """
        probes = np.arange(3) * (len(points) // 3)
        return int(count_covers(points, self.triangles, self.circumcenters, probes)) == 0

    def _follow(self, previous: Array, points: Array) -> bool:
        """Repair at points along the way from `previous` to `points`; False where that does not succeed."""
        way = (normalize(previous + fraction * (points - previous)) for fraction in FOLLOWING_FRACTIONS)
        return all(self._repair(between) for between in way) and self._repair(points)

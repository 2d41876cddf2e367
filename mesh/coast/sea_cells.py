"""Voronoi cells of moving generators, clipped by a coast: what an optimiser takes in the place of a triangulation."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array, Index
from mesh.coast.clipped_rings import fill_clipped_rings, list_portions
from mesh.coast.coastline import Coast
from mesh.coast.crossings import NO_ROOM, NOT_CLOSED, follow_coast
from mesh.errors import MeshError
from mesh.generation.optimizer import ScvtResult
from mesh.triangulation.moving import MovingCells, Triangulation


class SeaCells:
    """The cells of n generators in the sea, clipped by its coast.

    `circumcenters` are the places that bound cells: the circumcentres of all triangles, the `n_coast` points of the
    coast, and its crossings from cell to cell, `n_triangles` and `n_coast` and `n_crossings` of them in this order.
    Those round cell i, counter-clockwise, are `rings[ring_starts[i]:ring_starts[i + 1]]` (see
    `mesh.coast.clipped_rings`); `loops` (n,) counts the closed lines that bound it. `crossing_cells` (n_crossings, 2)
    tells which cells the coast leaves and enters. So all of `mesh.integrals` is that of the clipped cells.

    `fillers` (k, 3) are points on land that the triangulation needs to surround the sphere; they come after the
    generators in it, and their cells should not reach the sea. Where the cells are only a part of those of the sea,
    generators round them are fillers too.
    """

    def __init__(
        self,
        points: Array,
        coastline: Coast,
        fillers: Array,
        triangulated: Callable[[Array], MovingCells] = Triangulation,
    ) -> None:
        """Clip the cells of `points` (n, 3), unit vectors; raise `MeshError` where they cannot be triangulated.

        So does it, and `update`, where rounding hides in which cell a ring of the coast begins. In the plane
        `triangulated` gives the whole cells.
        """
        self._coastline, self._fillers = coastline, fillers
        self._all_points = np.concatenate([points, fillers])
        self._triangulation = triangulated(self._all_points)
        n_rings = coastline.n_rings
        self.n_triangles, self.n_coast = len(self._triangulation.triangles), len(coastline.points)
        self.n_crossings = 0
        self._hints = np.zeros(n_rings, np.int32)
        self._ring_of_arc = np.repeat(np.arange(n_rings, dtype=np.int32), np.diff(coastline.ring_starts))
        self._crossing_starts = np.zeros(n_rings + 1, np.int32)
        self.ring_starts: Index = np.empty(len(points) + 1, np.int32)
        self.loops = np.empty(len(points), np.int32)
        self._first_portion = np.empty(len(self._all_points), np.int32)
        self._make_room(len(coastline.points))
        self._clip()

    @property
    def triangles(self) -> Index:
        """Delaunay triangles (n_triangles, 3) of generators and fillers."""
        return self._triangulation.triangles

    @property
    def coastline(self) -> Coast:
        """The coast."""
        return self._coastline

    @property
    def fillers(self) -> Array:
        """Points (k, 3) that complete the triangulation."""
        return self._fillers

    @property
    def n_cells(self) -> int:
        """Number of generators."""
        return len(self.loops)

    @property
    def crossing_cells(self) -> Index:
        """Cells (n_crossings, 2) that the coast leaves and enters at each crossing; fillers come after generators."""
        return self._cells[: self.n_crossings]

    def update(self, points: Array, previous: Array | None = None) -> None:
        """Make the cells those of `points` (n, 3), which come from the `previous` ones if these are given."""
        before = None if previous is None else np.concatenate([previous, self._fillers])
        self._all_points[: len(points)] = points
        self._triangulation.update(self._all_points, before)
        self._clip()

    def _make_room(self, crossings: int) -> None:
        """Arrays for that many crossings."""
        n_rings = self._coastline.n_rings
        self._crossings = np.empty((crossings, 3))
        self._arcs = np.empty(crossings, np.int32)
        self._cells = np.empty((crossings, 2), np.int32)
        self._next_portion = np.empty(crossings + n_rings, np.int32)
        # Every portion adds its two ends; where a cell has several lines round it, each returns to two places.
        longest = len(self._triangulation.rings) + self.n_coast + 5 * (crossings + n_rings)
        self.rings: Index = np.empty(longest, np.int32)

    def _clip(self) -> None:
        whole, coastline = self._triangulation, self._coastline
        cells = self._all_points, whole.triangles, whole.ring_starts, whole.rings
        coast, is_flat = (coastline.points, coastline.ring_starts), coastline.surface.is_flat
        while True:
            starts, arcs = self._crossing_starts, self._arcs
            self.n_crossings = follow_coast(
                *cells, is_flat, *coast, self._hints, starts, self._crossings, arcs, self._cells
            )
            if self.n_crossings == NOT_CLOSED:
                raise MeshError(
                    "a ring of the coast ends in another cell than it begins in, however often it is followed; "
                    "begin it at another of its points, or move the generators a little"
                )
            if self.n_crossings != NO_ROOM:
                break
            self._make_room(2 * len(self._crossings))
        self.circumcenters = np.concatenate([whole.circumcenters, coast[0], self._crossings[: self.n_crossings]])
        portions = self._first_portion, self._next_portion
        list_portions(self._crossing_starts, self._cells, self._hints, *portions)
        fill_clipped_rings(
            self._all_points,
            whole.ring_starts,
            whole.rings,
            whole.triangles,
            is_flat,
            self.circumcenters,
            self.n_triangles,
            coastline.ring_starts,
            self._ring_of_arc,
            self._crossing_starts,
            self._arcs,
            self.crossing_cells,
            *portions,
            self.ring_starts,
            self.rings,
            self.loops,
        )


@dataclass(frozen=True, eq=False)
class SeaResult:
    """Converged generators, and their clipped cells."""

    result: ScvtResult
    sea: SeaCells

"""Corners and sides of clipped cells: what of their rings a mesh keeps.

Corners are circumcentres and crossings of the coast; other points of the coast are no corners, so that a cell's portion
of the coast is one side, but for those that the coast says are `Coast.corners`.
"""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.coast.crossings import neighbour_across
from mesh.coast.sea_cells import SeaCells
from mesh.errors import MeshError

COAST = -1
"""In the place of a neighbour: the side is a portion of the coast."""

FEWEST_SIDES = 3


@dataclass(frozen=True, eq=False)
class Corners:
    """Those of cell i are rows `starts[i]` to `starts[i + 1] - 1`, counter-clockwise.

    `places` (n_corners,) are rows of `SeaCells.circumcenters`; `neighbours` (n_corners,) are the cells across the sides
    from each corner to the next, `COAST` for the coast; `cells` (n_corners,) are the cells themselves.
    """

    starts: Index
    places: Index
    neighbours: Index
    cells: Index


def corners_of(sea: SeaCells) -> Corners:
    """The corners of all cells.

    Raises `MeshError` where a cell is in several parts or encloses an island, where two cells meet along several
    sides, where one has too few sides, or where the sea lies nearer to a filler than to any generator.
    """
    number = int(np.argmax(sea.loops > 1))
    if sea.loops[number] > 1:
        raise _too_coarse(sea, f"cell {number} is in several parts or goes round an island")
    corners = _all_corners(sea)
    sizes = np.diff(corners.starts)
    if max(corners.neighbours.max(), sea.crossing_cells.max(initial=0)) >= sea.n_cells:
        raise _too_coarse(sea, "some sea lies farther from all generators than from points on land")
    if sizes.min() < FEWEST_SIDES:
        raise _too_coarse(sea, f"cell {np.argmin(sizes)} has {sizes.min()} sides")
    _require_one_side_each(corners, sea)
    return corners


def corners_and_faults(sea: SeaCells) -> tuple[Corners, NDArray[np.bool_]]:
    """The corners of all cells, and which cells (n_cells,) are none that `corners_of` would allow, beside fillers also.

    The corners of those are of no use.
    """
    corners = _all_corners(sea)
    faulty = (sea.loops > 1) | (np.diff(corners.starts) < FEWEST_SIDES)
    faulty[corners.cells[corners.neighbours >= sea.n_cells]] = True
    pairs, counts = pairs_of_cells(corners.cells, corners.neighbours, sea.n_cells)
    faulty[pairs[counts > 1] // sea.n_cells] = True
    return corners, faulty


def _all_corners(sea: SeaCells) -> Corners:
    """The corners of all cells, sound or not."""
    starts = np.empty(sea.n_cells + 1, np.int32)
    places, neighbours = np.empty_like(sea.rings), np.empty_like(sea.rings)
    crossings = sea.crossing_cells, sea.coastline.corners, sea.n_triangles, sea.n_triangles + sea.n_coast
    count = _fill_corners(sea.ring_starts, sea.rings, sea.triangles, *crossings, starts, places, neighbours)
    cells = np.repeat(np.arange(sea.n_cells, dtype=np.int32), np.diff(starts))
    return Corners(starts, places[:count], neighbours[:count], cells)


def following_rows(starts: Index) -> Index:
    """The next row (starts[-1],) round each of the rings that begin at `starts`, up to the last of these."""
    following = np.arange(1, starts[-1] + 1)
    following[starts[1:] - 1] = starts[:-1]
    return following


def preceding_rows(starts: Index) -> Index:
    """The row (starts[-1],) before each round the rings that begin at `starts`, up to the last of these."""
    preceding = np.arange(-1, starts[-1] - 1)
    preceding[starts[:-1]] = starts[1:] - 1
    return preceding


@numba.njit(cache=True)
def _fill_corners(
    ring_starts: Index,
    rings: Index,
    triangles: Index,
    crossing_cells: Index,
    coast_corners: NDArray[np.bool_],
    n_triangles: int,
    after_coast: int,
    starts: Index,
    places: Index,
    neighbours: Index,
) -> int:
    """Write the corners of all cells as `Corners` has them; give how many there are."""
    count = 0
    for cell in range(len(ring_starts) - 1):
        starts[cell] = count
        for slot in range(ring_starts[cell], ring_starts[cell + 1]):
            place = rings[slot]
            if place < n_triangles:
                neighbours[count] = neighbour_across(triangles, place, cell)
            elif place < after_coast:
                if not coast_corners[place - n_triangles]:
                    continue
                neighbours[count] = COAST
            else:
                entered = crossing_cells[place - after_coast, 1]
                neighbours[count] = COAST if entered == cell else entered
            places[count] = place
            count += 1
    starts[-1] = count
    return count


def _require_one_side_each(corners: Corners, sea: SeaCells) -> None:
    """Raise `MeshError` where a cell meets a neighbour along several sides."""
    found, counts = pairs_of_cells(corners.cells, corners.neighbours, sea.n_cells)
    if counts.max() > 1:
        cell, other = divmod(int(found[np.argmax(counts)]), sea.n_cells)
        raise _too_coarse(sea, f"cells {cell} and {other} meet on both sides of some land")


def pairs_of_cells(cells: Index, neighbours: Index, n_cells: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Cell times `n_cells` plus neighbour of all sides between cells, each pair once, and how often there is each."""
    inner = (neighbours != COAST) & (neighbours < n_cells)
    pairs = cells[inner].astype(np.int64) * n_cells + neighbours[inner]
    return np.unique(pairs, return_counts=True)


def _too_coarse(sea: SeaCells, what: str) -> MeshError:
    return MeshError(f"{what}: ask for more cells, or for {sea.coastline.wider}")

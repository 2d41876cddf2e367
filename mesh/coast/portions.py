"""Portions of the coast in clipped cells: where their edges have their points, and what area lies to either side.

They lead from crossing to crossing of the coast; where there are `Coast.corners` between these, from one to the next.
"""

from dataclasses import dataclass

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.coast.sea_cells import SeaCells
from mesh.errors import MeshError
from mesh.geometry.vectors import Vector, area_parts, compiled, dot_product, vector_between, vector_to


@dataclass(frozen=True, eq=False)
class Portions:
    """Of portion p, from end p to the next of its ring: its point, and the areas of its cell on both sides.

    Ends are the crossings and, after them, the corners of the coast. The `points` (n, 3) are those of the coast that
    are nearest to the generator. `areas` (n, 2) lie between the generator and the coast, from end p to the point, and
    from there on. `next_end` (n,) is where the portion ends, `lengths` (n,) are along the coast, in radians or metres.
    """

    points: Array
    areas: Array
    next_end: Index
    lengths: Array


def portions_of(sea: SeaCells, generators: Array) -> Portions:
    """The portions of the coast of cells that each touch it, for the `generators` (n_cells, 3) of the `sea`.

    Raises `MeshError` where the coast is not followed from each cell into the next.
    """
    corners = _corners(sea)
    n = sea.n_crossings + len(corners)
    portions = Portions(np.zeros((n, 3)), np.zeros((n, 2)), np.full(n, -1, np.int32), np.zeros(n))
    # The cells in which the coast arrives at each end, and goes on from it; what is missing is filled.
    cells = np.concatenate([sea.crossing_cells, np.full((len(corners), 2), -1, np.int32)])
    _measure(
        generators,
        sea.ring_starts,
        sea.rings,
        sea.circumcenters,
        sea.coastline.surface.is_flat,
        ends_of(sea, np.arange(len(sea.circumcenters))),
        cells,
        sea.n_crossings,
        portions.points,
        portions.areas,
        portions.next_end,
        portions.lengths,
    )
    _require_each_ends_once(portions, sea, cells)
    return portions


def ends_of(sea: SeaCells, places: Index) -> Index:
    """The ends (n,) of portions that `places` (n,), rows of `SeaCells.circumcenters`, are; -1 for those that are none.

    Corners of the coast come after its crossings.
    """
    after_coast, corners = sea.n_triangles + sea.n_coast, _corners(sea)
    ends = np.full(len(sea.circumcenters), -1, np.int32)
    ends[after_coast:] = np.arange(sea.n_crossings)
    ends[sea.n_triangles + corners] = sea.n_crossings + np.arange(len(corners))
    return ends[places]


def _corners(sea: SeaCells) -> Index:
    return np.flatnonzero(sea.coastline.corners)


def _require_each_ends_once(portions: Portions, sea: SeaCells, cells: Index) -> None:
    """Raise `MeshError` unless each end ends one portion, in the cell that the coast leaves there."""
    ends, known = portions.next_end, portions.next_end >= 0
    arrivals = np.bincount(ends[known], minlength=len(ends))
    wrong = ~known | (arrivals != 1) | (cells[ends, 0] != cells[:, 1])
    if wrong.any():
        first = int(np.argmax(wrong))
        place = np.concatenate([sea.n_triangles + sea.n_coast + np.arange(sea.n_crossings), _corners(sea)])[first]
        raise MeshError(
            f"the coast enters cell {cells[first, 1]} at {sea.coastline.surface.in_words(sea.circumcenters[place])} "
            f"and does not leave it once; ask for another number of cells, or for {sea.coastline.wider}"
        )


@compiled
def _area(corner: Vector, a: Vector, b: Vector, is_flat: bool) -> float:
    """Signed area of the triangle of a generator and two places."""
    if is_flat:
        return 0.5 * ((a[0] - corner[0]) * (b[1] - corner[1]) - (a[1] - corner[1]) * (b[0] - corner[0]))
    numerator, denominator = area_parts(corner, a, b)
    return 2.0 * np.arctan2(numerator, denominator)


@numba.njit(cache=True)
def _nearest_part(generators: Array, cell: int, places: Array, a: int, b: int) -> tuple[float, float]:
    """Where on the arc, as a part of it, it is nearest to the generator, and the square of that distance."""
    step = vector_between(places, a, places, b)
    way = vector_between(places, a, generators, cell)
    square = dot_product(step, step)
    part = min(max(dot_product(way, step) / square, 0.0), 1.0) if square > 0.0 else 0.0
    rest = (way[0] - part * step[0], way[1] - part * step[1], way[2] - part * step[2])
    return part, dot_product(rest, rest)


@numba.njit(cache=True)
def _measure(
    generators: Array,
    ring_starts: Index,
    rings: Index,
    places: Array,
    is_flat: bool,
    ends: Index,
    cells: Index,
    n_crossings: int,
    points: Array,
    areas: Array,
    next_end: Index,
    lengths: Array,
) -> None:
    """Fill the arrays of `Portions`, and the cells of corners of the coast; `ends` are those of all places."""
    split = np.empty((1, 3))
    for cell in range(len(ring_starts) - 1):
        start, stop = ring_starts[cell], ring_starts[cell + 1]
        for first in range(start, stop):
            portion = ends[rings[first]]
            if portion >= n_crossings:
                cells[portion, 0], cells[portion, 1] = cell, cell
            elif portion < 0 or cells[portion, 1] != cell:
                continue
            slot, least = first, np.inf
            areas[portion, 0], areas[portion, 1], lengths[portion] = 0.0, 0.0, 0.0
            while slot == first or ends[rings[slot]] < 0:
                following = slot + 1 if slot + 1 < stop else start
                a, b = rings[slot], rings[following]
                part, square = _nearest_part(generators, cell, places, a, b)
                generator = vector_to(generators, cell)
                area = _area(generator, vector_to(places, a), vector_to(places, b), is_flat)
                step = vector_between(places, a, places, b)
                chord = np.sqrt(dot_product(step, step))
                lengths[portion] += chord if is_flat else 2.0 * np.arcsin(0.5 * chord)
                if square < least:
                    least = square
                    for axis in range(3):
                        split[0, axis] = places[a, axis] + part * (places[b, axis] - places[a, axis])
                    norm = 1.0 if is_flat else np.sqrt(dot_product(vector_to(split, 0), vector_to(split, 0)))
                    for axis in range(3):
                        split[0, axis] /= norm
                        points[portion, axis] = split[0, axis]
                    areas[portion, 0] += areas[portion, 1]
                    before = _area(generator, vector_to(places, a), vector_to(split, 0), is_flat)
                    areas[portion, 0] += before
                    areas[portion, 1] = area - before
                else:
                    areas[portion, 1] += area
                slot = following
            next_end[portion] = ends[rings[slot]]

"""Portions of the coast in clipped cells: where their edges have their points, and what area lies to either side."""

from dataclasses import dataclass

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.coast.sea_cells import SeaCells
from mesh.errors import MeshError
from mesh.geometry.sphere import to_lonlat
from mesh.geometry.vectors import area_parts, dot_product, vector_between, vector_to


@dataclass(frozen=True, eq=False)
class Portions:
    """Of portion p, from crossing p to the next of its ring: its point, and the areas of its cell on both sides.

    The `points` (n_crossings, 3) are those of the coast that are nearest to the generator. `areas` (n_crossings, 2) lie
    between the generator and the coast, from crossing p to the point, and from there on. `next_crossing`
    (n_crossings,) is where the portion ends, `lengths` (n_crossings,) are along the coast, in radians.
    """

    points: Array
    areas: Array
    next_crossing: Index
    lengths: Array


def portions_of(sea: SeaCells, generators: Array) -> Portions:
    """The portions of the coast of cells that each touch it, for the `generators` (n_cells, 3) of the `sea`.

    Raises `MeshError` where the coast is not followed from each cell into the next.
    """
    n = sea.n_crossings
    portions = Portions(np.zeros((n, 3)), np.zeros((n, 2)), np.full(n, -1, np.int32), np.zeros(n))
    _measure(
        generators,
        sea.ring_starts,
        sea.rings,
        sea.circumcenters,
        sea.n_triangles,
        sea.n_triangles + sea.n_coast,
        sea.crossing_cells,
        portions.points,
        portions.areas,
        portions.next_crossing,
        portions.lengths,
    )
    _require_each_ends_once(portions, sea)
    return portions


def _require_each_ends_once(portions: Portions, sea: SeaCells) -> None:
    """Raise `MeshError` unless each crossing ends one portion, in the cell that the coast leaves there."""
    ends, known = portions.next_crossing, portions.next_crossing >= 0
    arrivals = np.bincount(ends[known], minlength=sea.n_crossings)
    wrong = ~known | (arrivals != 1) | (sea.crossing_cells[ends, 0] != sea.crossing_cells[:, 1])
    if wrong.any():
        first = int(np.argmax(wrong))
        longitude, latitude = np.degrees(to_lonlat(sea.circumcenters[sea.n_triangles + sea.n_coast + first]))
        raise MeshError(
            f"the coast enters cell {sea.crossing_cells[first, 1]} at {longitude:.4g}, {latitude:.4g} degrees and does "
            "not leave it once; ask for another number of cells, or for a smoother coast"
        )


@numba.njit(cache=True)
def _area(generators: Array, cell: int, places: Array, a: int, b: int) -> float:
    """Signed area of the triangle of a generator and two places."""
    numerator, denominator = area_parts(vector_to(generators, cell), vector_to(places, a), vector_to(places, b))
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
    n_triangles: int,
    after_coast: int,
    crossing_cells: Index,
    points: Array,
    areas: Array,
    next_crossing: Index,
    lengths: Array,
) -> None:
    """Fill the arrays of `Portions`."""
    split = np.empty((1, 3))
    for cell in range(len(ring_starts) - 1):
        start, stop = ring_starts[cell], ring_starts[cell + 1]
        for first in range(start, stop):
            portion = rings[first] - after_coast
            if portion < 0 or crossing_cells[portion, 1] != cell:
                continue
            slot, least = first, np.inf
            areas[portion, 0], areas[portion, 1], lengths[portion] = 0.0, 0.0, 0.0
            while slot == first or rings[slot] < after_coast:
                following = slot + 1 if slot + 1 < stop else start
                a, b = rings[slot], rings[following]
                part, square = _nearest_part(generators, cell, places, a, b)
                area = _area(generators, cell, places, a, b)
                step = vector_between(places, a, places, b)
                lengths[portion] += 2.0 * np.arcsin(0.5 * np.sqrt(dot_product(step, step)))
                if square < least:
                    least = square
                    for axis in range(3):
                        split[0, axis] = places[a, axis] + part * (places[b, axis] - places[a, axis])
                    norm = np.sqrt(dot_product(vector_to(split, 0), vector_to(split, 0)))
                    for axis in range(3):
                        split[0, axis] /= norm
                        points[portion, axis] = split[0, axis]
                    areas[portion, 0] += areas[portion, 1]
                    numerator, denominator = area_parts(
                        vector_to(generators, cell), vector_to(places, a), vector_to(split, 0)
                    )
                    before = 2.0 * np.arctan2(numerator, denominator)
                    areas[portion, 0] += before
                    areas[portion, 1] = area - before
                else:
                    areas[portion, 1] += area
                slot = following
            next_crossing[portion] = rings[slot] - after_coast

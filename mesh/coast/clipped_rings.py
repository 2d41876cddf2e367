"""Rings of Voronoi cells clipped by a coast, from its crossings.

Counter-clockwise round the part of a cell that is sea, sides of the Voronoi cell lead to where the coast enters the
cell; the coast, which has the sea to its left too, leads on to where it leaves the cell; sides of the cell again, to
where the coast enters it next, which may be where the ring began.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.coast.crossings import from_middle, neighbour_across
from mesh.geometry.vectors import cross_product, dot_product, outward, vector_between, vector_to


@numba.njit(cache=True)
def list_portions(
    crossing_starts: Index, cells: Index, hints: Index, first_portion: Index, next_portion: Index
) -> None:
    """List the portions of the coast in each cell, by links.

    Portion p runs from crossing p to the next one of the ring. Where a whole ring r lies in one cell, its portion has
    the number of crossings plus r.
    """
    first_portion[:] = -1
    n_crossings = crossing_starts[-1]
    for ring in range(len(crossing_starts) - 2, -1, -1):
        if crossing_starts[ring] == crossing_starts[ring + 1]:
            cell, portion = hints[ring], n_crossings + ring
            next_portion[portion], first_portion[cell] = first_portion[cell], portion
    for portion in range(n_crossings - 1, -1, -1):
        cell = cells[portion, 1]
        next_portion[portion], first_portion[cell] = first_portion[cell], portion


@numba.njit(cache=True)
def _side(triangles: Index, corners: Index, cell: int, other: int) -> int:
    """Which side of a cell it shares with another one, -1 where none: side k leads from corner k to the next."""
    for slot in range(len(corners)):
        if neighbour_across(triangles, corners[slot], cell) == other:
            return slot
    return -1


@numba.njit(cache=True)
def _along(points: Array, cell: int, other: int, is_flat: bool, places: Array, place: int) -> float:
    """How far along the side of a cell with another one a place lies, counter-clockwise round the cell.

    Seen from the other cell it is the same number with the opposite sign, to the last bit: both find the same order.
    """
    # On the sphere p x (q - p) is p x q, but not to the last bit.
    away = vector_between(points, cell, points, other) if is_flat else vector_to(points, other)
    onward = cross_product(outward(points, cell, is_flat), away)
    return dot_product(onward, from_middle(vector_to(places, place), points, cell, other, is_flat))


@numba.njit(cache=True)
def _write_coast(
    portion: int,
    leaving: int,
    arcs: Index,
    coast_start: int,
    coast_stop: int,
    n_triangles: int,
    after_coast: int,
    ring: Index,
    count: int,
) -> int:
    """Write a portion of the coast from crossing to crossing; give the new count."""
    ring[count] = after_coast + portion
    count += 1
    point, last = arcs[portion], arcs[leaving]
    whole_round = leaving <= portion and point == last
    while whole_round or point != last:
        whole_round = False
        point = point + 1 if point + 1 < coast_stop else coast_start
        ring[count] = n_triangles + point
        count += 1
    ring[count] = after_coast + leaving
    return count + 1


@numba.njit(cache=True)
def _next_entry(
    points: Array,
    triangles: Index,
    corners: Index,
    cell: int,
    is_flat: bool,
    places: Array,
    after_coast: int,
    cells: Index,
    leaving: int,
    first_portion: Index,
    next_portion: Index,
    visited: NDArray[np.bool_],
    begun: int,
) -> tuple[int, int, int]:
    """Where the coast enters a cell next, counter-clockwise from the crossing `leaving` on: portion, corner, corners.

    `begun` is the portion with which the ring began, and where it closes. On the way are as many corners of the cell as
    told, from the one told on. Which they are follows from the sides that the coast crosses; only along one side do
    positions decide. So it makes no difference where the coast passes through a corner, or corners coincide.
    """
    size, beyond = len(corners), cells[leaving, 1]
    side = _side(triangles, corners, cell, beyond)
    here = _along(points, cell, beyond, is_flat, places, after_coast + leaving)
    entering, fewest, lowest = begun, size + 1, np.inf
    portion = first_portion[cell]
    while portion >= 0:
        if portion < len(cells) and (portion == begun or not visited[portion]):
            before = cells[portion, 0]
            at = _along(points, cell, before, is_flat, places, after_coast + portion)
            passed = (_side(triangles, corners, cell, before) - side) % size
            if passed == 0 and at < here:
                passed = size
            if passed < fewest or (passed == fewest and at < lowest):
                entering, fewest, lowest = portion, passed, at
        portion = next_portion[portion]
    return entering, (side + 1) % size, fewest


@numba.njit(cache=True)
def fill_clipped_rings(
    points: Array,
    ring_starts: Index,
    rings: Index,
    triangles: Index,
    is_flat: bool,
    places: Array,
    n_triangles: int,
    coast_starts: Index,
    ring_of_arc: Index,
    crossing_starts: Index,
    arcs: Index,
    cells: Index,
    first_portion: Index,
    next_portion: Index,
    clipped_starts: Index,
    clipped: Index,
    loops: Index,
) -> None:
    """Write the rings of the cells of the first n points, clipped, to `clipped`, from `clipped_starts` (n + 1,) on.

    They name rows of `places`: circumcentres, points of the coast, and crossings, in this order. `loops` (n,) counts
    the closed lines that bound a cell: where there are several, the ring returns to its first place after each, so that
    sums along it are those along all. A cell that the coast does not enter keeps its ring.
    """
    n_crossings, after_coast = crossing_starts[-1], n_triangles + coast_starts[-1]
    visited = np.zeros(len(next_portion), np.bool_)
    count = 0
    clipped_starts[0] = 0
    for cell in range(len(loops)):
        begin = count
        corners = rings[ring_starts[cell] : ring_starts[cell + 1]]
        portion = first_portion[cell]
        loops[cell] = 0
        if portion < 0 or portion >= n_crossings:
            loops[cell] = 1
            for slot in range(len(corners)):
                clipped[count] = corners[slot]
                count += 1
        while portion >= 0:
            if not visited[portion]:
                loops[cell] += 1
                if loops[cell] > 1:
                    clipped[count] = clipped[begin]
                    count += 1
                loop_begin = count
                if portion >= n_crossings:
                    for point in range(coast_starts[portion - n_crossings], coast_starts[portion - n_crossings + 1]):
                        clipped[count] = n_triangles + point
                        count += 1
                going = portion
                while going < n_crossings and not visited[going]:
                    visited[going] = True
                    ring = ring_of_arc[arcs[going]]
                    leaving = going + 1 if going + 1 < crossing_starts[ring + 1] else crossing_starts[ring]
                    coast = coast_starts[ring], coast_starts[ring + 1]
                    count = _write_coast(
                        going, leaving, arcs, coast[0], coast[1], n_triangles, after_coast, clipped, count
                    )
                    going, corner, passed = _next_entry(
                        points,
                        triangles,
                        corners,
                        cell,
                        is_flat,
                        places,
                        after_coast,
                        cells,
                        leaving,
                        first_portion,
                        next_portion,
                        visited,
                        portion,
                    )
                    for step in range(passed):
                        clipped[count] = corners[(corner + step) % len(corners)]
                        count += 1
                if loops[cell] > 1:
                    clipped[count] = clipped[loop_begin]
                    count += 1
            portion = next_portion[portion]
        if loops[cell] > 1:
            clipped[count] = clipped[begin]
            count += 1
        clipped_starts[cell + 1] = count

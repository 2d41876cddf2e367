"""Where a coast passes from one Voronoi cell into another.

On an arc of the coast, y = a + t (b - a) up to its length, and the side between the cells of p and q is where
y.(p - q) = 0: linear in t. So the coast is followed from cell to cell without trigonometry, and what leaves one cell is
the very point that enters the next.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import dot_product, vector_between, vector_to

NO_ROOM, NOT_CLOSED = -1, -2
"""What `follow_coast` gives in the place of a number of crossings."""

MOST_ROUNDS = 4
"""Times that a ring is followed: once where it begins inside a cell, twice where it begins between two."""


@numba.njit(cache=True)
def neighbour_across(triangles: Index, triangle: int, cell: int) -> int:
    """The cell across the side that leads, counter-clockwise round `cell`, from this circumcentre to the next."""
    corner = 0
    while triangles[triangle, corner] != cell:
        corner += 1
    return triangles[triangle, (corner + 2) % 3]


@numba.njit(cache=True)
def nearest_cell(
    target: tuple[float, float, float], points: Array, triangles: Index, ring_starts: Index, rings: Index, cell: int
) -> int:
    """The cell that contains `target`, found by steps from `cell` to nearer neighbours."""
    best = dot_product(target, vector_to(points, cell))
    going = True
    while going:
        going = False
        centre = cell
        for slot in range(ring_starts[centre], ring_starts[centre + 1]):
            other = neighbour_across(triangles, rings[slot], centre)
            product = dot_product(target, vector_to(points, other))
            if product > best:
                best, cell, going = product, other, True
    return cell


@numba.njit(cache=True)
def _follow_ring(
    points: Array,
    triangles: Index,
    ring_starts: Index,
    rings: Index,
    coast: Array,
    first: int,
    last: int,
    cell: int,
    count: int,
    crossings: Array,
    arcs: Index,
    cells: Index,
) -> tuple[int, int]:
    """Write the crossings of the ring of points `first` to `last` - 1, which starts in `cell`, from row `count` on.

    Gives how many there are then, `NO_ROOM` without room for all, and the cell in which the ring ends.
    """
    for arc in range(first, last):
        end = arc + 1 if arc + 1 < last else first
        step = vector_between(coast, arc, coast, end)
        start = vector_to(coast, arc)
        passed = 0.0
        while True:
            nearest, entered = 1.0, -1
            for slot in range(ring_starts[cell], ring_starts[cell + 1]):
                other = neighbour_across(triangles, rings[slot], cell)
                away = vector_between(points, cell, points, other)
                slope = dot_product(step, away)
                if slope > 0.0:
                    at = max(-dot_product(start, away) / slope, passed)
                    if at < nearest:
                        nearest, entered = at, other
            if entered < 0:
                break
            if count == len(arcs):
                return NO_ROOM, cell
            x = start[0] + nearest * step[0]
            y = start[1] + nearest * step[1]
            z = start[2] + nearest * step[2]
            factor = 1.0 / np.sqrt(x * x + y * y + z * z)
            crossings[count, 0], crossings[count, 1], crossings[count, 2] = factor * x, factor * y, factor * z
            arcs[count], cells[count, 0], cells[count, 1] = arc, cell, entered
            count += 1
            passed, cell = nearest, entered
    return count, cell


@numba.njit(cache=True)
def follow_coast(
    points: Array,
    triangles: Index,
    ring_starts: Index,
    rings: Index,
    coast: Array,
    coast_starts: Index,
    hints: Index,
    crossing_starts: Index,
    crossings: Array,
    arcs: Index,
    cells: Index,
) -> int:
    """Write the crossings of all rings of the coast, in their order; give how many there are, or what is wrong.

    Ring r has the crossings `crossing_starts[r]` to `crossing_starts[r + 1] - 1`: points in `crossings` (room, 3), the
    arc of the coast in `arcs` (room,) and the cells that the coast leaves and enters there in `cells` (room, 2).
    `hints` (n_rings,) gives a cell near the start of each ring, and gets the one that contains it. Gives `NO_ROOM`
    without room for all, and `NOT_CLOSED` where a ring, followed again and again, ends in another cell than it began.
    """
    count = 0
    crossing_starts[0] = 0
    for ring in range(len(coast_starts) - 1):
        first, last = coast_starts[ring], coast_starts[ring + 1]
        arrived = nearest_cell(vector_to(coast, first), points, triangles, ring_starts, rings, hints[ring])
        begun, begin, rounds = -1, count, 0
        # Where a ring begins on the side between two cells, both contain its first point: the one in which it arrives
        # there is the one to begin in, so that what it crosses there is crossed once.
        while arrived != begun:
            if rounds == MOST_ROUNDS:
                return NOT_CLOSED
            begun = arrived
            count, arrived = _follow_ring(
                points, triangles, ring_starts, rings, coast, first, last, begun, begin, crossings, arcs, cells
            )
            if count < 0:
                return count
            rounds += 1
        hints[ring] = begun
        crossing_starts[ring + 1] = count
    return count

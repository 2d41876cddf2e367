"""Where a coast passes from one Voronoi cell into another.

On an arc of the coast, y = a + t (b - a) up to its length, and the side between the cells of p and q is where
y.(p - q) = 0: linear in t. So the coast is followed from cell to cell without trigonometry, and what leaves one cell is
the very point that enters the next. In the plane, where a loop says `is_flat`, the same holds for y less the middle of
p and q, and y is on the straight line itself.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import Vector, compiled, difference, dot_product, vector_between, vector_to

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


@compiled
def from_middle(place: Vector, points: Array, cell: int, other: int, is_flat: bool) -> Vector:
    """The way to a place from the middle of two cells; on the sphere, whose sides do so too, from the origin.

    To the last bit it is the same for the two in the other order.
    """
    if is_flat:
        x, y = points[cell, 0] + points[other, 0], points[cell, 1] + points[other, 1]
        return (place[0] - 0.5 * x, place[1] - 0.5 * y, 0.0)
    return place


@compiled
def _nearness(target: Vector, points: Array, cell: int, is_flat: bool) -> float:
    """What is largest for the cell that contains the target."""
    if is_flat:
        way = difference(vector_to(points, cell), target)
        return -dot_product(way, way)
    return dot_product(target, vector_to(points, cell))


@numba.njit(cache=True)
def nearest_cell(
    target: Vector, points: Array, triangles: Index, ring_starts: Index, rings: Index, cell: int, is_flat: bool
) -> int:
    """The cell that contains `target`, found by steps from `cell` to nearer neighbours."""
    best = _nearness(target, points, cell, is_flat)
    going = True
    while going:
        going = False
        centre = cell
        for slot in range(ring_starts[centre], ring_starts[centre + 1]):
            other = neighbour_across(triangles, rings[slot], centre)
            nearness = _nearness(target, points, other, is_flat)
            if nearness > best:
                best, cell, going = nearness, other, True
    return cell


@numba.njit(cache=True)
def _follow_ring(
    points: Array,
    triangles: Index,
    ring_starts: Index,
    rings: Index,
    is_flat: bool,
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
                    rise = dot_product(from_middle(start, points, cell, other, is_flat), away)
                    at = max(-rise / slope, passed)
                    if at < nearest:
                        nearest, entered = at, other
            if entered < 0:
                break
            if count == len(arcs):
                return NO_ROOM, cell
            x = start[0] + nearest * step[0]
            y = start[1] + nearest * step[1]
            z = start[2] + nearest * step[2]
            factor = 1.0 if is_flat else 1.0 / np.sqrt(x * x + y * y + z * z)
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
    is_flat: bool,
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
        arrived = nearest_cell(vector_to(coast, first), points, triangles, ring_starts, rings, hints[ring], is_flat)
        begun, begin, rounds = -1, count, 0
        # Where a ring begins on the side between two cells, both contain its first point: the one in which it arrives
        # there is the one to begin in, so that what it crosses there is crossed once.
        while arrived != begun:
            if rounds == MOST_ROUNDS:
                return NOT_CLOSED
            begun = arrived
            count, arrived = _follow_ring(
                points, triangles, ring_starts, rings, is_flat, coast, first, last, begun, begin, crossings, arcs, cells
            )
            if count < 0:
                return count
            rounds += 1
        hints[ring] = begun
        crossing_starts[ring + 1] = count
    return count

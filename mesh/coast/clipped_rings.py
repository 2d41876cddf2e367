"""Rings of Voronoi cells clipped by a coast, from its crossings.

Counter-clockwise round the part of a cell that is sea, sides of the Voronoi cell lead to where the coast enters the
cell; the coast, which has the sea to its left too, leads on to where it leaves the cell; sides of the cell again, to
where the coast enters it next, which may be where the ring began.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import Vector, cross_product, dot_product, vector_between, vector_to

TURN = 2.0 * np.pi


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
def _angle(center: Vector, east: Vector, north: Vector, places: Array, place: int) -> float:
    """Direction of a place as seen from the centre of a cell, counter-clockwise, in radians."""
    way = (places[place, 0] - center[0], places[place, 1] - center[1], places[place, 2] - center[2])
    return np.arctan2(dot_product(way, north), dot_product(way, east))


@numba.njit(cache=True)
def _after(angle: float, start: float) -> float:
    """How far counter-clockwise an angle lies from the start, in [0, 2 pi)."""
    turn = angle - start
    return turn + TURN if turn < 0.0 else turn


@numba.njit(cache=True)
def _frame(points: Array, cell: int, places: Array, place: int) -> tuple[Vector, Vector, Vector]:
    """Centre of a cell, and two directions at right angles, of which the first leads towards a place."""
    center = vector_to(points, cell)
    way = vector_between(points, cell, places, place)
    radial = dot_product(way, center)
    east = (way[0] - radial * center[0], way[1] - radial * center[1], way[2] - radial * center[2])
    return center, east, cross_product(center, east)


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
def _write_sides(corners: Index, angles: Array, start: float, turn: float, ring: Index, count: int) -> int:
    """Write the corners of a cell that follow within `turn` after the angle `start`; give the new count."""
    nearest, nearest_turn = 0, TURN
    for slot in range(len(corners)):
        after = _after(angles[slot], start)
        if after < nearest_turn:
            nearest, nearest_turn = slot, after
    for step in range(len(corners)):
        slot = (nearest + step) % len(corners)
        if _after(angles[slot], start) >= turn:
            break
        ring[count] = corners[slot]
        count += 1
    return count


@numba.njit(cache=True)
def fill_clipped_rings(
    points: Array,
    ring_starts: Index,
    rings: Index,
    places: Array,
    n_triangles: int,
    coast_starts: Index,
    ring_of_arc: Index,
    crossing_starts: Index,
    arcs: Index,
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
        angles = np.empty(0)
        center, east, north = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if portion < 0 or portion >= n_crossings:
            loops[cell] = 1
            for slot in range(len(corners)):
                clipped[count] = corners[slot]
                count += 1
        else:
            center, east, north = _frame(points, cell, places, after_coast + portion)
            angles = np.empty(len(corners))
            for slot in range(len(corners)):
                angles[slot] = _angle(center, east, north, places, corners[slot])
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
                    start = _angle(center, east, north, places, after_coast + leaving)
                    turn = TURN
                    other = first_portion[cell]
                    while other >= 0:
                        if other < n_crossings and (other == portion or not visited[other]):
                            after = _after(_angle(center, east, north, places, after_coast + other), start)
                            if after < turn:
                                going, turn = other, after
                        other = next_portion[other]
                    count = _write_sides(corners, angles, start, turn, clipped, count)
                if loops[cell] > 1:
                    clipped[count] = clipped[loop_begin]
                    count += 1
            portion = next_portion[portion]
        if loops[cell] > 1:
            clipped[count] = clipped[begin]
            count += 1
        clipped_starts[cell + 1] = count

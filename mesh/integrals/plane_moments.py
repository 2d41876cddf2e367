"""Moments, energy and gradient of Voronoi cells in a plane under uniform density.

With u_k = c_k - x the corners of a cell seen from its generator x, counter-clockwise, the triangle of x and two
successive corners u, v has the area u x v / 2, the first moment (u x v) (u + v) / 6 about x, and the second moment
(u x v) (u.u + u.v + v.v) / 12, which is its part of the energy.
"""

import numba

from mesh.arrays import Array, Index
from mesh.geometry.vectors import vector_between
from mesh.integrals.moments import BLOCK


@numba.njit(cache=True, fastmath=False)
def plane_cell(
    points: Array, corners: Array, ring_starts: Index, rings: Index, cell: int
) -> tuple[float, float, float, float]:
    """Area, first moment about the generator (two floats) and energy of one cell; see `evaluate_in_plane`."""
    start, stop = ring_starts[cell], ring_starts[cell + 1]
    ux, uy, _ = vector_between(points, cell, corners, rings[stop - 1])
    area, mx, my, energy = 0.0, 0.0, 0.0, 0.0
    for slot in range(start, stop):
        vx, vy, _ = vector_between(points, cell, corners, rings[slot])
        turn = ux * vy - uy * vx
        area += turn
        mx += turn * (ux + vx)
        my += turn * (uy + vy)
        energy += turn * (ux * ux + uy * uy + ux * vx + uy * vy + vx * vx + vy * vy)
        ux, uy = vx, vy
    return area / 2.0, mx / 6.0, my / 6.0, energy / 12.0


@numba.njit(parallel=True, cache=True, error_model="numpy", fastmath=False)
def evaluate_in_plane(
    points: Array,
    corners: Array,
    ring_starts: Index,
    rings: Index,
    direction: Array,
    old_scales: Array,
    gradient: Array,
    scales: Array,
    partials: Array,
) -> None:
    """As `mesh.integrals.moments.evaluate`, with the mass of a cell in the place of x.M."""
    for block in numba.prange(len(partials)):
        energy_sum, slope, largest = 0.0, 0.0, 0.0
        for cell in range(block * BLOCK, min((block + 1) * BLOCK, len(points))):
            mass, mx, my, energy = plane_cell(points, corners, ring_starts, rings, cell)
            scales[cell] = 1.0 / (2.0 * mass) ** 0.5
            gradient[cell, 0] = -2.0 * scales[cell] * mx
            gradient[cell, 1] = -2.0 * scales[cell] * my
            gradient[cell, 2] = 0.0
            energy_sum += energy
            slope -= 2.0 * old_scales[cell] * (mx * direction[cell, 0] + my * direction[cell, 1])
            largest = max(largest, (mx * mx + my * my) / (mass * mass))
        partials[block, 0], partials[block, 1], partials[block, 2] = energy_sum, slope, largest

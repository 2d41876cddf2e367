"""Moments, energy and gradient of spherical Voronoi cells under uniform density.

With x the generator of a cell and u_k = c_k - x its corners (circumcentres) seen from it, counter-clockwise, the
moment of the cell is half the sum over its sides of arc length times unit normal of the side's plane, that is

    M = 1/2 sum_k (c_k x c_k') (s_k / sin s_k) = 1/2 sum_k [(1 + b_k) u_k x u_k' + b_k x x (u_k' - u_k)],

where s_k is the arc from c_k to its successor c_k' and b_k = s_k/sin(s_k) - 1 = q/6 + q^2/30 + ... a series in
q = |u_k' - u_k|^2; the sum of x x (u' - u) round the cell is zero and has been taken out. The terms are as small as
the result, so nothing cancels, and no square root is needed.

The energy of a cell is the integral of |y - x|^2 over it. Polar integration round x leaves an integral along each
side: with y = c + t (c' - c) on the chord of the side, d = 1 - x.y (linear in t), e = 1 - |y| and r the distance from
x, the integral of (1 - cos r)^2 over the angle is

    x.(u x u') times the integral over t in [0, 1] of (d - e) / ((2 - d - e) (1 - e)^2),

by Gauss quadrature. d = |u|^2 / 2 at the corners and e = q t (1 - t) / 2 + ... are small and accurate in relative
terms, hence so is the energy: steps of an optimiser can be judged by it down to round-off of its change.
"""

from typing import Any

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import triple_product, vector_between, vector_to

BLOCK = 1024
"""Cells whose contributions one partial sum holds: sums do not depend on the number of threads."""

SMALL = 1.0e-3
"""Squared distances (radians^2) below which series replace closed forms."""

OUTER_NODE = 0.5 * (1.0 - np.sqrt(0.6))
_gauss_nodes, _gauss_weights = np.polynomial.legendre.leggauss(8)
GAUSS_NODES = 0.5 * (1.0 + _gauss_nodes)
GAUSS_WEIGHTS = 0.5 * _gauss_weights

OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}
contracted = numba.njit(**OPTIONS)
"""A product and a sum may be rounded as one. Numba gives a function without options those of whatever calls it first:
functions that state theirs have the same last digits in any order. None of these calls `mesh.geometry.vectors`."""


@contracted
def _small_excess(square: float) -> float:
    """The value of s / sin(s) - 1 for an arc s with squared chord below SMALL."""
    return square * (1 / 6 + square * (1 / 30 + square * (1 / 140 + square / 630)))


@contracted
def _excess(square: float) -> float:
    """The value of s / sin(s) - 1 for an arc s below pi with any squared chord."""
    if square < SMALL:
        return _small_excess(square)
    half = np.sqrt(0.25 * square)
    return np.arcsin(half) / (half * np.sqrt(1.0 - half * half)) - 1.0


@contracted
def _small_sag(square: float) -> float:
    """1 - sqrt(1 - square) for a small square."""
    return square * (1 / 2 + square * (1 / 8 + square * (1 / 16 + square * (5 / 128))))


@contracted
def _small_integrand(drop: float, sag: float) -> float:
    """2 (d - e) / ((2 - d - e) (1 - e)^2) for small d and e."""
    mean = 0.5 * (drop + sag)
    return (drop - sag) * (1.0 + mean * (1.0 + mean * (1.0 + mean))) * (1.0 + sag * (2.0 + sag * (3.0 + 4.0 * sag)))


@contracted
def _small_side(drop: float, next_drop: float, square: float) -> float:
    """Integral of the energy along a short side close to the generator."""
    outer_sag, middle_sag = _small_sag(0.1 * square), _small_sag(0.25 * square)
    change = OUTER_NODE * (next_drop - drop)
    return 5 / 36 * (
        _small_integrand(drop + change, outer_sag) + _small_integrand(next_drop - change, outer_sag)
    ) + 8 / 36 * _small_integrand(0.5 * (drop + next_drop), middle_sag)


@contracted
def _large_side(drop: float, next_drop: float, square: float) -> float:
    """Integral of the energy along any side, eight nodes."""
    total = 0.0
    for node in range(8):
        t = GAUSS_NODES[node]
        part = t * (1.0 - t) * square
        sag = part / (1.0 + np.sqrt(1.0 - part))
        here = drop + t * (next_drop - drop)
        total += GAUSS_WEIGHTS[node] * (here - sag) / ((2.0 - here - sag) * (1.0 - sag) ** 2)
    return total


@contracted
def cell_moment(
    points: Array, circumcenters: Array, ring_starts: Index, rings: Index, cell: int
) -> tuple[float, float, float, float]:
    """First moment (three floats) and energy of one cell."""
    x, y, z = points[cell, 0], points[cell, 1], points[cell, 2]
    start, stop = ring_starts[cell], ring_starts[cell + 1]
    triangle = rings[stop - 1]
    ux = circumcenters[triangle, 0] - x
    uy = circumcenters[triangle, 1] - y
    uz = circumcenters[triangle, 2] - z
    drop = 0.5 * (ux * ux + uy * uy + uz * uz)
    area_x, area_y, area_z = 0.0, 0.0, 0.0
    bulge_x, bulge_y, bulge_z = 0.0, 0.0, 0.0
    energy = 0.0
    for slot in range(start, stop):
        triangle = rings[slot]
        vx = circumcenters[triangle, 0] - x
        vy = circumcenters[triangle, 1] - y
        vz = circumcenters[triangle, 2] - z
        next_drop = 0.5 * (vx * vx + vy * vy + vz * vz)
        dx, dy, dz = vx - ux, vy - uy, vz - uz
        square = dx * dx + dy * dy + dz * dz
        cross_x = uy * vz - uz * vy
        cross_y = uz * vx - ux * vz
        cross_z = ux * vy - uy * vx
        turn = x * cross_x + y * cross_y + z * cross_z
        if drop + next_drop < SMALL:
            excess = _small_excess(square)
            energy += turn * _small_side(drop, next_drop, square)
        else:
            excess = _excess(square)
            energy += turn * _large_side(drop, next_drop, square)
        area_x += cross_x + excess * cross_x
        area_y += cross_y + excess * cross_y
        area_z += cross_z + excess * cross_z
        bulge_x += excess * dx
        bulge_y += excess * dy
        bulge_z += excess * dz
        ux, uy, uz, drop = vx, vy, vz, next_drop
    return (
        0.5 * (area_x + y * bulge_z - z * bulge_y),
        0.5 * (area_y + z * bulge_x - x * bulge_z),
        0.5 * (area_z + x * bulge_y - y * bulge_x),
        energy,
    )


@numba.njit(parallel=True, **OPTIONS)
def evaluate(
    points: Array,
    circumcenters: Array,
    ring_starts: Index,
    rings: Index,
    direction: Array,
    old_scales: Array,
    gradient: Array,
    scales: Array,
    partials: Array,
) -> None:
    """Scaled gradient of every cell, and block sums for the line search.

    gradient (n, 3) gets w_i g_i and scales (n,) gets w_i = 1/sqrt(2 x_i.M_i),
    so that -w_i * gradient_i is the Lloyd step, exactly after retraction.
    partials (number of blocks, 3): energy; sum of g . p where the unscaled
    direction is p_i = old_weights_i * direction_i; largest (|M_t| / x.M)^2.
    """
    for block in numba.prange(len(partials)):
        energy_sum, slope, largest = 0.0, 0.0, 0.0
        for cell in range(block * BLOCK, min((block + 1) * BLOCK, len(points))):
            mx, my, mz, energy = cell_moment(points, circumcenters, ring_starts, rings, cell)
            x, y, z = points[cell, 0], points[cell, 1], points[cell, 2]
            radial = x * mx + y * my + z * mz
            mx -= radial * x
            my -= radial * y
            mz -= radial * z
            scale = 1.0 / np.sqrt(2.0 * radial)
            factor = -2.0 * scale
            gradient[cell, 0] = factor * mx
            gradient[cell, 1] = factor * my
            gradient[cell, 2] = factor * mz
            scales[cell] = scale
            energy_sum += energy
            slope += (
                -2.0 * old_scales[cell] * (mx * direction[cell, 0] + my * direction[cell, 1] + mz * direction[cell, 2])
            )
            largest = max(largest, (mx * mx + my * my + mz * mz) / (radial * radial))
        partials[block, 0] = energy_sum
        partials[block, 1] = slope
        partials[block, 2] = largest


@numba.njit(cache=True, fastmath=False)
def _triangle_area(points: Array, cell: int, circumcenters: Array, before: int, after: int) -> float:
    """Area of the spherical triangle (x, c, c') of a generator x and two circumcentres.

    tan(area / 2) = x.(u x u') / (1 + x.c + c.c' + c'.x) is free of cancellation.
    """
    x, y, z = vector_to(points, cell)
    c, d = vector_to(circumcenters, before), vector_to(circumcenters, after)
    u = vector_between(points, cell, circumcenters, before)
    v = vector_between(points, cell, circumcenters, after)
    denominator = (
        1.0 + x * (c[0] + d[0]) + y * (c[1] + d[1]) + z * (c[2] + d[2]) + c[0] * d[0] + c[1] * d[1] + c[2] * d[2]
    )
    return 2.0 * np.arctan2(triple_product((x, y, z), u, v), denominator)


@numba.njit(parallel=True, cache=True, error_model="numpy", fastmath=False)
def masses_and_moments(
    points: Array, circumcenters: Array, ring_starts: Index, rings: Index
) -> tuple[Array, Array, Array]:
    """Areas (n,), first moments (n, 3) and energies (n,) of all cells."""
    masses = np.empty(len(points))
    moments = np.empty((len(points), 3))
    energies = np.empty(len(points))
    for cell in numba.prange(len(points)):
        mx, my, mz, energy = cell_moment(points, circumcenters, ring_starts, rings, cell)
        moments[cell, 0], moments[cell, 1], moments[cell, 2] = mx, my, mz
        energies[cell] = energy
        before, mass = rings[ring_starts[cell + 1] - 1], 0.0
        for slot in range(ring_starts[cell], ring_starts[cell + 1]):
            mass += _triangle_area(points, cell, circumcenters, before, rings[slot])
            before = rings[slot]
        masses[cell] = mass
    return masses, moments, energies


def number_of_blocks(n_cells: int) -> int:
    """Number of partial sums."""
    return (n_cells + BLOCK - 1) // BLOCK

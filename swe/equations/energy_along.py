"""The energy along the increment of a step: coefficients of c, c^2 and c^3 of E(h + c p, u + c v) - E(h, u).

They are sums in any order (`swe.parallel.folding`), so that the bits of a term must not depend on its place: where the
compiler may fuse one of the products in a b + c d, loops over vectors and what is left of them choose differently. The
letters are those of `swe.equations.kernels`; the increments p and v lead to `h_after` and `u_after`, and heights are
measured from any level.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.parallel.folding import add_all

CHUNK = 256
"""Number of terms summed together; they stay in the first-level cache."""

inlined = numba.njit(error_model="numpy", fastmath=False, forceinline=True)
compiled = numba.njit(cache=True, parallel=True, error_model="numpy", fastmath=False)


@inlined
def _energy_terms_of_edges(
    start: int,
    count: int,
    h: Array,
    u: Array,
    h_after: Array,
    u_after: Array,
    half: Array,
    cells_on_edge: Index,
    first: Array,
    second: Array,
    third: Array,
) -> None:
    """Coefficients of c, c^2 and c^3 in l_e d_e h_e u_e^2 / 2 along increments, of `count` edges from `start` on."""
    for m in range(count):
        e = start + m
        i, j = cells_on_edge[e, 0], cells_on_edge[e, 1]
        h_e, p_e = 0.5 * (h[i] + h[j]), 0.5 * ((h_after[i] - h[i]) + (h_after[j] - h[j]))
        v = u_after[e] - u[e]
        first[m] = half[e] * u[e] * (2.0 * h_e * v + p_e * u[e])
        second[m] = half[e] * v * (h_e * v + 2.0 * p_e * u[e])
        third[m] = half[e] * v * v * p_e


@inlined
def _energy_terms_of_cells(
    start: int, count: int, h: Array, h_after: Array, height: Array, g: float, A: Array, first: Array, second: Array
) -> None:
    """Coefficients of c and c^2 in g A_i h_i (h_i/2 + height_i), of `count` cells from `start` on."""
    for m in range(count):
        i = start + m
        p = h_after[i] - h[i]
        first[m] = g * A[i] * p * (h[i] + height[i])
        second[m] = 0.5 * g * A[i] * p * p


@compiled
def sum_over_edges(
    h: Array,
    u: Array,
    h_after: Array,
    u_after: Array,
    height: Array,
    g: float,
    A: Array,
    half: Array,
    cells_on_edge: Index,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 3, 3) of the coefficients, the largest terms not recorded, where kinetic energy is one of edges.

    The energy is the sum of l_e d_e h_e u_e^2 / 2 over edges, `half` being l_e d_e / 2, and of g A_i h_i (h_i/2 +
    height_i) over cells.
    """
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        sums[k] = 0.0
        terms, spare = np.empty((3, CHUNK)), np.empty(CHUNK)
        last = (k + 1) * u.size // blocks
        for start in range(k * u.size // blocks, last, CHUNK):
            count = min(CHUNK, last - start)
            _energy_terms_of_edges(
                start,
                count,
                h,
                u,
                h_after,
                u_after,
                half,
                cells_on_edge,
                terms[0],
                terms[1],
                terms[2],
            )
            for m in range(3):
                add_all(sums[k, m], terms[m], count, coarse[m], fine[m], spare)
        last = (k + 1) * h.size // blocks
        for start in range(k * h.size // blocks, last, CHUNK):
            count = min(CHUNK, last - start)
            _energy_terms_of_cells(start, count, h, h_after, height, g, A, terms[0], terms[1])
            for m in range(2):
                add_all(sums[k, m], terms[m], count, coarse[m], fine[m], spare)


@inlined
def _kinetic_terms_of_cells(
    start: int,
    count: int,
    h: Array,
    h_after: Array,
    A: Array,
    K: Array,
    K_after: Array,
    K_increment: Array,
    first: Array,
    second: Array,
    third: Array,
) -> None:
    """Coefficients of c, c^2 and c^3 in A_i h_i K_i, of `count` cells from `start` on."""
    for m in range(count):
        i = start + m
        p = h_after[i] - h[i]
        # K is a quadratic form: K(u + c v) = K(u) + c mixed + c^2 K(v).
        mixed = K_after[i] - K[i] - K_increment[i]
        first[m] = A[i] * (h[i] * mixed + p * K[i])
        second[m] = A[i] * (h[i] * K_increment[i] + p * mixed)
        third[m] = A[i] * p * K_increment[i]


@compiled
def sum_over_cells(
    h: Array,
    h_after: Array,
    K: Array,
    K_after: Array,
    K_increment: Array,
    height: Array,
    g: float,
    A: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """The same for kinetic energies K at cells: those of the velocities before and after, and of their difference."""
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        sums[k] = 0.0
        terms, spare = np.empty((3, CHUNK)), np.empty(CHUNK)
        last = (k + 1) * h.size // blocks
        for start in range(k * h.size // blocks, last, CHUNK):
            count = min(CHUNK, last - start)
            _kinetic_terms_of_cells(start, count, h, h_after, A, K, K_after, K_increment, terms[0], terms[1], terms[2])
            for m in range(3):
                add_all(sums[k, m], terms[m], count, coarse[m], fine[m], spare)
            _energy_terms_of_cells(start, count, h, h_after, height, g, A, terms[0], terms[1])
            for m in range(2):
                add_all(sums[k, m], terms[m], count, coarse[m], fine[m], spare)

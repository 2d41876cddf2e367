"""Compiled loops for global integrals: their terms, and sums of these in any order (`swe.parallel.folding`).

The letters are those of `swe.equations.kernels`.
"""

import numba

from mesh.arrays import Array, Index, Signs
from swe.parallel.folding import NOTHING, add

compiled = numba.njit(cache=True, parallel=True, error_model="numpy", fastmath={"contract"})


@compiled
def energies(A: Array, h: Array, b: Array, K: Array, level: float, result: Array) -> None:
    """A_i times h_i K_i, h_i (h_i/2 + b_i), (h_i + b_i - level)^2 and h_i^2 at cells: rows of `result` (4, n_cells)."""
    for i in numba.prange(h.size):
        volume = A[i] * h[i]
        result[0, i] = volume * K[i]
        result[1, i] = volume * (0.5 * h[i] + b[i])
        result[2, i] = A[i] * (h[i] + b[i] - level) ** 2
        result[3, i] = volume * h[i]


@compiled
def vorticities(A: Array, f: Array, zeta: Array, q: Array, result: Array) -> None:
    """A_v (f_v + zeta_v), and that times q_v, at vertices: rows of `result` (2, n_vertices)."""
    for v in numba.prange(q.size):
        result[0, v] = A[v] * (f[v] + zeta[v])
        result[1, v] = result[0, v] * q[v]


@compiled
def work_of(
    a: Array,
    F: Array,
    q: Array,
    edges_on_vertex: Index,
    sign: Signs | Array,
    dc_edge: Array,
    dv_edge: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 3, 3) of what accelerations a_e do to total energy, absolute vorticity and potential enstrophy.

    These are the sums of l_e d_e F_e a_e over edges, and of the circulation C_v = sum_e t_ev d_e a_e and of q_v C_v
    over vertices. Each is folded by `coarse` and `fine` (3,), see `swe.parallel.folding`.
    """
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        energy = vorticity = enstrophy = NOTHING
        for e in range(k * a.size // blocks, (k + 1) * a.size // blocks):
            energy = add(energy, dv_edge[e] * dc_edge[e] * F[e] * a[e], coarse[0], fine[0])
        for v in range(k * q.size // blocks, (k + 1) * q.size // blocks):
            circulation = 0.0
            for j in range(3):
                e = edges_on_vertex[v, j]
                circulation += sign[v, j] * dc_edge[e] * a[e]
            vorticity = add(vorticity, circulation, coarse[1], fine[1])
            enstrophy = add(enstrophy, q[v] * circulation, coarse[2], fine[2])
        for part in range(3):
            sums[k, 0, part], sums[k, 1, part], sums[k, 2, part] = energy[part], vorticity[part], enstrophy[part]


@compiled
def work_of_transport(
    dh: Array,
    A: Array,
    B: Array,
    q: Array,
    cells_on_vertex: Index,
    kites: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 3, 3) of what tendencies of thickness do to mass, total energy and potential enstrophy.

    These are the sums of A_i dh_i and of A_i B_i dh_i over cells, and of -q_v^2/2 sum_i kite_vi dh_i over vertices,
    folded like those of `work_of`.
    """
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        mass = energy = enstrophy = NOTHING
        for i in range(k * dh.size // blocks, (k + 1) * dh.size // blocks):
            mass = add(mass, A[i] * dh[i], coarse[0], fine[0])
            energy = add(energy, A[i] * B[i] * dh[i], coarse[1], fine[1])
        for v in range(k * q.size // blocks, (k + 1) * q.size // blocks):
            volume = 0.0
            for j in range(3):
                volume += kites[v, j] * dh[cells_on_vertex[v, j]]
            enstrophy = add(enstrophy, -0.5 * q[v] * q[v] * volume, coarse[2], fine[2])
        for part in range(3):
            sums[k, 0, part], sums[k, 1, part], sums[k, 2, part] = mass[part], energy[part], enstrophy[part]


@compiled
def bernoulli(h: Array, b: Array, K: Array, g: float, B: Array) -> None:
    """B_i = g (h_i + b_i) + K_i at cells."""
    for i in numba.prange(B.size):
        B[i] = g * (h[i] + b[i]) + K[i]


@compiled
def work_of_forces(
    F: Array,
    du: Array,
    B: Array,
    q: Array,
    cells_on_edge: Index,
    edges_on_vertex: Index,
    sign: Signs | Array,
    dc_edge: Array,
    dv_edge: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 5, 3) of what minus the gradient of B does, and then the rest of du; see `work_of`.

    For the gradient they concern total energy and absolute vorticity, for the rest potential enstrophy as well. The
    gradient's share of potential enstrophy is the sum of q_v over closed paths of differences, zero term by term where
    no cell is missing.
    """
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        energy = vorticity = other_energy = other_vorticity = other_enstrophy = NOTHING
        for e in range(k * du.size // blocks, (k + 1) * du.size // blocks):
            i, j = cells_on_edge[e, 0], cells_on_edge[e, 1]
            outflow = dv_edge[e] * F[e]
            drop = B[i] - B[j]
            energy = add(energy, outflow * drop, coarse[0], fine[0])
            other_energy = add(other_energy, outflow * (dc_edge[e] * du[e] - drop), coarse[2], fine[2])
        for v in range(k * q.size // blocks, (k + 1) * q.size // blocks):
            circulation = other_circulation = 0.0
            for m in range(3):
                e = edges_on_vertex[v, m]
                drop = B[cells_on_edge[e, 0]] - B[cells_on_edge[e, 1]]
                circulation += sign[v, m] * drop
                other_circulation += sign[v, m] * (dc_edge[e] * du[e] - drop)
            vorticity = add(vorticity, circulation, coarse[1], fine[1])
            other_vorticity = add(other_vorticity, other_circulation, coarse[3], fine[3])
            other_enstrophy = add(other_enstrophy, q[v] * other_circulation, coarse[4], fine[4])
        for part in range(3):
            sums[k, 0, part], sums[k, 1, part] = energy[part], vorticity[part]
            sums[k, 2, part], sums[k, 3, part] = other_energy[part], other_vorticity[part]
            sums[k, 4, part] = other_enstrophy[part]

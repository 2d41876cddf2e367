"""Compiled loops of the scheme, one per operator: each entity gathers from its own neighbours, in file order.

The plain twin of `swe.tiles.tile_kernels`, and what diagnostics are computed by. No two threads write to one place, so
results do not depend on the number of threads. Nothing is allocated: every kernel but `largest_rate` writes into the
array that it is given last. `h`, `u`, `q`, ... are named as in the equations of DESIGN and Ringler et al. (2010); the
letters are thickness, normal velocity and potential vorticity.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index, Signs
from swe.parallel.folding import NOTHING, add

compiled = numba.njit(cache=True, parallel=True, error_model="numpy", fastmath={"contract"})


@compiled
def thickness_flux(h: Array, u: Array, cells_on_edge: Index, F: Array) -> None:
    """F_e = h_e u_e at edges, with h_e the mean of the two cells."""
    for e in numba.prange(u.size):
        F[e] = 0.5 * (h[cells_on_edge[e, 0]] + h[cells_on_edge[e, 1]]) * u[e]


@compiled
def relative_vorticity(
    u: Array, edges_on_vertex: Index, sign: Signs, dc_edge: Array, area_triangle: Array, zeta: Array
) -> None:
    """zeta_v = 1/A_v sum_e t_ev u_e d_e at vertices."""
    for v in numba.prange(zeta.size):
        circulation = 0.0
        for j in range(3):
            e = edges_on_vertex[v, j]
            circulation += sign[v, j] * dc_edge[e] * u[e]
        zeta[v] = circulation / area_triangle[v]


@compiled
def potential_vorticity(
    h: Array, zeta: Array, f: Array, cells_on_vertex: Index, kites: Array, area_triangle: Array, q: Array
) -> None:
    """q_v = (f_v + zeta_v)/h_v at vertices, with h_v the kite-weighted mean of the three cells."""
    for v in numba.prange(q.size):
        volume = 0.0
        for j in range(3):
            volume += kites[v, j] * h[cells_on_vertex[v, j]]
        q[v] = (f[v] + zeta[v]) * area_triangle[v] / volume


@compiled
def mean_of_vertices(q: Array, vertices_on_edge: Index, q_edge: Array) -> None:
    """q_e, the mean of the two vertices of each edge."""
    for e in numba.prange(q_edge.size):
        q_edge[e] = 0.5 * (q[vertices_on_edge[e, 0]] + q[vertices_on_edge[e, 1]])


@compiled
def kinetic_energy(
    u: Array,
    n_edges_on_cell: Index,
    edges_on_cell: Index,
    dc_edge: Array,
    dv_edge: Array,
    area_cell: Array,
    K: Array,
) -> None:
    """K_i = 1/A_i sum_e (1/4) l_e d_e u_e^2 at cells."""
    for i in numba.prange(K.size):
        energy = 0.0
        for j in range(n_edges_on_cell[i]):
            e = edges_on_cell[i, j]
            energy += 0.25 * dv_edge[e] * dc_edge[e] * u[e] * u[e]
        K[i] = energy / area_cell[i]


@compiled
def thickness_tendency(
    F: Array, n_edges_on_cell: Index, edges_on_cell: Index, sign: Signs, dv_edge: Array, area_cell: Array, dh: Array
) -> None:
    """dh_i/dt = -1/A_i sum_e n_ei l_e F_e at cells."""
    for i in numba.prange(dh.size):
        outflow = 0.0
        for j in range(n_edges_on_cell[i]):
            e = edges_on_cell[i, j]
            outflow += sign[i, j] * dv_edge[e] * F[e]
        dh[i] = -outflow / area_cell[i]


@compiled
def velocity_tendency(
    h: Array,
    b: Array,
    K: Array,
    F: Array,
    q_edge: Array,
    g: float,
    cells_on_edge: Index,
    n_edges_on_edge: Index,
    edges_on_edge: Index,
    weights_on_edge: Array,
    dc_edge: Array,
    du: Array,
) -> None:
    """du_e/dt = Q_e - 1/d_e [g(h+b) + K] at edges, Q_e = sum_e' weights_ee' F_e' (q_e + q_e')/2."""
    for e in numba.prange(du.size):
        Q = 0.0
        for j in range(n_edges_on_edge[e]):
            other = edges_on_edge[e, j]
            Q += weights_on_edge[e, j] * F[other] * 0.5 * (q_edge[e] + q_edge[other])
        i, k = cells_on_edge[e, 0], cells_on_edge[e, 1]
        du[e] = Q - (g * (h[k] + b[k] - h[i] - b[i]) + K[k] - K[i]) / dc_edge[e]


@compiled
def anticipate(
    u: Array,
    q: Array,
    q_cell: Array,
    time: float,
    cells_on_edge: Index,
    vertices_on_edge: Index,
    n_edges_on_edge: Index,
    edges_on_edge: Index,
    weights_on_edge: Array,
    dc_edge: Array,
    dv_edge: Array,
    q_edge: Array,
) -> None:
    """Take time (u . grad q)_e from q_e at edges: q is anticipated to be what flows there within `time` seconds."""
    for e in numba.prange(u.size):
        tangential = 0.0
        for j in range(n_edges_on_edge[e]):
            tangential += weights_on_edge[e, j] * u[edges_on_edge[e, j]]
        across = (q_cell[cells_on_edge[e, 1]] - q_cell[cells_on_edge[e, 0]]) / dc_edge[e]
        along = (q[vertices_on_edge[e, 1]] - q[vertices_on_edge[e, 0]]) / dv_edge[e]
        q_edge[e] -= time * (u[e] * across + tangential * along)


@compiled
def energy_along(
    h: Array,
    u: Array,
    h_after: Array,
    u_after: Array,
    height: Array,
    g: float,
    A: Array,
    dv_edge: Array,
    dc_edge: Array,
    cells_on_edge: Index,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 3, 3) of the coefficients of c, c^2 and c^3 in the energy at h + c p, u + c v; see `work_of`.

    The increments p and v lead to `h_after` and `u_after`. The energy is the sum of l_e d_e h_e u_e^2 / 2 over edges
    and of g A_i h_i (h_i/2 + height_i) over cells.
    """
    blocks = sums.shape[0]
    for k in numba.prange(blocks):
        first = second = third = NOTHING
        for e in range(k * u.size // blocks, (k + 1) * u.size // blocks):
            i, j = cells_on_edge[e, 0], cells_on_edge[e, 1]
            h_e, p_e = 0.5 * (h[i] + h[j]), 0.5 * ((h_after[i] - h[i]) + (h_after[j] - h[j]))
            v = u_after[e] - u[e]
            half = 0.5 * dv_edge[e] * dc_edge[e]
            first = add(first, half * u[e] * (2.0 * h_e * v + p_e * u[e]), coarse[0], fine[0])
            second = add(second, half * v * (h_e * v + 2.0 * p_e * u[e]), coarse[1], fine[1])
            third = add(third, half * v * v * p_e, coarse[2], fine[2])
        for i in range(k * h.size // blocks, (k + 1) * h.size // blocks):
            p = h_after[i] - h[i]
            first = add(first, g * A[i] * p * (h[i] + height[i]), coarse[0], fine[0])
            second = add(second, 0.5 * g * A[i] * p * p, coarse[1], fine[1])
        for part in range(3):
            sums[k, 0, part], sums[k, 1, part], sums[k, 2, part] = first[part], second[part], third[part]


@compiled
def move_along(h: Array, u: Array, h_after: Array, u_after: Array, factor: float) -> int:
    """Move h and u by `factor` of their way to `h_after` and `u_after`; give the number of unsound values, as below."""
    count = 0
    for i in numba.prange(h.size):
        h[i] += factor * (h_after[i] - h[i])
        if not (0.0 < h[i] < np.inf):
            count += 1
    for e in numba.prange(u.size):
        u[e] += factor * (u_after[e] - u[e])
        if not np.isfinite(u[e]):
            count += 1
    return count


@compiled
def vector_laplacian(
    minus_divergence: Array,
    zeta: Array,
    cells_on_edge: Index,
    vertices_on_edge: Index,
    dc_edge: Array,
    dv_edge: Array,
    result: Array,
) -> None:
    """(grad div u + k x grad zeta)_e at edges, from -div u at cells and zeta at vertices."""
    for e in numba.prange(result.size):
        across = minus_divergence[cells_on_edge[e, 0]] - minus_divergence[cells_on_edge[e, 1]]
        along = zeta[vertices_on_edge[e, 1]] - zeta[vertices_on_edge[e, 0]]
        result[e] = across / dc_edge[e] - along / dv_edge[e]


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
def largest_rate(h: Array, u: Array, g: float, waves: bool, cells_on_edge: Index, dc_edge: Array) -> float:
    """Largest (sqrt(g h) + |u|) / d_e over all edges, 1/s, with the deeper cell's h; |u| / d_e without waves."""
    largest = 0.0
    for e in numba.prange(u.size):
        speed = abs(u[e])
        if waves:
            speed += np.sqrt(g * max(h[cells_on_edge[e, 0]], h[cells_on_edge[e, 1]]))
        largest = max(largest, speed / dc_edge[e])
    return largest


@compiled
def add_scaled(y: Array, factor: float, k: Array, result: Array) -> None:
    """Result = y + factor k, entry by entry; `result` may be `y`."""
    for i in numba.prange(y.size):
        result[i] = y[i] + factor * k[i]


@compiled
def count_unsound(h: Array, u: Array) -> int:
    """Number of thicknesses that are not positive and of values that are not finite."""
    count = 0
    for i in numba.prange(h.size):
        if not (0.0 < h[i] < np.inf):
            count += 1
    for e in numba.prange(u.size):
        if not np.isfinite(u[e]):
            count += 1
    return count


@compiled
def work_of(
    a: Array,
    F: Array,
    q: Array,
    edges_on_vertex: Index,
    sign: Signs,
    dc_edge: Array,
    dv_edge: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 3, 3) of what accelerations a_e do to total energy, absolute vorticity and potential enstrophy.

    The sums of l_e d_e F_e a_e over edges, of the circulation C_v = sum_e t_ev d_e a_e over vertices, and of q_v C_v.
    Each is folded by `coarse` and `fine` (3,), see `swe.parallel.folding`.
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

    The sums of A_i dh_i and of A_i B_i dh_i over cells, and of -q_v^2/2 sum_i kite_vi dh_i over vertices; folded as
    those of `work_of`.
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
    sign: Signs,
    dc_edge: Array,
    dv_edge: Array,
    coarse: Array,
    fine: Array,
    sums: Array,
) -> None:
    """Parts (blocks, 5, 3) of what minus the gradient of B, and what else is in du, do: see `work_of`.

    To energy and absolute vorticity the former, to these and potential enstrophy the latter. The gradient's share of
    potential enstrophy is the sum of q_v over closed paths of differences, zero term by term.
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

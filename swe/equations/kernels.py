"""Compiled loops of the scheme, one per operator: each entity gathers from its own neighbours, in file order.

The plain twin of `swe.tiles.tile_kernels`, also used for the diagnostics. No two threads write to the same place, so
results do not depend on the number of threads. Nothing is allocated: kernels that compute a field write it into their
last argument. The letters are those of the equations in DESIGN and Ringler et al. (2010): `h` is thickness, `u` normal
velocity, `q` potential vorticity, and so on.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index, Signs

STILL = 1e-300
"""Square of a flow past an edge, m4/s2, so weak that it leaves q as it is."""

inlined = numba.njit(error_model="numpy", fastmath={"contract"}, forceinline=True)
compiled = numba.njit(cache=True, parallel=True, error_model="numpy", fastmath={"contract"})


@compiled
def thickness_flux(h: Array, u: Array, cells_on_edge: Index, F: Array) -> None:
    """F_e = h_e u_e at edges, with h_e the mean of the two cells."""
    for e in numba.prange(u.size):
        F[e] = 0.5 * (h[cells_on_edge[e, 0]] + h[cells_on_edge[e, 1]]) * u[e]


@compiled
def relative_vorticity(
    u: Array, edges_on_vertex: Index, sign: Signs | Array, dc_edge: Array, area_triangle: Array, zeta: Array
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


@inlined
def _tangential_velocity(e: int, u: Array, count: int, edges_on_edge: Index, weights_on_edge: Array) -> float:
    """The velocity along edge e, from those across the `count` edges around its cells."""
    tangential = 0.0
    for j in range(count):
        tangential += weights_on_edge[e, j] * u[edges_on_edge[e, j]]
    return tangential


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
    """Subtract time (u . grad q)_e from q_e at edges: q is anticipated as what the flow brings within `time` s."""
    for e in numba.prange(u.size):
        tangential = _tangential_velocity(e, u, n_edges_on_edge[e], edges_on_edge, weights_on_edge)
        across = (q_cell[cells_on_edge[e, 1]] - q_cell[cells_on_edge[e, 0]]) / dc_edge[e]
        along = (q[vertices_on_edge[e, 1]] - q[vertices_on_edge[e, 0]]) / dv_edge[e]
        q_edge[e] -= time * (u[e] * across + tangential * along)


@compiled
def blend_upwind(
    u: Array,
    q: Array,
    q_cell: Array,
    factor: float,
    cells_on_edge: Index,
    vertices_on_edge: Index,
    n_edges_on_edge: Index,
    edges_on_edge: Index,
    weights_on_edge: Array,
    dc_edge: Array,
    dv_edge: Array,
    q_edge: Array,
) -> None:
    """Add `factor` of the difference between the value upstream and q_e to q_e (`swe.equations.upwinding`)."""
    for e in numba.prange(u.size):
        tangential = _tangential_velocity(e, u, n_edges_on_edge[e], edges_on_edge, weights_on_edge)
        a, b = dv_edge[e] * u[e], dc_edge[e] * tangential
        across = q_cell[cells_on_edge[e, 1]] - q_cell[cells_on_edge[e, 0]]
        along = q[vertices_on_edge[e, 1]] - q[vertices_on_edge[e, 0]]
        q_edge[e] -= 0.5 * factor * (a * across + b * along) / np.sqrt(a * a + b * b + STILL)


@compiled
def move_along(h: Array, u: Array, h_after: Array, u_after: Array, factor: float) -> int:
    """Move h and u by `factor` of the way to `h_after` and `u_after`; return what `count_unsound` would count."""
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
def blend(a: float, x: Array, b: float, y: Array, c: float, z: Array, result: Array) -> None:
    """Result = a x + b y + c z, entry by entry."""
    for i in numba.prange(x.size):
        result[i] = a * x[i] + b * y[i] + c * z[i]


@compiled
def count_unsound(h: Array, u: Array) -> int:
    """Number of non-finite values and non-positive thicknesses."""
    count = 0
    for i in numba.prange(h.size):
        if not (0.0 < h[i] < np.inf):
            count += 1
    for e in numba.prange(u.size):
        if not np.isfinite(u[e]):
            count += 1
    return count

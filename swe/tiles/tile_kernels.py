"""Compiled loops over tiles: one stage of the Runge-Kutta method in one pass over the mesh.

A tile computes the tendency of its own cells and edges from local copies of the state, with local indices, and
repeats the part of its neighbours' work that it needs (`swe.tiles.cutting` says which, and how it is laid out). So q
and the contributions of cells to edges never leave the cache, the tiles of one stage are independent, and results do
not depend on which thread takes which tile.

The equations are those of `swe.equations.tendency`, with three changes of form. Edges carry the circulation U_e = d_e
u_e, with -U_e mirrored `MIRROR` places on, so that an index picks the sign too. The Coriolis flux is summed cell by
cell in its prefix form, O(n) for n sides. Each cell adds its Bernoulli function to its contribution to the edges, since
d_e du_e/dt = (Q + B) of the first cell - (Q + B) of the second.

Indices are unsigned, because signed ones are tested for wrap-around. Slices are taken in functions that the parallel
loop calls, because the compiler learns that arrays do not overlap only if the loop itself makes no views. Numbers of
tiles are signed there, or else all these functions would be compiled twice, as parallel loops count without signs.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.tiles import cell_loop, consistent_loop, vorticity_loop
from swe.tiles.layout import MIRROR, Arrays, TileArrays, compiled, inlined, options, use_widest_vectors


@inlined
def _load_cells(h: Array, first: int, owned: int, halo: Index, local: Array) -> None:
    """Thickness of the tile's own cells and of those in its halo."""
    own = h[first : first + owned]
    for i in range(owned):
        local[i] = own[i]
    for i in range(halo.size):
        local[owned + i] = h[halo[i]]


@inlined
def _load_edges(u: Array, first: int, owned: int, halo: Index, d: Array, U: Array) -> None:
    """U_e = d_e u_e, and -U_e mirrored."""
    own = u[first : first + owned]
    for i in range(owned):
        circulation = d[i] * own[i]
        U[i] = circulation
        U[MIRROR + i] = -circulation
    for i in range(halo.size):
        circulation = d[owned + i] * u[halo[i]]
        U[owned + i] = circulation
        U[MIRROR + owned + i] = -circulation


@inlined
def _potential_vorticity(
    U: Array, h: Array, edges: Index, cells: Index, kites: Array, planetary: Array, q: Array
) -> None:
    """q_v = (A_v f_v + sum_e t_ev U_e) / sum_i kite_vi h_i."""
    n = planetary.size
    for v in range(n):
        circulation = U[edges[v]] + U[edges[n + v]] + U[edges[2 * n + v]]
        volume = kites[v] * h[cells[v]] + kites[n + v] * h[cells[n + v]] + kites[2 * n + v] * h[cells[2 * n + v]]
        q[v] = (planetary[v] + circulation) / volume


@inlined
def _velocity_tendency(S: Array, slots: Index, d: Array, du: Array) -> None:
    """du_e/dt = (S of the first cell - S of the second) / d_e at the tile's own edges."""
    n = du.size
    for e in range(n):
        du[e] = (S[slots[e]] - S[slots[n + e]]) / d[e]


@inlined
def _tendency_of_tile(
    tile: int,
    thread: int,
    tiles: TileArrays,
    scratch: Arrays,
    parts: Arrays | None,
    changed: Arrays | None,
    seconds: float | None,
    factor: float | None,
    gravity: float,
    moving: bool,
    h: Array,
    u: Array,
) -> None:
    """The tendency of the tile's own cells and edges at the state h, u, in the scratch of `thread`."""
    first_cell, first_edge, halo, halo_parts, indices, index_parts, metrics, metric_parts = tiles
    h_rows, U_rows, q_rows, S_rows, dh_rows, du_rows = scratch
    a, b, c = halo_parts[tile], index_parts[tile], metric_parts[tile]  # where the parts begin
    halo_cells, halo_edges = halo[a[0] : a[1]], halo[a[1] : a[2]]
    slots = indices[b[0] : b[1]]
    edges_on_vertex, cells_on_vertex = indices[b[1] : b[2]], indices[b[2] : b[3]]
    edges, across, vertices = indices[b[3] : b[4]], indices[b[4] : b[5]], indices[b[5] : b[6]]
    larger, larger_start, larger_sides = indices[b[6] : b[7]], indices[b[7] : b[8]], indices[b[8] : b[9]]
    d, kites, planetary = metrics[c[0] : c[1]], metrics[c[1] : c[2]], metrics[c[2] : c[3]]
    ratio, P = metrics[c[3] : c[4]], metrics[c[4] : c[5]]
    inverse_area, potential = metrics[c[5] : c[6]], metrics[c[6] : c[7]]
    own_cells, own_edges = first_cell[tile + 1] - first_cell[tile], first_edge[tile + 1] - first_edge[tile]

    local, U, q, S, dh = h_rows[thread], U_rows[thread], q_rows[thread], S_rows[thread], dh_rows[thread]
    du = du_rows[thread, :own_edges]
    _load_cells(h, first_cell[tile], own_cells, halo_cells, local)
    _load_edges(u, first_edge[tile], own_edges, halo_edges, d, U)
    if moving:
        _potential_vorticity(U, local, edges_on_vertex, cells_on_vertex, kites, planetary, q)
    else:
        q[:] = 0.0
    if changed is None:
        values, corners, own_area = q, vertices, inverse_area
        circulation, sides = U, edges
    else:
        n, m = b.size, c.size
        other_across = indices[b[n - 5] : b[n - 4]]
        if parts is None:
            cells, opposite = across, other_across
        else:
            cells, opposite = other_across, across
        values, corners, own_area = changed[0][thread], None, inverse_area[: potential.size]
        circulation, sides = changed[4][thread], None
        vorticity_loop.change_vorticity(
            seconds,
            factor,
            inverse_area.size,
            potential.size,
            larger.size,
            U,
            q,
            edges,
            cells,
            opposite,
            vertices,
            ratio,
            P,
            metrics[c[m - 2] : c[m - 1]],
            indices[b[n - 4] : b[n - 3]],
            indices[b[n - 3] : b[n - 2]],
            indices[b[n - 2] : b[n - 1]],
            (changed[1][thread], changed[2][thread], changed[3][thread]),
            circulation,
            values,
        )
    if parts is None:
        cell_loop.all_cells(
            gravity,
            local,
            circulation,
            values,
            sides,
            across,
            corners,
            ratio,
            P,
            own_area,
            potential,
            larger,
            larger_start,
            larger_sides,
            dh,
            S,
        )
    else:
        K, part = parts[0][thread], parts[1][thread]
        consistent_loop.fluxes(
            local,
            circulation,
            sides,
            ratio,
            inverse_area,
            metrics[c[7] : c[8]],
            indices[b[11] : b[12]],
            indices[b[12] : b[13]],
            indices[b[13] : b[14]],
            K,
            part,
        )
        consistent_loop.all_cells(
            gravity,
            local,
            values,
            across,
            corners,
            P,
            own_area,
            potential,
            larger,
            larger_start,
            larger_sides,
            indices[b[10] : b[11]],
            K,
            part,
            dh,
            S,
        )
    if moving:
        _velocity_tendency(S, slots, d, du)
    else:
        du[:] = 0.0


@inlined
def _add_scaled(first: int, last: int, y: Array, factor: float, slope: Array, result: Array) -> None:
    """Result = y + factor slope on the tile's own entities."""
    start, end = y[first:last], result[first:last]
    for i in range(end.size):
        end[i] = start[i] + factor * slope[i]


@inlined
def _add_weighted_slopes(
    first: int, last: int, y: Array, second: Array, third: Array, fourth: Array, time_step: float, slope: Array
) -> None:
    """Add dt (k_1 + 2 k_2 + 2 k_3 + k_4)/6 to y in place, where dt k_1 = 2 (second - y), ..., dt k_3 = fourth - y.

    The states of the stages thus stand in for their slopes, which need not be kept.
    """
    own, y_2, y_3, y_4 = y[first:last], second[first:last], third[first:last], fourth[first:last]
    for i in range(own.size):
        start = own[i]
        slopes = (y_2[i] - start) + 2.0 * (y_3[i] - start) + (y_4[i] - start)
        own[i] = start + (slopes / 3.0 + time_step / 6.0 * slope[i])


@inlined
def _count_unsound(first: int, last: int, values: Array, least: float) -> int:
    """Number of values that are not finite or not above `least`."""
    own, count = values[first:last], 0
    for i in range(own.size):
        if not ((least < own[i]) & (own[i] < np.inf)):
            count += 1
    return count


@inlined
def _stage_of_tile(
    tile: int,
    thread: int,
    tiles: TileArrays,
    scratch: Arrays,
    parts: Arrays | None,
    changed: Arrays | None,
    seconds: float | None,
    factor: float | None,
    gravity: float,
    moving: bool,
    y: Arrays,
    at: Arrays,
    second: Arrays,
    third: Arrays,
    result: Arrays,
    time_step: float,
    weight: float,
    unsound: Index,
) -> None:
    """Tendency and update of one tile; see `stage`."""
    _tendency_of_tile(tile, thread, tiles, scratch, parts, changed, seconds, factor, gravity, moving, at[0], at[1])
    dh, du = scratch[4][thread], scratch[5][thread]
    cell, next_cell, edge, next_edge = tiles[0][tile], tiles[0][tile + 1], tiles[1][tile], tiles[1][tile + 1]
    if weight == 0.0:
        _add_weighted_slopes(cell, next_cell, y[0], second[0], third[0], at[0], time_step, dh)
        _add_weighted_slopes(edge, next_edge, y[1], second[1], third[1], at[1], time_step, du)
        unsound[tile] = _count_unsound(cell, next_cell, y[0], 0.0) + _count_unsound(edge, next_edge, y[1], -np.inf)
    else:
        _add_scaled(cell, next_cell, y[0], weight * time_step, dh, result[0])
        _add_scaled(edge, next_edge, y[1], weight * time_step, du, result[1])


@compiled
def stage(
    tiles: TileArrays,
    scratch: Arrays,
    parts: Arrays | None,
    changed: Arrays | None,
    seconds: float | None,
    factor: float | None,
    gravity: float,
    moving: bool,
    y: Arrays,
    at: Arrays,
    second: Arrays,
    third: Arrays,
    result: Arrays,
    time_step: float,
    weight: float,
    unsound: Index,
) -> None:
    """One stage of a step from y, with the slope k at the state `at`.

    A stage before the last writes y + weight dt k into `result`; the last one, of weight 0, replaces y by the state
    after the step, leaves `result` alone and counts non-finite values and non-positive thicknesses.
    """
    for tile in numba.prange(unsound.size):
        use_widest_vectors()  # type: ignore[call-arg]
        _stage_of_tile(
            np.int64(tile),
            numba.get_thread_id(),
            tiles,
            scratch,
            parts,
            changed,
            seconds,
            factor,
            gravity,
            moving,
            y,
            at,
            second,
            third,
            result,
            time_step,
            weight,
            unsound,
        )


@numba.njit(cache=True, **options)
def tendency(
    tiles: TileArrays,
    scratch: Arrays,
    parts: Arrays | None,
    changed: Arrays | None,
    seconds: float | None,
    factor: float | None,
    gravity: float,
    moving: bool,
    at: Arrays,
    slope: Arrays,
    unsound: Index,
) -> None:
    """Write the slope at the state `at` into `slope`, zero beforehand, both in the order of the tiles."""
    stage(
        tiles,
        scratch,
        parts,
        changed,
        seconds,
        factor,
        gravity,
        moving,
        slope,
        at,
        slope,
        slope,
        slope,
        1.0,
        1.0,
        unsound,
    )


@numba.njit(cache=True, **options)
def rk4_steps(
    tiles: TileArrays,
    scratch: Arrays,
    parts: Arrays | None,
    changed: Arrays | None,
    seconds: float | None,
    factor: float | None,
    gravity: float,
    moving: bool,
    y: Arrays,
    second: Arrays,
    third: Arrays,
    fourth: Arrays,
    time_step: float,
    count: int,
    unsound: Index,
) -> int:
    """Advance y, a pair of thickness and normal velocity in the order of the tiles, by steps of classical RK4.

    Returns the number of steps taken: `count`, or fewer if a step left non-finite values or non-positive thicknesses,
    counted for each tile in `unsound` (n_tiles,). `second`, `third` and `fourth` are left with the states at which the
    stages after the first took their slopes. If not `moving`, the velocity stays fixed.
    """
    for taken in range(1, count + 1):
        for at, result, weight in ((y, second, 0.5), (second, third, 0.5), (third, fourth, 1.0), (fourth, fourth, 0.0)):
            stage(
                tiles,
                scratch,
                parts,
                changed,
                seconds,
                factor,
                gravity,
                moving,
                y,
                at,
                second,
                third,
                result,
                time_step,
                weight,
                unsound,
            )
        if np.any(unsound > 0):
            return taken
    return count

"""Compiled loops over tiles for the forward-backward method: a stage of velocity and the next one of thickness in one.

Velocity follows thickness within a stage, so a stage taken alone needs two passes over the mesh, or tiles that repeat
the thickness of a wide halo. But once a tile knows the new velocity at all edges of its own cells, the thickness of the
stage after follows from what it has loaded already. A pass therefore ends a stage and begins the next,

    u_b = u + c dt U(u_a, h*),        h_c = h_s + c' dt H(u_b, h_b),

where h_b, the new thickness of the stage, was found in the pass before, and h* is a mean of it and earlier ones. The
velocity at the border of a tile, at edges between its own cells and others, is found on both sides, with the same bits.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.integrators import FB_RK32
from swe.tiles.cell_loop import all_cells
from swe.tiles.layout import LANES, MIRROR, RING, Arrays, TileArrays, compiled, inlined, options
from swe.tiles.tile_kernels import _count_unsound, _load_cells, _load_edges, _potential_vorticity, use_widest_vectors

Weights = tuple[float, float, float]
"""Weights of the newest thickness, of the one before and of that at the start of the step."""


@inlined
def _load_mean_of_cells(heights: Arrays, weights: Weights, first: int, owned: int, halo: Index, local: Array) -> None:
    """The weighted mean of three thicknesses at the tile's own cells and at those in its halo.

    The two stages whose weight of the second vanishes do not read it.
    """
    new, last, start = heights
    a, b, c = weights
    own, own_last, own_start = new[first : first + owned], last[first : first + owned], start[first : first + owned]
    if b == 0.0:
        for i in range(owned):
            local[i] = a * own[i] + c * own_start[i]
        for i in range(halo.size):
            cell = halo[i]
            local[owned + i] = a * new[cell] + c * start[cell]
        return
    for i in range(owned):
        local[i] = a * own[i] + b * own_last[i] + c * own_start[i]
    for i in range(halo.size):
        cell = halo[i]
        local[owned + i] = a * new[cell] + b * last[cell] + c * start[cell]


@inlined
def _move_edges(
    u: Array,
    first: int,
    owned: int,
    halo: Index,
    S: Array,
    slots: Index,
    border: Index,
    d: Array,
    factor: float,
    U: Array,
    result: Array,
) -> None:
    """Result = u + factor du/dt at the tile's own edges, and its circulation there and at the border."""
    own, moved = u[first : first + owned], result[first : first + owned]
    here, there = slots[:owned], slots[owned:]
    for e in range(owned):
        velocity = own[e] + factor * ((S[here[e]] - S[there[e]]) / d[e])
        moved[e] = velocity
        circulation = d[e] * velocity
        U[e] = circulation
        U[MIRROR + e] = -circulation
    n = border.size // 2
    for e in range(n):
        velocity = u[halo[e]] + factor * ((S[border[e]] - S[border[n + e]]) / d[owned + e])
        circulation = d[owned + e] * velocity
        U[owned + e] = circulation
        U[MIRROR + owned + e] = -circulation


@inlined
def _outflow(
    i: int, start: int, stride: int, sides: int, h: Array, U: Array, edges: Index, cells: Index, ratio: Array
) -> float:
    """Twice the sum of the fluxes h_e l_e u_e out of a cell."""
    outflow = 0.0
    for j in range(sides):
        r = start + j * stride
        outflow += (h[i] + h[cells[r]]) * (ratio[r] * U[edges[r]])
    return outflow


@inlined
def _move_cells(
    base: Array,
    first: int,
    owned: int,
    h: Array,
    U: Array,
    edges: Index,
    cells: Index,
    ratio: Array,
    inverse_area: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    factor: float,
    outflow: Array,
    result: Array,
) -> None:
    """Result = base + factor dh/dt at the tile's own cells; the outflow of those with more sides is found again."""
    for block in range((owned + LANES - 1) // LANES):
        for lane in range(LANES):
            i, start = LANES * block + lane, RING * LANES * block + lane
            outflow[i] = _outflow(i, start, LANES, RING, h, U, edges, cells, ratio)
    for k in range(larger.size):
        i = larger[k]
        outflow[i] = _outflow(i, larger_start[k], 1, larger_sides[k], h, U, edges, cells, ratio)
    before, moved = base[first : first + owned], result[first : first + owned]
    for i in range(owned):
        moved[i] = before[i] - factor * (0.5 * outflow[i] * inverse_area[i])


@inlined
def _pass_of_tile(
    tile: int,
    thread: int,
    tiles: TileArrays,
    scratch: Arrays,
    gravity: float,
    accelerates: bool,
    flows: bool,
    counts: bool,
    heights: Arrays,
    weights: Weights,
    velocities: Arrays,
    velocity_factor: float,
    base: Array,
    thickness_factor: float,
    result: Array,
    unsound: Index,
) -> None:
    """Velocity and thickness of one tile; see `one_pass`."""
    first_cell, first_edge, halo, halo_parts, indices, index_parts, metrics, metric_parts = tiles
    h_rows, U_rows, q_rows, S_rows, outflow_rows, _ = scratch
    a, b, c = halo_parts[tile], index_parts[tile], metric_parts[tile]
    halo_cells, halo_edges = halo[a[0] : a[1]], halo[a[1] : a[2]]
    slots = indices[b[0] : b[1]]
    edges_on_vertex, cells_on_vertex = indices[b[1] : b[2]], indices[b[2] : b[3]]
    edges, cells, vertices = indices[b[3] : b[4]], indices[b[4] : b[5]], indices[b[5] : b[6]]
    larger, larger_start, larger_sides = indices[b[6] : b[7]], indices[b[7] : b[8]], indices[b[8] : b[9]]
    border = indices[b[9] : b[10]]
    d, kites, planetary = metrics[c[0] : c[1]], metrics[c[1] : c[2]], metrics[c[2] : c[3]]
    ratio, P = metrics[c[3] : c[4]], metrics[c[4] : c[5]]
    inverse_area, potential = metrics[c[5] : c[6]], metrics[c[6] : c[7]]
    cell, edge = first_cell[tile], first_edge[tile]
    own_cells, own_edges = first_cell[tile + 1] - cell, first_edge[tile + 1] - edge
    local, U, q, S = h_rows[thread], U_rows[thread], q_rows[thread], S_rows[thread]
    start, at, moved = velocities

    _load_edges(at, edge, own_edges, halo_edges, d, U)
    if accelerates:
        _load_mean_of_cells(heights, weights, cell, own_cells, halo_cells, local)
        _potential_vorticity(U, local, edges_on_vertex, cells_on_vertex, kites, planetary, q)
        all_cells(
            gravity,
            local,
            U,
            q,
            edges,
            cells,
            vertices,
            ratio,
            P,
            inverse_area,
            potential,
            larger,
            larger_start,
            larger_sides,
            None,
            S,
        )
        _move_edges(start, edge, own_edges, halo_edges, S, slots, border, d, velocity_factor, U, moved)
    if flows:
        _load_cells(heights[0], cell, own_cells, halo_cells[: inverse_area.size - own_cells], local)
        _move_cells(
            base,
            cell,
            own_cells,
            local,
            U,
            edges,
            cells,
            ratio,
            inverse_area,
            larger,
            larger_start,
            larger_sides,
            thickness_factor,
            outflow_rows[thread],
            result,
        )
    if counts:
        unsound[tile] = _count_unsound(cell, cell + own_cells, heights[0], 0.0) + _count_unsound(
            edge, edge + own_edges, moved, -np.inf
        )


@compiled
def one_pass(
    tiles: TileArrays,
    scratch: Arrays,
    gravity: float,
    accelerates: bool,
    flows: bool,
    counts: bool,
    heights: Arrays,
    weights: Weights,
    velocities: Arrays,
    velocity_factor: float,
    base: Array,
    thickness_factor: float,
    result: Array,
    unsound: Index,
) -> None:
    """End one stage and begin the next.

    With the velocities (u, u_a, u_b) and the thicknesses (h_b, h_a, h), whose mean with these `weights` is h*, it

    - writes u + `velocity_factor` U(u_a, h*) into u_b if it `accelerates`; otherwise u_b is u_a;
    - writes `base` + `thickness_factor` H(u_b, h_b) into `result` if it `flows`;
    - counts what is unsound in h_b and u_b if it `counts`.
    """
    for tile in numba.prange(unsound.size):
        use_widest_vectors()  # type: ignore[call-arg]
        _pass_of_tile(
            np.int64(tile),
            numba.get_thread_id(),
            tiles,
            scratch,
            gravity,
            accelerates,
            flows,
            counts,
            heights,
            weights,
            velocities,
            velocity_factor,
            base,
            thickness_factor,
            result,
            unsound,
        )


@inlined
def _copy(values: Array, result: Array) -> None:
    """Term by term, since an assignment of slices brings its messages along, which compile for seconds."""
    for i in range(values.size):
        result[i] = values[i]


FRACTIONS = tuple(stage.fraction for stage in FB_RK32)
WEIGHTS = tuple((stage.new, stage.last, stage.start) for stage in FB_RK32)


@numba.njit(cache=True, **options)
def forward_backward_steps(
    tiles: TileArrays,
    scratch: Arrays,
    gravity: float,
    moving: bool,
    y: Arrays,
    first: Arrays,
    second: Arrays,
    spare: Array,
    time_step: float,
    count: int,
    unsound: Index,
) -> int:
    """Advance y, a pair of thickness and normal velocity in the order of the tiles, by steps of FB-RK(3,2).

    Returns the number of steps taken: `count`, or fewer if a step left non-finite values or non-positive thicknesses,
    counted for each tile in `unsound` (n_tiles,). `first` and `second` are pairs like y, and `spare` a thickness, for
    the stages. If not `moving`, the velocity stays fixed.

    A pass reads its neighbours' values from arrays that it does not write. So the arrays change roles from step to
    step, and the last state is copied into y.
    """
    h, u = y
    h1, u1 = first
    h2, u2 = second
    following = spare
    if not moving:
        u1 = u2 = u
    yes, no = np.bool_(True), np.bool_(False)  # constants would have `one_pass` compiled for each choice of them
    c1, c2, c3 = FRACTIONS[0] * time_step, FRACTIONS[1] * time_step, FRACTIONS[2] * time_step
    one_pass(tiles, scratch, gravity, no, yes, no, (h, h, h), WEIGHTS[0], (u, u, u), 0.0, h, c1, h1, unsound)
    taken = 0
    while taken < count:
        taken += 1
        more = taken < count
        one_pass(tiles, scratch, gravity, moving, yes, no, (h1, h, h), WEIGHTS[0], (u, u, u1), c1, h, c2, h2, unsound)
        # The thickness after the step takes the place of h1, its velocity that of u1.
        one_pass(tiles, scratch, gravity, moving, yes, no, (h2, h, h), WEIGHTS[1], (u, u1, u2), c2, h, c3, h1, unsound)
        one_pass(
            tiles,
            scratch,
            gravity,
            moving,
            more,
            yes,
            (h1, h2, h),
            WEIGHTS[2],
            (u, u2, u1),
            c3,
            h1,
            c1,
            following,
            unsound,
        )
        h, h1, following = h1, following, h
        u, u1 = u1, u
        if np.any(unsound > 0):
            break
    if taken % 3 != 0:
        _copy(h, y[0])
    if taken % 2 != 0 and moving:
        _copy(u, y[1])
    return taken

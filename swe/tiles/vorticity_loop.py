"""The potential vorticity that the Coriolis flux carries at the sides of cells, if terms change it by its gradient.

Anticipation and upwinding (`swe.equations.anticipation`, `swe.equations.upwinding`) subtract from q_e

    (a delta_n q + b delta_t q) T_e,    T_e = seconds/(l d) + factor/2 / sqrt(a^2 + b^2)

with the flows a = l u_n through the edge and b = d u_t past it, and the differences of q across and along it. A first
loop over the cells of the tile and those around them finds what each has of these; a second one joins both sides. As
the velocity past an edge is a Coriolis flux with q = 1, its parts from both cells are sums as in
`swe.tiles.cell_loop`. With the fractions P_j of the area before each side, the mean of q over the kites of a cell is
that at the last vertex and the sum of P_j times the fall of q along side j.
"""

import numpy as np

from mesh.arrays import Array, Index
from swe.equations.kernels import STILL
from swe.tiles.layout import LANES, RING, Arrays, inlined, rounded_product


@inlined
def _parts_of_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    U: Array,
    q: Array,
    edges: Index,
    vertices: Index,
    ratio: Array,
    P: Array,
    q_cell: Array,
    U_at_sides: Array,
    past: Array,
    along: Array,
    at_sides: Array,
) -> None:
    """Q of cell i; at its sides U, its part of the flow past them, the difference of q along, and 2 q_e."""
    outflow = outflow_P = 0.0
    before = q[vertices[start + (sides - 1) * stride]]
    mean = before
    for j in range(sides):
        r = start + j * stride
        U_at_sides[r] = U[edges[r]]
        flow = ratio[r] * U[edges[r]]
        after = q[vertices[r]]
        along[r] = after - before
        at_sides[r] = before + after
        outflow += flow
        outflow_P += P[r] * flow
        mean -= P[r] * (after - before)
        before = after
    q_cell[i] = mean
    beyond = 0.5 * outflow - outflow_P
    for j in range(sides):
        r = start + j * stride
        flow = ratio[r] * U[edges[r]]
        beyond -= 0.5 * flow
        past[r] = beyond + P[r] * outflow
        beyond -= 0.5 * flow


@inlined
def _anticipated(seconds: float | None, inverse_measure: float) -> float:
    """The part of 2 T_e that is anticipation, if there is any."""
    if seconds is None:
        return 0.0
    return 2.0 * seconds * inverse_measure


@inlined
def _upwind(factor: float | None, a: float, b: float) -> float:
    """The part of 2 T_e that is upwinding, if there is any."""
    if factor is None:
        return 0.0
    return float(factor / np.sqrt(a * a + rounded_product(b, b) + STILL))


@inlined
def _change_at_sides(
    i: int,
    start: int,
    stride: int,
    sides: int,
    seconds: float | None,
    factor: float | None,
    cells: Index,
    opposite: Index,
    ratio: Array,
    inverse_measure: Array,
    q_cell: Array,
    U_at_sides: Array,
    past: Array,
    along: Array,
    at_sides: Array,
) -> None:
    """Change 2 q_e at the sides of cell i, in place."""
    for j in range(sides):
        r = start + j * stride
        a, b = ratio[r] * U_at_sides[r], past[r] - past[opposite[r]]
        fall = a * (q_cell[cells[r]] - q_cell[i]) + rounded_product(b, along[r])
        at_sides[r] -= fall * (_anticipated(seconds, inverse_measure[r]) + _upwind(factor, a, b))


@inlined
def change_vorticity(
    seconds: float | None,
    factor: float | None,
    around: int,
    computed: int,
    computed_larger: int,
    U: Array,
    q: Array,
    edges: Index,
    cells: Index,
    opposite: Index,
    vertices: Index,
    ratio: Array,
    P: Array,
    inverse_measure: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    scratch: Arrays,
    U_at_sides: Array,
    at_sides: Array,
) -> None:
    """Write U and 2 q_e at the sides of the `computed` cells, the first of those `around`, both in whole blocks.

    `computed_larger` of them, the first of the `larger` ones, have more than `RING` sides.
    """
    q_cell, past, along = scratch
    for block in range(around // LANES):
        for lane in range(LANES):
            i, start = LANES * block + lane, RING * LANES * block + lane
            _parts_of_cell(
                i, start, LANES, RING, U, q, edges, vertices, ratio, P, q_cell, U_at_sides, past, along, at_sides
            )
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _parts_of_cell(i, start, 1, sides, U, q, edges, vertices, ratio, P, q_cell, U_at_sides, past, along, at_sides)
    for block in range(computed // LANES):
        for lane in range(LANES):
            i, start = LANES * block + lane, RING * LANES * block + lane
            _change_at_sides(
                i,
                start,
                LANES,
                RING,
                seconds,
                factor,
                cells,
                opposite,
                ratio,
                inverse_measure,
                q_cell,
                U_at_sides,
                past,
                along,
                at_sides,
            )
    for k in range(computed_larger):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _change_at_sides(
            i,
            start,
            1,
            sides,
            seconds,
            factor,
            cells,
            opposite,
            ratio,
            inverse_measure,
            q_cell,
            U_at_sides,
            past,
            along,
            at_sides,
        )

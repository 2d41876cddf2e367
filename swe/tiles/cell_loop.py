"""The loop over the cells of a tile: their tendencies, and what each adds to the acceleration of its edges."""

from mesh.arrays import Array, Index
from swe.tiles.layout import LANES, RING, inlined


@inlined
def at_side(U: Array, edges: Index | None, side: int) -> float:
    """U at the edge of a side; without `edges`, U holds it at the places of the sides."""
    if edges is None:
        return float(U[side])
    return float(U[edges[side]])


@inlined
def first_value(q: Array, vertices: Index | None, last_side: int) -> float:
    """Q at the vertex before the first side of a cell, which is that after the last one, if sides have vertices."""
    if vertices is None:
        return 0.0
    return float(q[vertices[last_side]])


@inlined
def twice_mean(q: Array, vertices: Index | None, side: int, before: float) -> tuple[float, float]:
    """Twice q at a side, and q at the vertex after it; `before` is that at the vertex before it.

    Without `vertices`, q holds the first at the places of the sides.
    """
    if vertices is None:
        return q[side], before
    after = q[vertices[side]]
    return before + after, after


@inlined
def _one_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    gravity: float,
    h: Array,
    U: Array,
    q: Array,
    edges: Index | None,
    cells: Index,
    vertices: Index | None,
    ratio: Array,
    P: Array,
    inverse_area: Array,
    potential: Array,
    dh: Array | None,
    S: Array,
) -> None:
    """dh_i/dt, and for every side j the sum S_j of the Bernoulli function B and of the cell's part of Q.

    With G_j the outflow h_e l_e u_e through side j, q_j the mean of its two vertices and P_j the fraction of the area
    in the kites before side j, counted from the first, let R_j = sum_{k<j} G_k + G_j/2 be the outflow up to the middle
    of the side, and R_j^q the same sum of q_k G_k. Then

        Q_j = 1/2 [q_j (sum_k G_k (1/2 + P_j - P_k) - R_j) + sum_k q_k G_k (1/2 + P_j - P_k) - R_j^q].

    The first round keeps q_j R_j + R_j^q in S, so that the second neither gathers nor sums again. The sums omit the
    factors 1/2 of h_e and q_j, which are applied at the end. Without `dh`, thickness moves in another loop.
    """
    passed = q_passed = half_P = q_half_P = energy = 0.0
    last = first_value(q, vertices, start + (sides - 1) * stride)
    before = last
    for j in range(sides):
        r = start + j * stride
        U_j = at_side(U, edges, r)
        normal = ratio[r] * U_j
        energy += normal * U_j
        half = 0.5 * ((h[i] + h[cells[r]]) * normal)
        q_j, before = twice_mean(q, vertices, r, before)
        q_half = q_j * half
        passed += half
        q_passed += q_half
        S[r] = q_j * passed + q_passed
        passed += half
        q_passed += q_half
        half_P += P[r] * half
        q_half_P += P[r] * q_half
    if dh is not None:
        dh[i] = -0.5 * passed * inverse_area[i]
    rest = 0.5 * passed - 2.0 * half_P
    B = potential[i] + gravity * h[i] + 0.25 * energy * inverse_area[i] + 0.125 * (0.5 * q_passed - 2.0 * q_half_P)
    before = last
    for j in range(sides):
        r = start + j * stride
        q_j, before = twice_mean(q, vertices, r, before)
        S[r] = B + 0.125 * (q_j * (rest + P[r] * passed) + (P[r] * q_passed - S[r]))


@inlined
def all_cells(
    gravity: float,
    h: Array,
    U: Array,
    q: Array,
    edges: Index | None,
    cells: Index,
    vertices: Index | None,
    ratio: Array,
    P: Array,
    inverse_area: Array,
    potential: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    dh: Array | None,
    S: Array,
) -> None:
    """Neighbouring cells in the lanes of a vector, side by side; then the cells with more than `RING` sides."""
    for block in range(inverse_area.size // LANES):
        for lane in range(LANES):
            _one_cell(
                LANES * block + lane,
                RING * LANES * block + lane,
                LANES,
                RING,
                gravity,
                h,
                U,
                q,
                edges,
                cells,
                vertices,
                ratio,
                P,
                inverse_area,
                potential,
                dh,
                S,
            )
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _one_cell(
            i, start, 1, sides, gravity, h, U, q, edges, cells, vertices, ratio, P, inverse_area, potential, dh, S
        )

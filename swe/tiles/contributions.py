"""Contributions of cells to the velocity tendency of their edges alone, where thickness moves in another loop.

The sums of `swe.tiles.cell_loop` in a shorter order: the first round keeps in S what has passed up to the middle of
each side, so that the second neither gathers nor sums again.
"""

from mesh.arrays import Array, Index
from swe.tiles.layout import LANES, RING, inlined


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
    edges: Index,
    cells: Index,
    vertices: Index,
    ratio: Array,
    P: Array,
    inverse_area: Array,
    potential: Array,
    S: Array,
) -> None:
    """For every side j the sum S_j of the Bernoulli function B and of the cell's part of Q.

    With G_j, q_j and P_j as in `cell_loop`, let R_j = sum_{k<j} G_k + G_j/2, and R_j^q the same sum of q_k G_k. Then

        Q_j = 1/2 [q_j (sum_k G_k (1/2 + P_j - P_k) - R_j) + sum_k q_k G_k (1/2 + P_j - P_k) - R_j^q].

    The sums omit the factors 1/2 of h_e and q_j, which are applied at the end.
    """
    passed = q_passed = half_P = q_half_P = energy = 0.0
    before = q[vertices[start + (sides - 1) * stride]]
    for j in range(sides):
        r = start + j * stride
        U_j = U[edges[r]]
        normal = ratio[r] * U_j
        energy += normal * U_j
        half = 0.5 * ((h[i] + h[cells[r]]) * normal)
        after = q[vertices[r]]
        q_j = before + after
        q_half = q_j * half
        before = after
        passed += half
        q_passed += q_half
        S[r] = q_j * passed + q_passed
        passed += half
        q_passed += q_half
        half_P += P[r] * half
        q_half_P += P[r] * q_half
    rest = 0.5 * passed - 2.0 * half_P
    B = potential[i] + gravity * h[i] + 0.25 * energy * inverse_area[i] + 0.125 * (0.5 * q_passed - 2.0 * q_half_P)
    before = q[vertices[start + (sides - 1) * stride]]
    for j in range(sides):
        r = start + j * stride
        after = q[vertices[r]]
        q_j = before + after
        before = after
        S[r] = B + 0.125 * (q_j * (rest + P[r] * passed) + (P[r] * q_passed - S[r]))


@inlined
def contributions(
    gravity: float,
    h: Array,
    U: Array,
    q: Array,
    edges: Index,
    cells: Index,
    vertices: Index,
    ratio: Array,
    P: Array,
    inverse_area: Array,
    potential: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    S: Array,
) -> None:
    """Neighbouring cells in the lanes of a vector, side by side; then the cells with more than `RING` sides."""
    for block in range(inverse_area.size // LANES):
        for lane in range(LANES):
            i, start = LANES * block + lane, RING * LANES * block + lane
            _one_cell(
                i, start, LANES, RING, gravity, h, U, q, edges, cells, vertices, ratio, P, inverse_area, potential, S
            )
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _one_cell(i, start, 1, sides, gravity, h, U, q, edges, cells, vertices, ratio, P, inverse_area, potential, S)

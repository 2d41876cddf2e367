"""The loops over the cells of a tile for the consistent scheme (`swe.equations.consistent`).

The flux through a side has a part from each of its cells. So a first loop finds, for all cells of the tile and those
around them, the velocity v and the vector y, and from these the parts of the flux; the second adds the two parts of
each side, and goes on as the loop of `swe.tiles.cell_loop`.

Sides carry the vector D = d n to the neighbour, and D* = e D turned to the left, to where the middle of the side is
seen: r = D/2 + D*. With the circulation U = d s u, b = 1/(2A) sum (l/d) U D and c = 1/A sum (l/d) U D*,

    v = b + c,    y = c + M v,    M = 1/(2A) sum (l/d) D D,    K = 1/2 v.(y - b) + 1/(4A) sum (l/d) U^2

and the part of the flux through a side, times its length, is h (l/d) [U/2 + D.(y - v)/2 + D*.y].
"""

from mesh.arrays import Array, Index
from swe.tiles.cell_loop import at_side, first_value, twice_mean
from swe.tiles.layout import LANES, RING, inlined


@inlined
def _flux_of_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    vector: int,
    h: Array,
    U: Array,
    edges: Index | None,
    ratio: Array,
    inverse_area: Array,
    vectors: Array,
    K: Array,
    part: Array,
) -> None:
    """K of cell i, and twice its part of the outflow through every side; `vector` is where its first D stands."""
    b_0 = b_1 = c_0 = c_1 = M_00 = M_01 = M_11 = energy = 0.0
    for j in range(sides):
        r, w = start + j * stride, vector + j * stride
        D_0, D_1, turned = vectors[w], vectors[w + sides * stride], vectors[w + 2 * sides * stride]
        normal = ratio[r] * at_side(U, edges, r)
        energy += normal * at_side(U, edges, r)
        b_0 += normal * D_0
        b_1 += normal * D_1
        c_0 -= normal * turned * D_1
        c_1 += normal * turned * D_0
        M_00 += ratio[r] * D_0 * D_0
        M_01 += ratio[r] * D_0 * D_1
        M_11 += ratio[r] * D_1 * D_1
    half = 0.5 * inverse_area[i]
    b_0, b_1, c_0, c_1 = half * b_0, half * b_1, 2.0 * half * c_0, 2.0 * half * c_1
    v_0, v_1 = b_0 + c_0, b_1 + c_1
    y_0 = c_0 + half * (M_00 * v_0 + M_01 * v_1)
    y_1 = c_1 + half * (M_01 * v_0 + M_11 * v_1)
    K[i] = 0.5 * (v_0 * (y_0 - b_0) + v_1 * (y_1 - b_1) + half * energy)
    for j in range(sides):
        r, w = start + j * stride, vector + j * stride
        D_0, D_1, turned = vectors[w], vectors[w + sides * stride], vectors[w + 2 * sides * stride]
        along = D_0 * (y_0 - v_0) + D_1 * (y_1 - v_1)
        across = turned * (D_0 * y_1 - D_1 * y_0)
        part[r] = h[i] * (ratio[r] * (at_side(U, edges, r) + along + 2.0 * across))


@inlined
def fluxes(
    h: Array,
    U: Array,
    edges: Index | None,
    ratio: Array,
    inverse_area: Array,
    vectors: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    K: Array,
    part: Array,
) -> None:
    """Neighbouring cells in the lanes of a vector, side by side; then the cells with more than `RING` sides."""
    for block in range(inverse_area.size // LANES):
        for lane in range(LANES):
            i, start, vector = LANES * block + lane, RING * LANES * block + lane, 3 * RING * LANES * block + lane
            _flux_of_cell(i, start, LANES, RING, vector, h, U, edges, ratio, inverse_area, vectors, K, part)
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _flux_of_cell(i, start, 1, sides, 3 * start, h, U, edges, ratio, inverse_area, vectors, K, part)


@inlined
def _one_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    part_start: int,
    gravity: float,
    h: Array,
    q: Array,
    opposite: Index,
    vertices: Index | None,
    P: Array,
    inverse_area: Array,
    potential: Array,
    K: Array,
    part: Array,
    dh: Array,
    S: Array,
) -> None:
    """dh_i/dt, and S_j as in `swe.tiles.cell_loop`, with twice the outflow G_j from the parts of both cells."""
    passed = q_passed = half_P = q_half_P = 0.0
    last = first_value(q, vertices, start + (sides - 1) * stride)
    before = last
    for j in range(sides):
        r = start + j * stride
        half = 0.5 * (part[part_start + j * stride] - part[opposite[r]])
        q_j, before = twice_mean(q, vertices, r, before)
        q_half = q_j * half
        passed += half
        q_passed += q_half
        S[r] = q_j * passed + q_passed
        passed += half
        q_passed += q_half
        half_P += P[r] * half
        q_half_P += P[r] * q_half
    dh[i] = -0.5 * passed * inverse_area[i]
    rest = 0.5 * passed - 2.0 * half_P
    B = potential[i] + gravity * h[i] + K[i] + 0.125 * (0.5 * q_passed - 2.0 * q_half_P)
    before = last
    for j in range(sides):
        r = start + j * stride
        q_j, before = twice_mean(q, vertices, r, before)
        S[r] = B + 0.125 * (q_j * (rest + P[r] * passed) + (P[r] * q_passed - S[r]))


@inlined
def all_cells(
    gravity: float,
    h: Array,
    q: Array,
    opposite: Index,
    vertices: Index | None,
    P: Array,
    inverse_area: Array,
    potential: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    part_start: Index,
    K: Array,
    part: Array,
    dh: Array,
    S: Array,
) -> None:
    """The cells whose edges the tile needs; the parts of the flux are those of `fluxes`."""
    for block in range(potential.size // LANES):
        for lane in range(LANES):
            i, start = LANES * block + lane, RING * LANES * block + lane
            _one_cell(
                i,
                start,
                LANES,
                RING,
                start,
                gravity,
                h,
                q,
                opposite,
                vertices,
                P,
                inverse_area,
                potential,
                K,
                part,
                dh,
                S,
            )
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _one_cell(
            i,
            start,
            1,
            sides,
            part_start[k],
            gravity,
            h,
            q,
            opposite,
            vertices,
            P,
            inverse_area,
            potential,
            K,
            part,
            dh,
            S,
        )

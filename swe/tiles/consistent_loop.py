"""The loops over the cells of a tile for the consistent scheme (`swe.equations.consistent`).

The flux through a side has a part from each of its cells, so a first loop takes, for all cells of the tile and those
around them, the velocity v and what it leaves over, and from these the part of the flux. The second loop adds the two
parts of each side, and goes on as that of `swe.tiles.cell_loop`.

With the circulation U = d s u, vectors D = d n to the neighbour and r to the middle of the side, b = sum (l/d) U D and
the tensor M = 1/(2A) sum (l/d) D D, which the tile stores,

    v = 1/A sum (l/d) U r,    y = v + M v - b/(2A),    K = 1/2 v.(v + M v) - v.b/(2A) + 1/(4A) sum (l/d) U^2

and the part of the flux is h (l/d) [(U - D.v)/2 + r.y].
"""

from mesh.arrays import Array, Index
from swe.tiles.layout import RING, inlined


@inlined
def _flux_of_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    h: Array,
    U: Array,
    edges: Index,
    ratio: Array,
    inverse_area: Array,
    vectors: Array,
    tensor: Array,
    K: Array,
    part: Array,
) -> None:
    """K of cell i, and twice its part of the outflow through every side."""
    n = ratio.size
    v_0 = v_1 = b_0 = b_1 = energy = 0.0
    for j in range(sides):
        r = start + j * stride
        U_j = U[edges[r]]
        normal = ratio[r] * U_j
        energy += normal * U_j
        b_0 += normal * vectors[r]
        b_1 += normal * vectors[n + r]
        v_0 += normal * vectors[2 * n + r]
        v_1 += normal * vectors[3 * n + r]
    m = inverse_area.size
    v_0 *= inverse_area[i]
    v_1 *= inverse_area[i]
    b_0 *= 0.5 * inverse_area[i]
    b_1 *= 0.5 * inverse_area[i]
    twice_0 = v_0 + (tensor[i] * v_0 + tensor[m + i] * v_1)
    twice_1 = v_1 + (tensor[m + i] * v_0 + tensor[2 * m + i] * v_1)
    y_0, y_1 = 2.0 * (twice_0 - b_0), 2.0 * (twice_1 - b_1)
    K[i] = v_0 * (0.5 * twice_0 - b_0) + v_1 * (0.5 * twice_1 - b_1) + 0.25 * energy * inverse_area[i]
    for j in range(sides):
        r = start + j * stride
        along = vectors[r] * v_0 + vectors[n + r] * v_1
        across = vectors[2 * n + r] * y_0 + vectors[3 * n + r] * y_1
        part[r] = h[i] * (ratio[r] * (U[edges[r]] - along + across))


@inlined
def fluxes(
    h: Array,
    U: Array,
    edges: Index,
    ratio: Array,
    inverse_area: Array,
    vectors: Array,
    tensor: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    K: Array,
    part: Array,
) -> None:
    """Neighbouring cells in the lanes of a vector, side by side; then the cells with more than `RING` sides."""
    n = inverse_area.size
    for i in range(n):
        _flux_of_cell(i, i, n, RING, h, U, edges, ratio, inverse_area, vectors, tensor, K, part)
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _flux_of_cell(i, start, 1, sides, h, U, edges, ratio, inverse_area, vectors, tensor, K, part)


@inlined
def _one_cell(
    i: int,
    start: int,
    stride: int,
    sides: int,
    from_start: int,
    from_stride: int,
    gravity: float,
    h: Array,
    q: Array,
    opposite: Index,
    vertices: Index,
    P: Array,
    inverse_area: Array,
    potential: Array,
    K: Array,
    part: Array,
    dh: Array,
    S: Array,
) -> None:
    """dh_i/dt and S_j as in `swe.tiles.cell_loop`, with twice the outflow G_j from the parts of both cells."""
    outflow = outflow_P = qG = qG_P = 0.0
    last = q[vertices[start + (sides - 1) * stride]]
    before = last
    for j in range(sides):
        r = start + j * stride
        G_j = part[from_start + j * from_stride] - part[opposite[r]]
        after = q[vertices[r]]
        qG_j = (before + after) * G_j
        before = after
        outflow += G_j
        outflow_P += P[r] * G_j
        qG += qG_j
        qG_P += P[r] * qG_j
    dh[i] = -0.5 * outflow * inverse_area[i]
    B = potential[i] + gravity * h[i] + K[i]
    beyond = 0.5 * outflow - outflow_P
    q_beyond = 0.5 * qG - qG_P
    before = last
    for j in range(sides):
        r = start + j * stride
        G_j = part[from_start + j * from_stride] - part[opposite[r]]
        after = q[vertices[r]]
        q_j = before + after
        before = after
        beyond -= 0.5 * G_j
        q_beyond -= 0.5 * (q_j * G_j)
        S[r] = B + 0.125 * (q_j * (beyond + P[r] * outflow) + (q_beyond + P[r] * qG))
        beyond -= 0.5 * G_j
        q_beyond -= 0.5 * (q_j * G_j)


@inlined
def all_cells(
    gravity: float,
    h: Array,
    q: Array,
    opposite: Index,
    vertices: Index,
    P: Array,
    inverse_area: Array,
    potential: Array,
    larger: Index,
    larger_start: Index,
    larger_sides: Index,
    flux_start: Index,
    K: Array,
    part: Array,
    dh: Array,
    S: Array,
) -> None:
    """The cells whose edges the tile needs; the parts of the flux are `fluxes`'."""
    n, m = potential.size, inverse_area.size
    for i in range(n):
        _one_cell(
            i, i, n, RING, i, m, gravity, h, q, opposite, vertices, P, inverse_area, potential, K, part, dh, S
        )
    for k in range(larger.size):
        i, start, sides = larger[k], larger_start[k], larger_sides[k]
        _one_cell(
            i,
            start,
            1,
            sides,
            flux_start[k],
            1,
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

"""Biharmonic dissipation after a step in one pass over tiles: the twin of `swe.equations.dissipation`.

A tile applies the Laplacian twice to local copies. Edges carry the circulation U_e = d_e u_e and the flow W_e = l_e
u_e, with their negatives mirrored `MIRROR` places on. The velocity changes in place, so a first loop puts aside what
tiles read of each other's edges; what they write then depends on neither the order of the tiles nor their threads.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.voronoi_mesh import VoronoiMesh
from swe.damping.cutting import cut_for_dissipation
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.terms import Term
from swe.state import State
from swe.tiles.layout import LANES, MIRROR, RING, Arrays, TileArrays, compiled, inlined, use_widest_vectors


class DissipationOverTiles(Term):
    """What `BiharmonicDissipation.apply` does, to round-off, several times faster."""

    after_steps = True

    def __init__(self, mesh: VoronoiMesh, dissipation: BiharmonicDissipation) -> None:
        self.name, self.meaning, self.changes = dissipation.name, dissipation.meaning, dissipation.changes
        self.coefficient = dissipation.coefficient
        self._tiles = tiles = cut_for_dissipation(mesh, wall_slip=dissipation.wall_slip)
        self._put_aside = np.empty(len(tiles.arrays[2]))
        self._n_edges = mesh.n_edges
        threads = numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
        sizes = (2 * MIRROR, 2 * MIRROR, tiles.cells, tiles.vertices)
        self._scratch = tuple(np.zeros((threads, size)) for size in sizes)

    @property
    def bytes_per_step(self) -> int:
        """Bytes that a step must move: tiles once, what is put aside read, written and read, velocities changed."""
        tiles = sum(array.nbytes for array in self._tiles.arrays)
        return tiles + 3 * self._put_aside.nbytes + 2 * 8 * self._n_edges

    def apply(self, state: State, time_step: float) -> None:
        """See `Term`."""
        factor = -self.coefficient * time_step
        _change(self._tiles.arrays, self._scratch, self._put_aside, factor, state.normal_velocity)


def terms_over_tiles(mesh: VoronoiMesh, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The `terms` of a model on `mesh`, those that have loops over tiles in that form."""
    return tuple(
        DissipationOverTiles(mesh, term) if isinstance(term, BiharmonicDissipation) else term for term in terms
    )


@inlined
def _load(u: Array, edges: Index, first: int, d: Array, l_e: Array, U: Array, W: Array) -> None:
    """Circulation and flow at local edges from `first` on, whose velocities are at `edges` of u."""
    for i in range(edges.size):
        _put(first + i, u[edges[i]], d, l_e, U, W)


@inlined
def _load_put_aside(u: Array, first: int, d: Array, l_e: Array, U: Array, W: Array) -> None:
    """The same of velocities that have been put aside; then an edge with no flow."""
    for i in range(u.size):
        _put(first + i, u[i], d, l_e, U, W)
    U[first + u.size] = W[first + u.size] = 0.0


@inlined
def _put(i: int, u: float, d: Array, l_e: Array, U: Array, W: Array) -> None:
    circulation, flow = d[i] * u, l_e[i] * u
    U[i], U[MIRROR + i] = circulation, -circulation
    W[i], W[MIRROR + i] = flow, -flow


@inlined
def _divergence(
    cells: int,
    larger: int,
    W: Array,
    ring: Index,
    larger_cells: Index,
    larger_start: Index,
    larger_sides: Index,
    inverse_area: Array,
    div: Array,
) -> None:
    """1/A sum W of the first `cells` cells, in whole blocks, and again of the first `larger` ones with more sides."""
    for block in range((cells + LANES - 1) // LANES):
        for lane in range(LANES):
            outflow = 0.0
            for j in range(RING):
                outflow += W[ring[(RING * block + j) * LANES + lane]]
            div[LANES * block + lane] = outflow * inverse_area[LANES * block + lane]
    for k in range(larger):
        outflow = 0.0
        for j in range(larger_sides[k]):
            outflow += W[ring[larger_start[k] + j]]
        div[larger_cells[k]] = outflow * inverse_area[larger_cells[k]]


@inlined
def _vorticity(vertices: int, U: Array, edges: Index, inverse_area: Array, zeta: Array) -> None:
    """1/A sum U at the first `vertices` vertices."""
    n = inverse_area.size
    for v in range(vertices):
        zeta[v] = (U[edges[v]] + U[edges[n + v]] + U[edges[2 * n + v]]) * inverse_area[v]


@inlined
def _first_laplacian(
    div: Array, zeta: Array, cells: Index, vertices: Index, d: Array, l_e: Array, U: Array, W: Array
) -> None:
    """Replace u by lap u at edges that have all their surroundings."""
    n = cells.size // 2
    for e in range(n):
        across = div[cells[n + e]] - div[cells[e]]
        along = zeta[vertices[n + e]] - zeta[vertices[e]]
        _put(e, across / d[e] - along / l_e[e], d, l_e, U, W)


@inlined
def _add_second_laplacian(
    div: Array,
    zeta: Array,
    cells: Index,
    vertices: Index,
    d: Array,
    l_e: Array,
    factor: float,
    own: Index,
    u: Array,
) -> None:
    """Add factor lap(lap u) to u at the tile's own edges."""
    n = cells.size // 2
    for e in range(own.size):
        across = div[cells[n + e]] - div[cells[e]]
        along = zeta[vertices[n + e]] - zeta[vertices[e]]
        u[own[e]] += factor * (across / d[e] - along / l_e[e])


@inlined
def _change_in_tile(
    tile: int, thread: int, tiles: TileArrays, scratch: Arrays, put_aside: Array, factor: float, u: Array
) -> None:
    """Both Laplacians of one tile."""
    own, own_parts, _, halo_parts, indices, index_parts, metrics, metric_parts = tiles
    U, W, div, zeta = scratch[0][thread], scratch[1][thread], scratch[2][thread], scratch[3][thread]
    b, c = index_parts[tile], metric_parts[tile]  # where the parts begin
    counts, ring = indices[b[0] : b[1]], indices[b[4] : b[5]]
    cells, vertices, edges_on_vertex = indices[b[1] : b[2]], indices[b[2] : b[3]], indices[b[3] : b[4]]
    larger, start, sides = indices[b[5] : b[6]], indices[b[6] : b[7]], indices[b[7] : b[8]]
    d, l_e, area, area_vertex = (metrics[c[0] : c[1]], metrics[c[1] : c[2]], metrics[c[2] : c[3]], metrics[c[3] : c[4]])
    mine = own[own_parts[tile, 0] : own_parts[tile, 1]]
    _load(u, mine, 0, d, l_e, U, W)
    _load_put_aside(put_aside[halo_parts[tile, 0] : halo_parts[tile, 1]], mine.size, d, l_e, U, W)
    _divergence(area.size, larger.size, W, ring, larger, start, sides, area, div)
    _vorticity(area_vertex.size, U, edges_on_vertex, area_vertex, zeta)
    _first_laplacian(div, zeta, cells, vertices, d, l_e, U, W)
    _divergence(counts[0], counts[2], W, ring, larger, start, sides, area, div)
    _vorticity(counts[1], U, edges_on_vertex, area_vertex, zeta)
    _add_second_laplacian(div, zeta, cells, vertices, d, l_e, factor, mine, u)


@inlined
def _put_aside_of_tile(tile: int, halo: Index, parts: Index, u: Array, put_aside: Array) -> None:
    """Copy the velocities that a tile reads from others."""
    for k in range(parts[tile, 0], parts[tile, 1]):
        put_aside[k] = u[halo[k]]


@compiled
def _change(tiles: TileArrays, scratch: Arrays, put_aside: Array, factor: float, u: Array) -> None:
    """Add factor lap(lap u) to u at all edges."""
    n_tiles = tiles[1].shape[0]
    for tile in numba.prange(n_tiles):
        _put_aside_of_tile(np.int64(tile), tiles[2], tiles[3], u, put_aside)
    for tile in numba.prange(n_tiles):
        use_widest_vectors()  # type: ignore[call-arg]
        _change_in_tile(np.int64(tile), numba.get_thread_id(), tiles, scratch, put_aside, factor, u)

"""The mesh cut into the tiles of biharmonic dissipation, each with all that lap(lap u) at its edges needs.

A tile owns the edges whose lower cell is in its run of cells. The second Laplacian at these needs the first one at all
sides of the cells at both ends, and that needs the divergence of those cells and their neighbours, the vorticity at all
their vertices, and the velocity around all of these. In local numbers each set comes first in the next larger one, so
the second Laplacian runs over the beginnings of the arrays of the first.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.discrete.walls import closed_mesh, shares_of_circulation, wall_edges
from mesh.triangulation.ordering import inverse_order
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.tiles.layout import MIRROR, RING, TileArrays
from swe.tiles.numbering import LocalNumbers, order_of_cells, packed, tile_bounds
from swe.tiles.rings import in_whole_blocks, ring_array, slots_of_sides

CELLS_PER_TILE = 1280
"""Two copies of the edges with their mirrors, a third of a megabyte, stay in the second-level cache."""


@dataclass(frozen=True, eq=False)
class DissipationTiles:
    """What the loops read, and the largest numbers of cells (in whole blocks) and vertices of any tile.

    `arrays` are the edges that tiles own and those that they read from others, in the numbers of the mesh, then local
    indices and geometry, each followed by where its parts begin (n_tiles, parts + 1); `_Cutter.cut` defines them.
    """

    arrays: TileArrays
    cells: int
    vertices: int

    @property
    def n_tiles(self) -> int:
        """Number of tiles."""
        return len(self.arrays[1])


def cut_for_dissipation(
    mesh: VoronoiMesh, cells_per_tile: int = CELLS_PER_TILE, *, wall_slip: float = 0.0
) -> DissipationTiles:
    """Cut `mesh` (in metres) into tiles of about `cells_per_tile` cells, or fewer if scratch cannot hold them.

    The vorticity at coasts is that of walls with `wall_slip`. Raises `InputError` if not even the surroundings of a
    single cell fit.
    """
    first_cell = tile_bounds(0, mesh.n_cells, cells_per_tile)
    cutter = _Cutter(mesh, wall_slip)
    rank = inverse_order(order_of_cells(cutter.mesh, first_cell))
    lower = rank[cutter.mesh.cells_on_edge].min(axis=1)
    edges = np.argsort(lower, kind="stable")
    own = np.split(edges, np.searchsorted(lower[edges], first_cell[1:-1]))
    pieces = [cutter.cut(edges_of_tile) for edges_of_tile in own]
    most = max(len(piece.own) + len(piece.halo) for piece in pieces)
    if most >= MIRROR:
        if cells_per_tile == 1:
            raise InputError(f"dissipation at a cell needs the {most} edges around it; the limit is {MIRROR - 1}")
        return cut_for_dissipation(mesh, cells_per_tile // 2, wall_slip=wall_slip)
    return DissipationTiles(
        arrays=(
            *packed([[piece.own] for piece in pieces], np.uint32),
            *packed([[piece.halo] for piece in pieces], np.uint32),
            *packed([piece.indices for piece in pieces], np.uint16),
            *packed([piece.metrics for piece in pieces], np.float64),
        ),
        cells=max(len(piece.metrics[2]) for piece in pieces),
        vertices=max(len(piece.metrics[3]) for piece in pieces),
    )


@dataclass(frozen=True, eq=False)
class _Piece:
    """One tile: edges in the numbers of the mesh, and the parts of its arrays in the order of the kernels."""

    own: Index
    halo: Index
    indices: list[Index]
    metrics: list[Array]


class _Cutter:
    """Cuts tiles out of a mesh, one after another."""

    def __init__(self, mesh: VoronoiMesh, wall_slip: float) -> None:
        self.shares = shares_of_circulation(mesh, wall_slip)
        self.on_cell, self.on_vertex = mesh.edge_signs_on_cell, mesh.edge_signs_on_vertex
        self.mesh = closed_mesh(mesh)
        self.vertices_on_edge = self.mesh.vertices_on_edge.copy()
        walls = wall_edges(mesh)  # with one vertex twice, lap u vanishes there
        self.vertices_on_edge[walls, 1] = self.vertices_on_edge[walls, 0]
        self.local_cells, self.local_edges = LocalNumbers(mesh.n_cells), LocalNumbers(mesh.n_edges)
        self.local_vertices = LocalNumbers(mesh.n_vertices)

    def cut(self, own: Index) -> _Piece:
        """The tile that owns these edges, given by their numbers in the mesh."""
        mesh, cells, edges, vertices = self.mesh, self.local_cells, self.local_edges, self.local_vertices
        cells.add(mesh.cells_on_edge[own])
        vertices.add(self.vertices_on_edge[own])
        ends = cells.known()
        second = len(ends), len(vertices.known())
        inside = np.arange(mesh.max_edges) < mesh.n_edges_on_cell[ends, None]
        edges.add(own)
        edges.add(mesh.edges_on_cell[ends][inside])
        inner = edges.known()
        cells.add(mesh.cells_on_edge[inner])
        vertices.add(mesh.vertices_on_edge[inner])
        around, corners = cells.known(), vertices.known()
        sides = mesh.n_edges_on_cell[around]
        edges.add(mesh.edges_on_cell[around][np.arange(mesh.max_edges) < sides[:, None]])
        edges.add(mesh.edges_on_vertex[corners])
        known = edges.known()
        nothing = len(known)  # the place of an edge through and along which nothing flows
        larger = np.flatnonzero(sides > RING)
        piece = _Piece(
            own=own,
            halo=known[len(own) :],
            indices=[
                np.array([*second, np.count_nonzero(larger < second[0])]),
                cells.of(mesh.cells_on_edge[inner]).T,
                vertices.of(self.vertices_on_edge[inner]).T,
                _signed(edges.of(mesh.edges_on_vertex[corners]), self.on_vertex[corners], nothing).T,
                ring_array(
                    _signed(edges.of(mesh.edges_on_cell[around]), self.on_cell[around], nothing), sides, nothing
                ),
                larger,
                slots_of_sides(sides, mesh.max_edges)[larger, 0],
                sides[larger],
            ],
            metrics=[
                mesh.dc_edge[known],
                mesh.dv_edge[known],
                in_whole_blocks(1.0 / mesh.area_cell[around]),
                self.shares[corners] / mesh.area_triangle[corners],
            ],
        )
        for numbers in (cells, edges, vertices):
            numbers.forget()
        return piece


def _signed(numbers: Index, signs: NDArray[np.int8], nothing: int) -> Index:
    """Places of values and, `MIRROR` on, of their negatives, by the signs; `nothing` where these vanish."""
    return np.where(signs == 0, nothing, np.where(signs > 0, numbers, numbers + MIRROR))

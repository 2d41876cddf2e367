"""The part of a mesh that one process holds: the entities it owns, and rings of cells round them that it only reads.

Every cell belongs to a block; an edge or a vertex belongs to the block of the first of its cells that is there. So each
entity of the whole mesh has one owner.
"""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Index
from mesh.errors import MeshError
from mesh.parts.cutting import around, kept_with, reduced
from mesh.parts.mesh_rows import MeshRows, RowsInMemory
from mesh.voronoi_mesh import VoronoiMesh


@dataclass(frozen=True, eq=False)
class MeshPart:
    """A block of cells with some rings of others round it, as a `mesh`; the cells beyond are missing in it.

    `cells`, `edges` and `vertices` are the numbers of its entities in the whole mesh, in ascending order, and
    `..._owner` the blocks to which they belong; those of `block` are its own.
    """

    mesh: VoronoiMesh
    block: int
    cells: Index
    edges: Index
    vertices: Index
    cell_owner: Index
    edge_owner: Index
    vertex_owner: Index

    @property
    def own_cells(self) -> Index:
        """Its own cells, by their numbers in the part."""
        return np.flatnonzero(self.cell_owner == self.block)

    @property
    def own_edges(self) -> Index:
        """Its own edges, by their numbers in the part."""
        return np.flatnonzero(self.edge_owner == self.block)

    @property
    def own_vertices(self) -> Index:
        """Its own vertices, by their numbers in the part."""
        return np.flatnonzero(self.vertex_owner == self.block)

    @property
    def halo_cells(self) -> Index:
        """Cells of other blocks, by their numbers in the part."""
        return np.flatnonzero(self.cell_owner != self.block)

    @property
    def halo_edges(self) -> Index:
        """Edges of other blocks that have a cell on both sides, by their numbers in the part.

        Those at its rim are walls there, at which nothing is computed.
        """
        inside = (self.mesh.cells_on_edge >= 0).all(axis=1)
        return np.flatnonzero((self.edge_owner != self.block) & inside)


def cut_part(mesh: VoronoiMesh, blocks: Index, block: int, rings: int) -> MeshPart:
    """The part of `mesh` that owns `block`, with `rings` rings of cells round it.

    `blocks` (n_cells,) is the block of every cell. Raises `MeshError` if no cell belongs to `block`.
    """
    return part_of_rows(RowsInMemory(mesh), blocks, block, rings)


def part_of_rows(whole: MeshRows, blocks: Index, block: int, rings: int) -> MeshPart:
    """What `cut_part` gives, of a mesh that need not be in memory."""
    if blocks.shape != (whole.n_cells,):
        raise MeshError(f"blocks have shape {blocks.shape}, but the mesh needs ({whole.n_cells},)")
    own = np.flatnonzero(blocks == block)
    if not own.size:
        raise MeshError(f"block {block} has no cells; divide the mesh into fewer blocks")
    kept = kept_with(whole, widened(whole, own, rings))
    return MeshPart(
        mesh=reduced(whole, kept),
        block=block,
        cells=kept.cells,
        edges=kept.edges,
        vertices=kept.vertices,
        cell_owner=blocks[kept.cells],
        edge_owner=_owner(blocks, whole.rows("cells_on_edge", kept.edges)),
        vertex_owner=_owner(blocks, whole.rows("cells_on_vertex", kept.vertices)),
    )


def widened(whole: MeshRows, cells: Index, rings: int) -> Index:
    """The `cells` (n,) and `rings` rings of cells round them, in ascending order."""
    outermost = cells
    for _ in range(rings):
        outermost = np.setdiff1d(around(whole, "cells_on_cell", outermost), cells, assume_unique=True)
        cells = np.union1d(cells, outermost)
    return cells


def _owner(blocks: Index, cells: Index) -> Index:
    """The block of the first of the `cells` (n, k) that is there in each row."""
    first = np.argmax(cells >= 0, axis=1)
    return blocks[cells[np.arange(len(cells)), first]]

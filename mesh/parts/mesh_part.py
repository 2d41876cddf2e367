"""The part of a mesh that one process holds: the entities it owns, and rings of cells round them that it only reads.

Every cell belongs to a block; an edge or a vertex belongs to the block of the first of its cells that is there. So each
entity of the whole mesh has one owner.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.errors import MeshError
from mesh.parts.cutting import beside, kept_with, without_cells
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
    if blocks.shape != (mesh.n_cells,):
        raise MeshError(f"blocks have shape {blocks.shape}, but the mesh needs ({mesh.n_cells},)")
    own = blocks == block
    if not own.any():
        raise MeshError(f"block {block} has no cells; divide the mesh into fewer blocks")
    inside = widened(mesh, own, rings)
    kept = kept_with(mesh, inside)
    return MeshPart(
        mesh=without_cells(mesh, ~inside),
        block=block,
        cells=kept.cells,
        edges=kept.edges,
        vertices=kept.vertices,
        cell_owner=blocks[kept.cells],
        edge_owner=_owner(blocks, mesh.cells_on_edge[kept.edges]),
        vertex_owner=_owner(blocks, mesh.cells_on_vertex[kept.vertices]),
    )


def widened(mesh: VoronoiMesh, cells: NDArray[np.bool_], rings: int) -> NDArray[np.bool_]:
    """The marked `cells` (n_cells,) and `rings` rings of cells round them."""
    for _ in range(rings):
        cells = cells | beside(cells, np.where(mesh.on_ring, mesh.cells_on_cell, -1)).any(axis=1)
    return cells


def _owner(blocks: Index, cells: Index) -> Index:
    """The block of the first of the `cells` (n, k) that is there in each row."""
    first = np.argmax(cells >= 0, axis=1)
    return blocks[cells[np.arange(len(cells)), first]]

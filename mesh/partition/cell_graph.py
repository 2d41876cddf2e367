"""Which cells are neighbours, as a graph in compressed rows, and the pieces into which blocks of cells fall."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from mesh.arrays import Index
from mesh.voronoi_mesh import Topology


@dataclass(frozen=True, eq=False)
class CellGraph:
    """A graph of cells, or of blocks: the neighbours of c are `neighbours[starts[c] : starts[c + 1]]`, ascending.

    `starts` has the shape (n_cells + 1,); `neighbours` holds each pair twice, once in the row of either.
    """

    starts: Index
    neighbours: Index

    @property
    def n_cells(self) -> int:
        """Number of nodes."""
        return len(self.starts) - 1

    @property
    def n_edges(self) -> int:
        """Number of pairs of neighbours."""
        return len(self.neighbours) // 2

    @property
    def owners(self) -> Index:
        """The cell (2 n_edges,) in whose row each entry of `neighbours` stands."""
        return np.repeat(np.arange(self.n_cells, dtype=np.int32), np.diff(self.starts))

    @property
    def edges(self) -> Index:
        """The pairs (n_edges, 2) of neighbours, once each and the lower one first: `cells_on_edge` in another order."""
        owners = self.owners
        once = owners < self.neighbours
        return np.stack([owners[once], self.neighbours[once]], axis=1)

    def rows_of(self, cells: Index) -> tuple[Index, Index]:
        """The numbers (n,) of neighbours of `cells` (n,), and these neighbours one row after another."""
        counts = np.diff(self.starts)[cells]
        first = self.starts[cells] - np.concatenate([[0], np.cumsum(counts)[:-1]])
        return counts, self.neighbours[np.repeat(first, counts) + np.arange(counts.sum())]

    def between(self, blocks: Index) -> NDArray[np.bool_]:
        """Mask (2 n_edges,) of the entries that lie in another block than their owner; `blocks` (n_cells,)."""
        crossing: NDArray[np.bool_] = np.repeat(blocks, np.diff(self.starts)) != blocks[self.neighbours]
        return crossing


def cell_graph(mesh: Topology) -> CellGraph:
    """The graph of the cells of a mesh; walls lead nowhere."""
    return graph_of_rings(mesh.n_edges_on_cell, mesh.cells_on_cell)


def graph_of_rings(n_edges_on_cell: Index, cells_on_cell: Index) -> CellGraph:
    """The graph of `cells_on_cell` (n_cells, max_edges), of which -1 and what is beyond the counts (n_cells,) are none.

    Cells that share several edges, as on narrow periodic meshes, are neighbours once.
    """
    there = (np.arange(cells_on_cell.shape[1]) < n_edges_on_cell[:, None]) & (cells_on_cell >= 0)
    return _in_rows(there.sum(axis=1), cells_on_cell[there])


def graph_of_triangles(n_cells: int, cells_on_vertex: Index) -> CellGraph:
    """The graph of `n_cells` cells of which `cells_on_vertex` (n_vertices, 3), -1 where missing, meet at vertices.

    It is that of the rings, as all cells that meet at a vertex share an edge that ends there.
    """
    ends = np.roll(cells_on_vertex, -1, axis=1).ravel(), cells_on_vertex.ravel()
    there = (ends[0] >= 0) & (ends[1] >= 0) & (ends[0] != ends[1])
    one, other = (end[there] for end in ends)
    half = coo_matrix((np.ones(len(one), dtype=np.int8), (one, other)), shape=(n_cells, n_cells)).tocsr()
    matrix = (half + half.T).tocsr()
    matrix.sort_indices()
    return CellGraph(matrix.indptr, matrix.indices)


def block_graph(graph: CellGraph, blocks: Index, n_blocks: int) -> CellGraph:
    """Which blocks share an edge; `blocks` (n_cells,) holds the block of each cell."""
    crossing = graph.between(blocks)
    own, other = blocks[graph.owners[crossing]], blocks[graph.neighbours[crossing]]
    order = np.argsort(own, kind="stable")
    return _in_rows(np.bincount(own, minlength=n_blocks), other[order])


def part_of(graph: CellGraph, cells: Index) -> CellGraph:
    """The graph of `cells`, numbered anew in the order in which they stand; neighbours outside are left out."""
    numbers = np.full(graph.n_cells, -1, dtype=np.int32)
    numbers[cells] = np.arange(len(cells))
    counts, old = graph.rows_of(cells)
    neighbours = numbers[old]
    kept = neighbours >= 0
    owners = np.repeat(np.arange(len(cells)), counts)[kept]
    return _in_rows(np.bincount(owners, minlength=len(cells)), neighbours[kept])


def pieces(graph: CellGraph, blocks: Index) -> tuple[int, Index]:
    """The number of connected pieces of all blocks, and the piece (n_cells,) of each cell."""
    inside = ~graph.between(blocks)
    counts = np.bincount(graph.owners[inside], minlength=graph.n_cells)
    count, piece = connected_components(_matrix(counts, graph.neighbours[inside]), directed=False)
    return int(count), piece


def _in_rows(counts: Index, neighbours: Index) -> CellGraph:
    """The graph of rows of `counts` neighbours, in any order and repeated."""
    matrix = _matrix(counts, neighbours)
    matrix.sum_duplicates()
    return CellGraph(matrix.indptr, matrix.indices)


def _matrix(counts: Index, neighbours: Index) -> csr_matrix:
    starts = np.concatenate([[0], np.cumsum(counts)])
    return csr_matrix((np.ones(len(neighbours), dtype=np.int8), neighbours, starts), shape=(len(counts), len(counts)))

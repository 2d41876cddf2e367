"""The cells round every block of a partition, ring by ring, found for all blocks at once."""

import numpy as np

from mesh.arrays import Index
from mesh.partition.cell_graph import CellGraph


def halo_rings(graph: CellGraph, blocks: Index, rings: int) -> list[Index]:
    """Ring by ring the cells at a distance of 1, 2, ... edges from each block; `blocks` (n_cells,) is that of each.

    A cell near a block is one number, block * n_cells + cell. Those of a ring are ascending.
    """
    n_cells, blocks = graph.n_cells, blocks.astype(np.int64)
    crossing = graph.between(blocks)
    before = np.zeros(0, dtype=np.int64)
    found = [np.unique(blocks[graph.owners[crossing]] * n_cells + graph.neighbours[crossing])]
    while len(found) < rings:
        outside = _neighbours_of(graph, found[-1])
        outside = outside[blocks[outside % n_cells] != outside // n_cells]
        found.append(np.setdiff1d(outside, np.union1d(before, found[-1]), assume_unique=True))
        before = found[-2]
    return found


def _neighbours_of(graph: CellGraph, pairs: Index) -> Index:
    """Pairs of a block and a neighbour of a cell, for `pairs` of the block and the cell; none twice."""
    block, cell = np.divmod(pairs, graph.n_cells)
    counts, neighbours = graph.rows_of(cell)
    around: Index = np.unique(np.repeat(block, counts) * graph.n_cells + neighbours)
    return around

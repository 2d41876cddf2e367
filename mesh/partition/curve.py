"""Blocks that are runs of cells along the space-filling curve by which meshes are numbered."""

import numpy as np

from mesh.arrays import Array
from mesh.partition.partition import Partition, require_possible_blocks
from mesh.triangulation.ordering import hilbert_order


def partition_along_curve(points: Array, blocks: int) -> Partition:
    """Divide cells with centres `points` (n_cells, 3), unit vectors, into runs of equally many along the curve.

    The sizes of blocks differ by one cell at most. Blocks may be in several pieces: the curve jumps from one face of
    the cube to another, and where cells are large its runs are not always connected. Raises `MeshError` where there
    are fewer than one block or more than cells.
    """
    n_cells = len(points)
    n_blocks = require_possible_blocks(blocks, n_cells)
    block_of_cell = np.empty(n_cells, dtype=np.int32)
    block_of_cell[hilbert_order(points)] = np.arange(n_cells) * n_blocks // n_cells
    return Partition(block_of_cell, n_blocks)

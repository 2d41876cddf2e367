"""Blocks that are runs of cells along a space-filling curve, by which trisk numbers its meshes."""

from collections.abc import Iterable

import numpy as np

from mesh.arrays import Index
from mesh.partition.partition import require_possible_blocks
from mesh.triangulation.ordering import keeps_neighbours


def blocks_along_curve(keys: Index, edges: Iterable[Index], blocks: int) -> Index:
    """The block (n_cells,), int32, of every cell of a mesh cut into runs of equally many along a curve.

    `keys` (n_cells,) are the `hilbert_keys` of its cells, and `edges` gives some rows (n, 2) at a time of its cells on
    edges, negative where none is. The curve is the mesh's own numbering wherever that keeps neighbours together, as
    the loops over a part need only cover one run of numbers then. A mesh that was numbered along the curve before its
    cells moved has a few cells whose numbers are far from their places on it.

    The sizes of blocks differ by one cell at most. Blocks may be in several pieces: the curve jumps from one face of
    the cube to another, and where cells are large its runs are not always connected. Raises `MeshError` where there
    are fewer than one block or more than cells.
    """
    n_cells = len(keys)
    n_blocks = require_possible_blocks(blocks, n_cells)
    by_number = (np.arange(n_cells) * n_blocks // n_cells).astype(np.int32)
    by_key = np.empty_like(by_number)
    by_key[np.argsort(keys, kind="stable")] = by_number
    return by_number if keeps_neighbours(by_number, by_key, edges) else by_key

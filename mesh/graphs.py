"""Connected parts of graphs that are given by pairs of nodes."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mesh.arrays import Index


def connected_parts(size: int, pairs: Index) -> tuple[int, Index]:
    """The number of connected parts of the graph of `pairs` (n, 2) on `size` nodes, and that (size,) of each node."""
    graph = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    count, part = connected_components(graph, directed=False)
    return int(count), part


def count_seas_and_coasts(
    cells: int, cells_on_edge: Index, vertices_on_edge: Index, at_boundary: NDArray[np.bool_]
) -> tuple[int, int]:
    """How many connected seas the cells of a mesh form, and how many closed coasts its walls, edges with one cell.

    `at_boundary` (n_vertices,) marks the vertices at which a cell is missing.
    """
    is_wall = (cells_on_edge < 0).any(axis=1)
    _, coast = connected_parts(len(at_boundary), vertices_on_edge[is_wall])
    return connected_parts(cells, cells_on_edge[~is_wall])[0], len(np.unique(coast[at_boundary]))

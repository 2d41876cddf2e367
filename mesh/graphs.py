"""Connected parts of graphs that are given by pairs of nodes."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mesh.arrays import Index


def connected_parts(size: int, pairs: Index) -> tuple[int, Index]:
    """The number of connected parts of the graph of `pairs` (n, 2) on `size` nodes, and that (size,) of each node."""
    graph = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    count, part = connected_components(graph, directed=False)
    return int(count), part

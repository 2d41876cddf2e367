"""Colours of blocks, such that no two neighbours have the same."""

import heapq

import numpy as np

from mesh.arrays import Index
from mesh.partition.cell_graph import CellGraph


def proper_colours(graph: CellGraph) -> Index:
    """Number (n_cells,) of a colour for each node of a graph; those of neighbours differ.

    Each takes the first colour that is free, in the order in which the last had the fewest neighbours among those not
    yet last: six colours are then enough on a sphere, and five are usual.
    """
    rows = [row.tolist() for row in np.split(graph.neighbours, graph.starts[1:-1])]
    colours = np.full(graph.n_cells, -1, dtype=np.int32)
    for node in reversed(_fewest_first(rows)):
        taken = {int(colours[other]) for other in rows[node]}
        colours[node] = next(colour for colour in range(len(taken) + 1) if colour not in taken)
    return colours


def _fewest_first(rows: list[list[int]]) -> list[int]:
    """Nodes in an order in which each has the fewest neighbours among those that follow."""
    left = [len(row) for row in rows]
    queue = [(count, node) for node, count in enumerate(left)]
    heapq.heapify(queue)
    order: list[int] = []
    done = [False] * len(rows)
    while queue:
        count, node = heapq.heappop(queue)
        if done[node] or count != left[node]:
            continue
        done[node] = True
        order.append(node)
        for other in rows[node]:
            if not done[other]:
                left[other] -= 1
                heapq.heappush(queue, (left[other], other))
    return order

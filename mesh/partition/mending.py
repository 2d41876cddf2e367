"""Blocks that METIS leaves in pieces or empty, mended."""

import heapq

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order

from mesh.arrays import Index
from mesh.partition.cell_graph import CellGraph, pieces


def broken_blocks(graph: CellGraph, blocks: Index, n_blocks: int) -> tuple[int, ...]:
    """The blocks that are in several pieces, or empty; `blocks` (n_cells,) holds the block of each cell."""
    count, piece = pieces(graph, blocks)
    block_of_piece = np.zeros(count, dtype=np.int64)
    block_of_piece[piece] = blocks
    return tuple(np.flatnonzero(np.bincount(block_of_piece, minlength=n_blocks) != 1).tolist())


def mended(graph: CellGraph, blocks: Index, n_blocks: int, weights: Index, most: float) -> Index:
    """Block (n_cells,) of each cell of a connected graph, where each block is connected and none is empty.

    Of a block in pieces the heaviest stays; each other goes to the neighbouring block with which it shares most edges
    among those that stay within the weight `most`, or to the lightest neighbour where there is none. An empty block
    takes half of the heaviest one.
    """
    blocks = blocks.copy()
    while _give_away(graph, blocks, n_blocks, weights, most):
        pass
    _fill_empty(graph, blocks, n_blocks, weights)
    return blocks


def _give_away(graph: CellGraph, blocks: Index, n_blocks: int, weights: Index, most: float) -> bool:
    """Give each piece that touches the main piece of another block to one of those; whether there was any."""
    count, piece = pieces(graph, blocks)
    weight = np.bincount(piece, weights, count)
    stays = _main_pieces(blocks, piece, weight)
    if stays.all():
        return False
    owners = graph.owners
    at_main = ~stays[piece[owners]] & stays[piece[graph.neighbours]]
    strays, takers = piece[owners[at_main]], blocks[graph.neighbours[at_main]]
    load = np.bincount(blocks, weights, n_blocks)
    touching = np.unique(strays)
    for stray in touching[np.argsort(weight[touching], kind="stable")]:
        candidates, shared = np.unique(takers[strays == stray], return_counts=True)
        fits = load[candidates] + weight[stray] <= most
        best = np.argmax(np.where(fits, shared, -1)) if fits.any() else np.argmin(load[candidates])
        cells = piece == stray
        load[blocks[cells][0]] -= weight[stray]
        load[candidates[best]] += weight[stray]
        blocks[cells] = candidates[best]
    return len(touching) > 0


def _main_pieces(blocks: Index, piece: Index, weight: NDArray) -> NDArray[np.bool_]:
    """Mask (n_pieces,) of the heaviest piece of each block."""
    block = np.zeros(len(weight), dtype=np.int64)
    block[piece] = blocks
    order = np.lexsort([-weight, block])
    first = np.diff(block[order], prepend=-1) > 0
    stays = np.zeros(len(weight), dtype=bool)
    stays[order[first]] = True
    return stays


def _fill_empty(graph: CellGraph, blocks: Index, n_blocks: int, weights: Index) -> None:
    """Give each empty block half of the block that is then the heaviest of those with several cells."""
    counts = np.bincount(blocks, minlength=n_blocks)
    empty = np.flatnonzero(counts == 0)
    if len(empty) == 0:
        return
    members = dict(enumerate(np.split(np.argsort(blocks, kind="stable"), np.cumsum(counts)[:-1])))
    queue = [(-int(weights[cells].sum()), block) for block, cells in members.items() if len(cells) > 1]
    heapq.heapify(queue)
    matrix = csr_matrix((np.ones(len(graph.neighbours), dtype=np.int8), graph.neighbours, graph.starts))
    for block in empty.tolist():
        _, heaviest = heapq.heappop(queue)
        cells = members[heaviest]
        half = _half(matrix[cells][:, cells], weights[cells])
        blocks[cells[half]] = block
        for number, part in ((heaviest, cells[~half]), (block, cells[half])):
            members[number] = part
            if len(part) > 1:
                heapq.heappush(queue, (-int(weights[part].sum()), number))


def _half(matrix: csr_matrix, weights: Index) -> NDArray[np.bool_]:
    """About half by weight, as a mask (n_cells,), of a connected graph of two cells or more; both halves are connected.

    That is the branch of a spanning tree that comes closest to half.
    """
    order, parents = breadth_first_order(matrix, 0, directed=False)
    branch = weights.astype(np.float64)
    for cell in order[:0:-1]:
        branch[parents[cell]] += branch[cell]
    top = order[1:][np.argmin(np.abs(branch[order[1:]] - 0.5 * branch[0]))]
    inside = np.zeros(len(weights), dtype=bool)
    inside[top] = True
    for cell in order[1:]:
        inside[cell] |= inside[parents[cell]]
    return inside

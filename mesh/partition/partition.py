"""A mesh divided into blocks of cells: what `partition_mesh` gives."""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array, Index
from mesh.errors import MeshError, require
from mesh.partition.cell_graph import CellGraph, cell_graph, part_of, pieces
from mesh.partition.mending import broken_blocks, mended
from mesh.partition.metis import largest_weight, metis_blocks
from mesh.plain import plain_count
from mesh.shown import Rows, Shown
from mesh.voronoi_mesh import Topology

WHOLE_WEIGHT = 1000
"""METIS takes whole weights; this is that of a mean cell."""


@dataclass(frozen=True, eq=False, repr=False)
class Partition(Shown):
    """The block of each cell, `block_of_cell` (n_cells,) from 0 to `n_blocks` - 1.

    `mended_blocks` are those that METIS left in pieces or empty; they lost their smaller pieces to neighbours, or took
    half of another block.
    """

    block_of_cell: Index
    n_blocks: int
    mended_blocks: tuple[int, ...] = ()

    def _title_and_rows(self) -> tuple[str, Rows]:
        sizes = np.bincount(self.block_of_cell, minlength=self.n_blocks)
        return f"Partition of {len(self.block_of_cell)} cells into {self.n_blocks} blocks", {
            "cells of a block": f"{sizes.min()} to {sizes.max()}, {sizes.mean():.6g} in the mean",
            "mended blocks": f"{len(self.mended_blocks)}",
        }


def partition_mesh(mesh: Topology, blocks: int, weights: Array | Sequence[float] | None = None) -> Partition:
    """Divide the cells of a mesh into `blocks` connected blocks of about equal weight with few edges between them.

    `weights` (n_cells,), positive numbers in any unit, say what each cell costs; by default all cost the same. Blocks
    are connected unless the mesh itself is in pieces. The same mesh, blocks and weights give the same partition.
    Raises `MeshError` where there are fewer than one block or more than cells, where weights are not positive numbers,
    one for each cell, and where pymetis, from the extra `mpi`, is not installed.
    """
    return partition_graph(cell_graph(mesh), blocks, weights)


def partition_graph(graph: CellGraph, blocks: int, weights: Array | Sequence[float] | None = None) -> Partition:
    """Divide the cells of a graph as `partition_mesh` does."""
    n_blocks = require_possible_blocks(blocks, graph.n_cells)
    return _divided(graph, n_blocks, _whole_weights(graph.n_cells, weights))


def require_possible_blocks(blocks: int, n_cells: int) -> int:
    """The number of blocks as a plain number; raises `MeshError` if `n_cells` cannot be divided into so many."""
    n_blocks = plain_count("the number of blocks", blocks)
    if not 1 <= n_blocks <= n_cells:
        raise MeshError(f"{n_cells} cells cannot be divided into {n_blocks} blocks; ask for 1 to {n_cells} blocks")
    return n_blocks


def _divided(graph: CellGraph, n_blocks: int, weights: Index) -> Partition:
    """Divide each island of a graph by itself; those too light for a block of their own join the lightest blocks."""
    count, island = pieces(graph, np.zeros(graph.n_cells, dtype=np.int32))
    if count == 1:
        return _divided_island(graph, n_blocks, weights)
    load = np.bincount(island, weights, count)
    shares = shared_out(n_blocks, load, np.bincount(island))
    blocks = np.empty(graph.n_cells, dtype=np.int32)
    mended_blocks: list[int] = []
    for number, (first, share) in enumerate(zip(np.cumsum(shares) - shares, shares, strict=True)):
        if share:
            cells = np.flatnonzero(island == number)
            part = _divided_island(part_of(graph, cells), int(share), weights[cells])
            blocks[cells] = first + part.block_of_cell
            mended_blocks += [int(first) + block for block in part.mended_blocks]
    has_blocks = shares[island] > 0
    of_blocks = np.bincount(blocks[has_blocks], weights[has_blocks], n_blocks)
    for number in np.argsort(-load, kind="stable"):
        if shares[number] == 0:
            lightest = int(np.argmin(of_blocks))
            of_blocks[lightest] += load[number]
            blocks[island == number] = lightest
    return Partition(blocks, n_blocks, tuple(mended_blocks))


def _divided_island(graph: CellGraph, n_blocks: int, weights: Index) -> Partition:
    """Divide a connected graph into connected blocks."""
    first = metis_blocks(graph, n_blocks, weights)
    block_of_cell = mended(graph, first, n_blocks, weights, largest_weight(n_blocks, weights))
    return Partition(block_of_cell, n_blocks, broken_blocks(graph, first, n_blocks))


def shared_out(n_blocks: int, weights: Array | Index, most: Index) -> Index:
    """How many of `n_blocks` blocks each island gets, in proportion to `weights` (n,) and no more than `most` (n,).

    The next block goes where weight / (2 blocks + 1) is largest, as seats do by the method of Sainte-Lague; an island
    lighter than half a block gets none.
    """
    shares = np.zeros(len(weights), dtype=np.int64)
    queue = [(-weight, number) for number, weight in enumerate(weights.tolist())]
    heapq.heapify(queue)
    for _ in range(n_blocks):
        _, number = heapq.heappop(queue)
        shares[number] += 1
        if shares[number] < most[number]:
            heapq.heappush(queue, (-float(weights[number]) / (2.0 * shares[number] + 1.0), number))
    return shares


def _whole_weights(n_cells: int, weights: Array | Sequence[float] | None) -> Index:
    """Weights (n_cells,) as METIS takes them, in proportion to those given."""
    if weights is None:
        return np.ones(n_cells, dtype=np.int64)
    try:
        values = np.asarray(weights, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise MeshError(f"the weights of the cells are no numbers ({error}); give one positive number a cell") from None
    if values.shape != (n_cells,):
        raise MeshError(f"weights of shape {values.shape} do not fit {n_cells} cells; give one positive number a cell")
    require(np.isfinite(values) & (values > 0.0), "cell", "its weight is not a positive number; give one for each cell")
    return np.maximum(np.rint(values * (WHOLE_WEIGHT / values.mean())), 1.0).astype(np.int64)

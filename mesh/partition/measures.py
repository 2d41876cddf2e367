"""How good a partition is: balance, edges between blocks, neighbours and halos of blocks."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array, Index
from mesh.partition.cell_graph import CellGraph, block_graph
from mesh.partition.halos import halo_rings
from mesh.partition.mending import broken_blocks
from mesh.partition.partition import Partition

HALO_RINGS = 2
"""Rings of cells round a block that one stage of a step reads."""


@dataclass(frozen=True)
class PartitionMeasures:
    """Numbers by which partitions are compared.

    `cells` are the fewest, the mean and the most cells of a block. `balance` is the weight of the heaviest block over
    the mean, which is the share of time that others wait. `edge_cut` counts edges between cells of two blocks, and
    `neighbours` are the mean and the most blocks that share an edge with one. `halos` hold, for one ring of cells round
    a block, for two and so on, the mean and the most cells in all these rings. `broken` are blocks in several pieces,
    or empty.
    """

    cells: tuple[int, float, int]
    balance: float
    edge_cut: int
    neighbours: tuple[float, int]
    halos: tuple[tuple[float, int], ...]
    broken: tuple[int, ...]


def measure_partition(graph: CellGraph, partition: Partition, weights: Array | None = None) -> PartitionMeasures:
    """The measures of a partition of the cells of `graph`, whose `weights` (n_cells,) are equal by default."""
    blocks, n_blocks = partition.block_of_cell, partition.n_blocks
    cells = np.bincount(blocks, minlength=n_blocks)
    load = np.bincount(blocks, weights, n_blocks)
    neighbours = np.diff(block_graph(graph, blocks, n_blocks).starts)
    halos = np.cumsum(halo_sizes(graph, partition, HALO_RINGS), axis=0)
    return PartitionMeasures(
        cells=(int(cells.min()), float(cells.mean()), int(cells.max())),
        balance=float(load.max() / load.mean()),
        edge_cut=int(np.count_nonzero(graph.between(blocks))) // 2,
        neighbours=(float(neighbours.mean()), int(neighbours.max())),
        halos=tuple((float(sizes.mean()), int(sizes.max())) for sizes in halos),
        broken=broken_blocks(graph, blocks, n_blocks),
    )


def halo_sizes(graph: CellGraph, partition: Partition, rings: int) -> Index:
    """Number (rings, n_blocks) of cells in each ring round each block: those at a distance of 1, 2, ... edges."""
    found = halo_rings(graph, partition.block_of_cell, rings)
    return np.array([np.bincount(ring // graph.n_cells, minlength=partition.n_blocks) for ring in found])

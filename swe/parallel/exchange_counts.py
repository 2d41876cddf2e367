"""Sizes of the parts of a mesh and of their exchanges, for all parts at once, without cutting any of them.

They are those of `mesh.parts.mesh_part.cut_part` and `swe.parallel.exchange_plan`, found from the graph of the cells
alone; `tests/swe/parallel/test_exchange_counts.py` holds one against the other.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.partition.cell_graph import CellGraph
from mesh.partition.halos import halo_rings
from mesh.partition.partition import Partition
from swe.parallel.exchange_plan import BYTES

Numbers = Index | Array
"""Whole where they are counted; means and extrapolations of them need not be."""


@dataclass(frozen=True, eq=False)
class ExchangeCounts:
    """For each part (n_parts,): its own cells, those of its halo, and what it sends and receives in an exchange.

    Its tiles also compute the `halo_cells_computed`, those with numbers between its own: none if it is one run of
    cells (`swe.tiles.cutting`). A part sends one message to each of its `neighbours` and receives one from each; values
    are thicknesses of cells and velocities at edges.
    """

    own_cells: Numbers
    halo_cells: Numbers
    halo_cells_computed: Numbers
    neighbours: Numbers
    values_sent: Numbers
    values_received: Numbers

    @property
    def n_parts(self) -> int:
        """Number of parts."""
        return len(self.own_cells)

    @property
    def bytes_sent(self) -> Numbers:
        """Bytes (n_parts,) that each sends in an exchange."""
        return BYTES * self.values_sent


def count_exchanges(graph: CellGraph, cells_on_edge: Index, partition: Partition, rings: int) -> ExchangeCounts:
    """The counts of all parts of a mesh that own the blocks of `partition`, each with `rings` rings of halo.

    `graph` is that of the mesh's cells, and `cells_on_edge` (n_edges, 2) its own, or `graph.edges` for a mesh made from
    triangles alone. The mesh is taken to be numbered so that tiles keep its order.
    """
    n_cells, n_parts = graph.n_cells, partition.n_blocks
    blocks = partition.block_of_cell.astype(np.int64)
    # A cell in the halo of a part is one number, part * n_cells + cell.
    halo = np.sort(np.concatenate(halo_rings(graph, blocks, rings)))
    part, cell = np.divmod(halo, n_cells)
    edges = _edges_in_halo(halo, cells_on_edge, blocks)
    messages, place = np.unique(part * n_parts + blocks[cell], return_inverse=True)
    values = np.bincount(place, 1 + edges).astype(np.int64)
    reader, owner = np.divmod(messages, n_parts)
    return ExchangeCounts(
        own_cells=np.bincount(blocks, minlength=n_parts),
        halo_cells=np.bincount(part, minlength=n_parts),
        halo_cells_computed=np.bincount(part[_between_own(part, cell, cells_on_edge, blocks)], minlength=n_parts),
        neighbours=np.bincount(reader, minlength=n_parts),
        values_sent=np.bincount(owner, values, n_parts).astype(np.int64),
        values_received=np.bincount(reader, values, n_parts).astype(np.int64),
    )


def _between_own(part: Index, cell: Index, cells_on_edge: Index, blocks: Index) -> NDArray[np.bool_]:
    """Which cells (n,) in the halos of parts (n,) have numbers between those where tiles begin and end.

    That is from the first cell that the part owns, or the lower cell of an edge that it owns, to its last one.
    """
    n_cells, n_parts = len(blocks), int(blocks.max()) + 1
    inside = cells_on_edge[(cells_on_edge >= 0).all(axis=1)]
    first, last = np.full(n_parts, n_cells), np.zeros(n_parts, np.int64)
    np.minimum.at(first, blocks, np.arange(n_cells))
    np.minimum.at(first, blocks[inside[:, 0]], inside.min(axis=1))
    np.maximum.at(last, blocks, np.arange(n_cells))
    return (first[part] <= cell) & (cell < last[part])


def _edges_in_halo(halo: Index, cells_on_edge: Index, blocks: Index) -> Index:
    """Number (n,) of edges that a part reads because their first cell is the one of its `halo` (n,).

    Those are the edges with a cell on both sides in the part. An edge has the owner of its first cell, so no part reads
    those that begin at its own cells.
    """
    n_cells = len(blocks)
    inside = cells_on_edge[(cells_on_edge >= 0).all(axis=1)].astype(np.int64)
    first, second = inside[np.argsort(inside[:, 0], kind="stable")].T
    starts = np.searchsorted(first, np.arange(n_cells + 1))
    part, cell = np.divmod(halo, n_cells)
    counts = (starts[1:] - starts[:-1])[cell]
    owner = np.repeat(np.arange(len(halo)), counts)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    other = second[np.repeat(starts[cell], counts) + within]
    wanted = part[owner] * n_cells + other
    place = np.minimum(np.searchsorted(halo, wanted), len(halo) - 1)
    there = (blocks[other] == part[owner]) | (halo[place] == wanted)
    return np.bincount(owner[there], minlength=len(halo))

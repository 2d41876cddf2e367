"""What is counted for all parts at once is what real parts send and receive."""

from dataclasses import replace

import numpy as np
import pytest

from mesh import Partition, VoronoiMesh
from mesh.arrays import Index
from mesh.partition.cell_graph import cell_graph
from mesh.partition.curve import blocks_along_curve
from mesh.parts.mesh_part import MeshPart, cut_part
from mesh.triangulation.ordering import hilbert_keys
from swe.parallel.exchange_counts import ExchangeCounts, count_exchanges
from swe.parallel.exchange_plan import Messages, bytes_of, messages_read
from swe.parallel.processes import Own
from swe.tiles.cutting import build_tiles
from tests.cut_mesh import without_cap


def sectors(mesh: VoronoiMesh, n_blocks: int) -> Index:
    """Blocks of many shapes: sectors of longitude, others in the north than in the south."""
    sector = np.floor(mesh.lon_cell / (2.0 * np.pi) * n_blocks) + 3.0 * (mesh.lat_cell > 0.2)
    return sector.astype(np.int32) % n_blocks


def parts_and_messages(mesh: VoronoiMesh, blocks: Index, rings: int) -> list[tuple[MeshPart, Messages]]:
    parts = [cut_part(mesh, blocks, block, rings) for block in range(int(blocks.max()) + 1)]
    return [(part, messages_read(part)) for part in parts]


def counted(mesh: VoronoiMesh, blocks: Index, rings: int) -> ExchangeCounts:
    return count_exchanges(cell_graph(mesh), mesh.cells_on_edge, Partition(blocks, int(blocks.max()) + 1), rings)


def require_equal(mesh: VoronoiMesh, blocks: Index, rings: int) -> None:
    counts, real = counted(mesh, blocks, rings), parts_and_messages(mesh, blocks, rings)
    sent = np.zeros(len(real), np.int64)
    for _, messages in real:
        for message in messages:
            sent[message.block] += bytes_of((message,))
    assert counts.n_parts == len(real)
    assert counts.own_cells.tolist() == [len(part.own_cells) for part, _ in real]
    assert counts.halo_cells.tolist() == [len(part.halo_cells) for part, _ in real]
    assert counts.neighbours.tolist() == [len(messages) for _, messages in real]
    assert (8 * counts.values_received).tolist() == [bytes_of(messages) for _, messages in real]
    assert counts.bytes_sent.tolist() == sent.tolist()
    assert (counts.bytes_sent > 0).all()


@pytest.mark.parametrize("rings", [1, 2, 3])
def test_counts_are_those_of_real_parts(any_mesh: VoronoiMesh, rings: int) -> None:
    require_equal(any_mesh, sectors(any_mesh, 5), rings)


def test_counts_of_a_mesh_with_walls_and_of_edges_in_any_order(icosahedral_mesh: VoronoiMesh) -> None:
    """A wall is read by nobody; an edge belongs to its first cell, which need not be the lower one."""
    coast = without_cap(icosahedral_mesh)
    assert (coast.cells_on_edge < 0).any()
    require_equal(coast, sectors(coast, 7), 2)
    blocks = sectors(icosahedral_mesh, 7)
    graph, partition = cell_graph(icosahedral_mesh), Partition(blocks, 7)
    usual = count_exchanges(graph, icosahedral_mesh.cells_on_edge, partition, 2)
    np.testing.assert_array_equal(usual.values_sent, count_exchanges(graph, graph.edges, partition, 2).values_sent)
    other_way = count_exchanges(graph, icosahedral_mesh.cells_on_edge[:, ::-1], partition, 2)
    assert (usual.values_sent != other_way.values_sent).any()
    assert usual.values_sent.sum() == usual.values_received.sum()


def test_tiles_compute_as_many_cells_as_counted(larger_mesh: VoronoiMesh) -> None:
    """None of the halo where blocks are runs of numbers; and an edge of a part may begin before its first cell."""
    keys = hilbert_keys(larger_mesh.cell_points)
    runs = blocks_along_curve(keys, (larger_mesh.cells_on_edge,), 5)
    assert computed_halo(larger_mesh, runs) == [0] * 5
    assert min(computed_halo(larger_mesh, sectors(larger_mesh, 5))) > 0
    turned = replace(larger_mesh, cells_on_edge=larger_mesh.cells_on_edge[:, ::-1])
    assert max(computed_halo(turned, runs)) > 0


def computed_halo(mesh: VoronoiMesh, blocks: Index) -> list[int]:
    """What is counted, the same as in tiles of real parts."""
    found = []
    for block in range(5):
        part = cut_part(mesh, blocks, block, 2)
        own = Own(part.own_cells, part.own_edges, part.own_vertices)
        nothing = np.zeros(part.mesh.n_cells), np.zeros(part.mesh.n_vertices)
        tiles = build_tiles(part.mesh, *nothing, 1.0, own=own)
        assert tiles.cell_order is None
        found.append(int(tiles.first_cell[-1] - tiles.first_cell[0]) - len(part.own_cells))
    assert counted(mesh, blocks, 2).halo_cells_computed.tolist() == found
    return found


def test_one_part_exchanges_nothing(small_mesh: VoronoiMesh) -> None:
    counts = counted(small_mesh, np.zeros(small_mesh.n_cells, np.int32), 2)
    assert (counts.own_cells.tolist(), counts.halo_cells.tolist()) == ([small_mesh.n_cells], [0])
    assert counts.halo_cells_computed.tolist() == [0]
    assert (counts.neighbours.tolist(), counts.values_sent.tolist()) == ([0], [0])

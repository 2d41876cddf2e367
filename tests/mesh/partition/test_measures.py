"""Measures of partitions agree with plain loops over sets."""

import numpy as np

from mesh import Partition, VoronoiMesh
from mesh.partition.cell_graph import cell_graph
from mesh.partition.measures import halo_sizes, measure_partition
from tests.cut_mesh import without_cap
from tests.mesh.partition.plain_graph import cells_by_block, plain_halo, plain_neighbours


def some_blocks(mesh: VoronoiMesh, n_blocks: int) -> Partition:
    """Sectors of longitude, those of two hemispheres mixed up."""
    sector = np.floor(mesh.lon_cell / (2.0 * np.pi) * n_blocks) + 3.0 * (mesh.lat_cell > 0.2)
    return Partition(sector.astype(np.int32) % n_blocks, n_blocks)


def test_all_measures(any_mesh: VoronoiMesh) -> None:
    for mesh in (any_mesh, without_cap(any_mesh)):
        partition = some_blocks(mesh, 7)
        neighbours, cells = plain_neighbours(mesh), cells_by_block(partition.block_of_cell, 7)
        around = [plain_halo(neighbours, each, 3) for each in cells]
        measures = measure_partition(cell_graph(mesh), partition)
        sizes = [len(each) for each in cells]
        assert measures.cells == (min(sizes), mesh.n_cells / 7, max(sizes))
        assert measures.balance == max(sizes) / (mesh.n_cells / 7)
        crossing = sum(len(neighbours[cell] - each) for each in cells for cell in each)
        assert measures.edge_cut == crossing // 2
        blocks = [{int(partition.block_of_cell[cell]) for cell in halo[0]} for halo in around]
        assert measures.neighbours == (np.mean([len(each) for each in blocks]), max(len(each) for each in blocks))
        rings = np.array([[len(ring) for ring in halo] for halo in around]).T
        np.testing.assert_array_equal(halo_sizes(cell_graph(mesh), partition, 3), rings)
        within = rings[0], rings[0] + rings[1]
        assert measures.halos == tuple((float(each.mean()), int(each.max())) for each in within)


def test_an_empty_block_is_measured(icosahedral_mesh: VoronoiMesh) -> None:
    blocks = (icosahedral_mesh.lat_cell > 0.0).astype(np.int32)
    measures = measure_partition(cell_graph(icosahedral_mesh), Partition(blocks, 3))
    assert measures.cells[0] == 0
    assert measures.broken == (2,)


def test_one_block_has_no_halo(small_mesh: VoronoiMesh) -> None:
    measures = measure_partition(cell_graph(small_mesh), Partition(np.zeros(162, dtype=np.int32), 1))
    assert measures.halos == ((0.0, 0), (0.0, 0))
    assert (measures.edge_cut, measures.balance, measures.broken) == (0, 1.0, ())

"""Blocks are connected, balanced and have few edges between them, on every kind of mesh, and what is refused."""

import sys

import numpy as np
import pytest

from mesh import MeshError, Partition, VoronoiMesh, partition_mesh, scvt_mesh
from mesh.arrays import Index
from mesh.partition.cell_graph import cell_graph
from mesh.partition.measures import measure_partition
from mesh.partition.partition import shared_out
from tests.conftest import random_mesh
from tests.cut_mesh import without_cap, without_cells
from tests.mesh.partition.plain_graph import cells_by_block, is_connected, plain_neighbours

pytest.importorskip("pymetis", reason="the extra mpi is not installed")


def edge_cut(mesh: VoronoiMesh, blocks: Index) -> int:
    inner = mesh.cells_on_edge[(mesh.cells_on_edge >= 0).all(axis=1)]
    return int(np.count_nonzero(blocks[inner[:, 0]] != blocks[inner[:, 1]]))


def default_edge_cut(mesh: VoronoiMesh, n_blocks: int) -> int:
    """That of METIS's k-way method without any option."""
    import pymetis

    adjacency = [sorted(neighbours) for neighbours in plain_neighbours(mesh)]
    _, blocks = pymetis.part_graph(n_blocks, adjacency, recursive=False)
    return edge_cut(mesh, np.array(blocks))


def require_sound(mesh: VoronoiMesh, partition: Partition, n_blocks: int) -> None:
    blocks = partition.block_of_cell
    assert partition.n_blocks == n_blocks
    assert blocks.shape == (mesh.n_cells,)
    assert blocks.min() >= 0
    neighbours = plain_neighbours(mesh)
    for block, cells in enumerate(cells_by_block(blocks, n_blocks)):
        assert is_connected(neighbours, cells), block


@pytest.mark.parametrize("n_blocks", [1, 2, 7, 40, 150, 300])
@pytest.mark.parametrize("cut", [False, True])
def test_blocks_are_connected_and_even(any_mesh: VoronoiMesh, n_blocks: int, cut: bool) -> None:
    mesh = without_cap(any_mesh) if cut else any_mesh
    n_blocks = min(n_blocks, mesh.n_cells)
    partition = partition_mesh(mesh, n_blocks)
    require_sound(mesh, partition, n_blocks)
    mean = mesh.n_cells / n_blocks
    largest = np.bincount(partition.block_of_cell).max()
    # With few cells a block, those on top of the mean are few too; with a handful, METIS's connected blocks vary.
    assert largest <= max(1.03 * mean, mean + 1.5) if mean > 8.0 else largest <= mean + 3.0


@pytest.mark.parametrize("n_blocks", [641, 642])
def test_as_many_blocks_as_cells(icosahedral_mesh: VoronoiMesh, n_blocks: int) -> None:
    partition = partition_mesh(icosahedral_mesh, n_blocks)
    require_sound(icosahedral_mesh, partition, n_blocks)
    assert np.bincount(partition.block_of_cell).max() == 643 - n_blocks


@pytest.mark.parametrize(("cells", "n_blocks"), [(162, 3), (642, 10), (2562, 40), (2562, 80), (2562, 160)])
def test_few_edges_between_even_blocks(cells: int, n_blocks: int) -> None:
    mesh = scvt_mesh(cells)
    partition = partition_mesh(mesh, n_blocks)
    measures = measure_partition(cell_graph(mesh), partition)
    assert measures.balance <= 1.05 if cells / n_blocks > 30.0 else measures.cells[2] <= cells / n_blocks + 1.5
    assert measures.edge_cut == edge_cut(mesh, partition.block_of_cell) <= 1.03 * default_edge_cut(mesh, n_blocks)
    # Hexagons of hexagons have sqrt(12 cells blocks) edges between them.
    assert measures.edge_cut <= 1.15 * np.sqrt(12.0 * cells * n_blocks)


@pytest.mark.slow
def test_the_blocks_of_the_chapter() -> None:
    """642 blocks of 40962 cells."""
    mesh = scvt_mesh(40962, tolerance=1e-3)
    partition = partition_mesh(mesh, 642)
    require_sound(mesh, partition, 642)
    assert np.bincount(partition.block_of_cell).max() <= 1.05 * 40962 / 642
    assert partition.mended_blocks == ()
    # More passes of refinement make it smaller than the default's.
    assert edge_cut(mesh, partition.block_of_cell) <= 0.98 * default_edge_cut(mesh, 642)


def test_metis_itself_leaves_blocks_connected() -> None:
    """Without being asked it leaves some of these in pieces."""
    mesh = random_mesh(2562, 1)
    assert [partition_mesh(mesh, n_blocks).mended_blocks for n_blocks in (40, 80, 120, 300)] == [()] * 4


def test_the_same_request_gives_the_same_blocks(larger_mesh: VoronoiMesh) -> None:
    one, same = (partition_mesh(larger_mesh, 40).block_of_cell for _ in range(2))
    np.testing.assert_array_equal(one, same)


def test_weights_are_balanced(larger_mesh: VoronoiMesh) -> None:
    """The northern half costs three times as much, in units of which nobody knows anything."""
    weights = np.where(larger_mesh.z_cell > 0.0, 3e-7, 1e-7)
    partition = partition_mesh(larger_mesh, 20, weights)
    require_sound(larger_mesh, partition, 20)
    load = np.bincount(partition.block_of_cell, weights)
    assert load.max() <= 1.04 * load.mean()
    cells = np.bincount(partition.block_of_cell)
    assert cells.max() > 2.5 * cells.min()
    assert measure_partition(cell_graph(larger_mesh), partition, weights).balance == load.max() / load.mean()
    equal = partition_mesh(larger_mesh, 20, np.full(2562, 0.3)).block_of_cell
    np.testing.assert_array_equal(equal, partition_mesh(larger_mesh, 20).block_of_cell)


def test_each_island_is_divided_by_itself(larger_mesh: VoronoiMesh) -> None:
    """A cap, a larger one, and two single cells between them, which join a block each."""
    sea = (larger_mesh.lat_cell > 0.6) | (larger_mesh.lat_cell < -0.2)
    for x in (-1.0, 1.0):
        sea[np.argmin(np.linalg.norm(larger_mesh.cell_points - [x, 0.0, 0.2], axis=1))] = True
    mesh = without_cells(larger_mesh, ~sea)
    partition = partition_mesh(mesh, 30)
    neighbours = plain_neighbours(mesh)
    alone = {cell for cell in range(mesh.n_cells) if not neighbours[cell]}
    assert len(alone) == 2
    for cells in cells_by_block(partition.block_of_cell, 30):
        assert is_connected(neighbours, cells - alone)
    assert np.bincount(partition.block_of_cell).max() <= 1.1 * mesh.n_cells / 30
    broken = measure_partition(cell_graph(mesh), partition).broken
    assert len(broken) == 2
    assert set(broken) == set(partition.block_of_cell[list(alone)].tolist())


def test_islands_share_blocks_by_their_weights() -> None:
    assert shared_out(10, np.array([60.0, 30.0, 10.0]), np.array([60, 30, 10])).tolist() == [6, 3, 1]
    assert shared_out(3, np.array([60.0, 35.0, 5.0]), np.array([60, 35, 5])).tolist() == [2, 1, 0]
    assert shared_out(3, np.array([70.0, 20.0, 10.0]), np.array([70, 20, 10])).tolist() == [2, 1, 0]
    assert shared_out(4, np.array([90.0, 10.0]), np.array([2, 5])).tolist() == [2, 2]


@pytest.mark.parametrize("n_blocks", [0, -3, 163])
def test_numbers_of_blocks_that_are_refused(small_mesh: VoronoiMesh, n_blocks: int) -> None:
    with pytest.raises(MeshError, match=f"162 cells cannot be divided into {n_blocks} blocks; ask for 1 to 162"):
        partition_mesh(small_mesh, n_blocks)


def test_half_a_block_is_refused(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match=r"the number of blocks is 2\.5; it must be a whole number"):
        partition_mesh(small_mesh, 2.5)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        (np.ones(161), r"weights of shape \(161,\) do not fit 162 cells"),
        (np.arange(162.0), r"cell 0 \(counted from 0\): its weight is not a positive number"),
        (np.full(162, np.inf), "cell 0, 1, 2 and 159 more"),
        (["heavy"] * 162, "the weights of the cells are no numbers"),
    ],
)
def test_weights_that_are_refused(small_mesh: VoronoiMesh, weights: np.ndarray, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        partition_mesh(small_mesh, 3, weights)


def test_without_pymetis_one_sentence_says_what_to_install(
    small_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pymetis", None)
    with pytest.raises(MeshError, match=r"by the package pymetis; install it with pip install 'trisk\[mpi\]'$"):
        partition_mesh(small_mesh, 3)


def test_random_meshes_of_many_sizes() -> None:
    for seed in range(6):
        mesh = random_mesh(200 + 37 * seed, seed)
        for n_blocks in (3, 19, 61):
            require_sound(mesh, partition_mesh(mesh, n_blocks), n_blocks)

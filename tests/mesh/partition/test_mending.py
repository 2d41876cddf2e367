"""Blocks that were broken by hand are mended."""

import numpy as np
import pytest

from mesh import VoronoiMesh, partition_mesh
from mesh.arrays import Index
from mesh.partition import partition as module
from mesh.partition.cell_graph import CellGraph, cell_graph
from mesh.partition.mending import broken_blocks, mended
from tests.conftest import random_mesh
from tests.mesh.partition.plain_graph import cells_by_block, is_connected, plain_neighbours

EVEN = 1e9
"""A weight that no block reaches."""


def mended_mesh(mesh: VoronoiMesh, blocks: Index, n_blocks: int, most: float = EVEN) -> Index:
    result = mended(cell_graph(mesh), blocks, n_blocks, np.ones(mesh.n_cells, dtype=np.int64), most)
    neighbours = plain_neighbours(mesh)
    assert all(is_connected(neighbours, cells) for cells in cells_by_block(result, n_blocks))
    assert broken_blocks(cell_graph(mesh), result, n_blocks) == ()
    return result


@pytest.fixture
def belts(icosahedral_mesh: VoronoiMesh) -> Index:
    """Four connected blocks from south to north."""
    return np.digitize(icosahedral_mesh.lat_cell, [-0.6, 0.0, 0.6]).astype(np.int32)


def test_sound_blocks_stay(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    np.testing.assert_array_equal(mended_mesh(icosahedral_mesh, belts, 4), belts)


def test_a_cell_far_away_returns_to_those_round_it(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    pole = np.argmax(icosahedral_mesh.lat_cell)
    broken = belts.copy()
    broken[pole] = 0
    assert broken_blocks(cell_graph(icosahedral_mesh), broken, 4) == (0,)
    np.testing.assert_array_equal(mended_mesh(icosahedral_mesh, broken, 4), belts)


def test_the_smaller_piece_goes_where_it_shares_most_edges(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    """A patch of the southernmost block that lies for the most part in the northernmost, and a little in the next."""
    east = np.cos(icosahedral_mesh.lon_cell) > 0.95
    patch = east & (icosahedral_mesh.lat_cell > 0.5) & (icosahedral_mesh.lat_cell < 1.1)
    broken = np.where(patch, 0, belts).astype(np.int32)
    touched = {other for cell in np.flatnonzero(patch) for other in plain_neighbours(icosahedral_mesh)[cell]}
    assert {int(broken[cell]) for cell in touched} == {0, 2, 3}
    result = mended_mesh(icosahedral_mesh, broken, 4)
    assert np.all(result[patch] == 3)
    np.testing.assert_array_equal(result[~patch], belts[~patch])
    # Where the northernmost block cannot take it, the next does, and the lightest where none can.
    full = float(np.count_nonzero(broken == 3)) + 1.0
    assert full < np.count_nonzero(broken == 2)
    assert np.all(mended_mesh(icosahedral_mesh, broken, 4, most=full)[patch] == 3)
    weights = np.where(broken == 3, 4, 1)
    most = float(weights[broken == 2].sum() + patch.sum())
    assert weights[broken == 3].sum() > most
    given = mended(cell_graph(icosahedral_mesh), broken, 4, weights, most)
    assert np.all(given[patch] == 2)


def test_a_block_takes_no_more_pieces_than_it_may(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    """Of two lone cells of the southernmost block in the northernmost, which may take one, the other goes on."""
    graph = cell_graph(icosahedral_mesh)
    southern = [np.count_nonzero(belts[graph.rows_of(np.array([cell]))[1]] == 2) for cell in range(graph.n_cells)]
    rim = np.flatnonzero((belts == 3) & (np.array(southern) == 2))
    lone = [rim[0], rim[np.argmin(icosahedral_mesh.cell_points[rim] @ icosahedral_mesh.cell_points[rim[0]])]]
    broken = belts.copy()
    broken[lone] = 0
    np.testing.assert_array_equal(mended_mesh(icosahedral_mesh, broken, 4), belts)
    weights = np.where(belts == 3, 2, 1)
    most = float(weights[broken == 3].sum() + 2)
    assert np.bincount(belts, weights)[2] + 2 <= most
    assert sorted(mended(graph, broken, 4, weights, most)[lone].tolist()) == [2, 3]


def test_pieces_within_pieces_are_mended(larger_mesh: VoronoiMesh) -> None:
    """Blocks thrown at random have pieces that touch only other pieces."""
    blocks = np.random.default_rng(3).integers(0, 12, larger_mesh.n_cells).astype(np.int32)
    assert broken_blocks(cell_graph(larger_mesh), blocks, 12) == tuple(range(12))
    mended_mesh(larger_mesh, blocks, 12)


def test_empty_blocks_take_halves(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    """A block may have up to five neighbours within itself, and halves are no smaller than a sixth."""
    assert broken_blocks(cell_graph(icosahedral_mesh), belts, 6) == (4, 5)
    result = mended_mesh(icosahedral_mesh, belts, 6)
    sizes, before = np.bincount(result), np.bincount(belts)
    assert sizes.min() >= before.max() // 6
    assert sizes.max() < before.max()


def test_heavy_blocks_are_halved_first(icosahedral_mesh: VoronoiMesh, belts: Index) -> None:
    weights = np.where(belts == 0, 50, 1)
    result = mended(cell_graph(icosahedral_mesh), belts, 6, weights, EVEN)
    assert np.all(belts[np.isin(result, [4, 5])] == 0)


def test_what_metis_leaves_broken_is_said(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(graph: CellGraph, n_blocks: int, weights: Index) -> Index:
        return (np.arange(graph.n_cells) % 3 * 2).astype(np.int32)

    assert partition_mesh(icosahedral_mesh, 5).mended_blocks == ()
    monkeypatch.setattr(module, "metis_blocks", broken)
    partition = partition_mesh(icosahedral_mesh, 5)
    assert partition.mended_blocks == (0, 1, 2, 3, 4)
    assert broken_blocks(cell_graph(icosahedral_mesh), partition.block_of_cell, 5) == ()


def test_blocks_of_random_meshes_are_mended() -> None:
    for seed in range(5):
        mesh = random_mesh(150, seed)
        mended_mesh(mesh, np.random.default_rng(seed).integers(0, 9, 150).astype(np.int32), 10, most=16.0)

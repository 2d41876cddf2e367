"""Runs of cells along the curve: equal, by the mesh's own numbers if those keep it, refused where too many."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.arrays import Index
from mesh.errors import MeshError
from mesh.partition.curve import blocks_along_curve
from mesh.triangulation.ordering import hilbert_keys, hilbert_order, inverse_order
from tests.cut_mesh import without_cap


def divided(mesh: VoronoiMesh, blocks: int, order: Index) -> Index:
    """Blocks of the cells of `mesh` in another `order`, with its edges in two slabs."""
    rank = np.append(inverse_order(order), -1)  # the last is for cells that are not there
    edges = rank[mesh.cells_on_edge]
    return blocks_along_curve(hilbert_keys(mesh.cell_points[order]), (edges[:100], edges[100:]), blocks)


@pytest.mark.parametrize("blocks", [1, 2, 7, 642])
def test_blocks_are_equal_runs_along_the_curve(icosahedral_mesh: VoronoiMesh, blocks: int) -> None:
    order = np.random.default_rng(0).permutation(642)
    found = divided(icosahedral_mesh, blocks, order)
    assert found.dtype == np.int32
    sizes = np.bincount(found, minlength=blocks)
    assert len(sizes) == blocks
    assert sizes.max() - sizes.min() <= 1
    if blocks < 642:  # else every order parts all neighbours
        assert (np.diff(found[hilbert_order(icosahedral_mesh.cell_points[order])]) >= 0).all()


def test_a_numbering_that_keeps_neighbours_together_is_kept(icosahedral_mesh: VoronoiMesh) -> None:
    """Two cells far from their places on the curve do not matter, nor do walls."""
    for mesh in (icosahedral_mesh, without_cap(icosahedral_mesh)):
        order = hilbert_order(mesh.cell_points)
        order[[10, -10]] = order[[-10, 10]]
        found = divided(mesh, 7, order)
        assert (np.diff(found) >= 0).all()
        assert found.max() == 6


@pytest.mark.parametrize("blocks", [0, 643])
def test_impossible_numbers_are_refused(icosahedral_mesh: VoronoiMesh, blocks: int) -> None:
    with pytest.raises(MeshError, match=f"642 cells cannot be divided into {blocks} blocks; ask for 1 to 642"):
        divided(icosahedral_mesh, blocks, np.arange(642))

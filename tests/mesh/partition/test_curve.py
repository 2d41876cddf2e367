"""Runs of cells along the curve: equal, in the order of the curve, and refused where there are too many."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.errors import MeshError
from mesh.partition.curve import partition_along_curve
from mesh.triangulation.ordering import hilbert_order


@pytest.mark.parametrize("blocks", [1, 2, 7, 642])
def test_blocks_are_equal_runs_along_the_curve(icosahedral_mesh: VoronoiMesh, blocks: int) -> None:
    points = icosahedral_mesh.cell_points[np.random.default_rng(0).permutation(642)]
    partition = partition_along_curve(points, blocks)
    sizes = np.bincount(partition.block_of_cell, minlength=blocks)
    assert partition.n_blocks == len(sizes) == blocks
    assert sizes.max() - sizes.min() <= 1
    along = partition.block_of_cell[hilbert_order(points)]
    assert (np.diff(along) >= 0).all()


@pytest.mark.parametrize("blocks", [0, 643])
def test_impossible_numbers_are_refused(icosahedral_mesh: VoronoiMesh, blocks: int) -> None:
    with pytest.raises(MeshError, match=f"642 cells cannot be divided into {blocks} blocks; ask for 1 to 642"):
        partition_along_curve(icosahedral_mesh.cell_points, blocks)

"""No two neighbours of one colour, and few colours."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.partition.cell_graph import CellGraph, block_graph, cell_graph, graph_of_rings
from mesh.partition.colouring import proper_colours


def require_proper(graph: CellGraph, most: int) -> None:
    colours = proper_colours(graph)
    assert np.all(colours[graph.owners] != colours[graph.neighbours])
    assert colours.min() == 0
    assert len(np.unique(colours)) == colours.max() + 1 <= most


def test_cells_of_any_mesh(any_mesh: VoronoiMesh) -> None:
    """Cells are blocks too; on a sphere six colours are enough."""
    require_proper(cell_graph(any_mesh), 6)


@pytest.mark.parametrize("n_blocks", [2, 10, 40])
def test_blocks(larger_mesh: VoronoiMesh, n_blocks: int) -> None:
    points = larger_mesh.cell_points
    centres = np.random.default_rng(n_blocks).normal(size=(n_blocks, 3))
    blocks = np.argmax(points @ (centres / np.linalg.norm(centres, axis=1)[:, None]).T, axis=1)
    require_proper(block_graph(cell_graph(larger_mesh), blocks, n_blocks), 6)


def test_four_that_all_touch_have_four_colours() -> None:
    graph = graph_of_rings(
        np.full(4, 3), np.array([[other for other in range(4) if other != node] for node in range(4)])
    )
    assert sorted(proper_colours(graph).tolist()) == [0, 1, 2, 3]


def test_ends_of_a_chain_come_first() -> None:
    """0, 2, 3, 1 in a row: in the order of their numbers a third colour would be needed."""
    graph = graph_of_rings(np.array([1, 1, 2, 2]), np.array([[2, -1], [3, -1], [0, 3], [2, 1]]))
    assert proper_colours(graph).max() == 1

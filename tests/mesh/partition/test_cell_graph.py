"""The graph of cells is that of the edges, however it is built, and its parts and pieces are right."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.partition.cell_graph import (
    CellGraph,
    block_graph,
    cell_graph,
    graph_of_rings,
    graph_of_triangles,
    part_of,
    pieces,
)
from tests.cut_mesh import without_cap, without_cells
from tests.mesh.partition.plain_graph import plain_neighbours


@pytest.fixture(params=["whole", "part"])
def mesh(any_mesh: VoronoiMesh, request: pytest.FixtureRequest) -> VoronoiMesh:
    return any_mesh if request.param == "whole" else without_cap(any_mesh)


def rows(graph: CellGraph) -> list[list[int]]:
    return [row.tolist() for row in np.split(graph.neighbours, graph.starts[1:-1])]


def test_neighbours_are_those_across_edges(mesh: VoronoiMesh) -> None:
    expected = [sorted(neighbours) for neighbours in plain_neighbours(mesh)]
    graph = cell_graph(mesh)
    assert rows(graph) == expected
    assert graph.n_edges == sum(map(len, expected)) // 2 == np.count_nonzero((mesh.cells_on_edge >= 0).all(axis=1))
    assert graph.n_cells == mesh.n_cells
    assert graph.owners.tolist() == [cell for cell, row in enumerate(expected) for _ in row]


def test_triangles_give_the_same_graph(mesh: VoronoiMesh) -> None:
    graph, same = cell_graph(mesh), graph_of_triangles(mesh.n_cells, mesh.cells_on_vertex)
    np.testing.assert_array_equal(same.starts, graph.starts)
    np.testing.assert_array_equal(same.neighbours, graph.neighbours)


def test_cells_that_share_two_edges_are_neighbours_once() -> None:
    graph = graph_of_rings(np.array([3, 3, 2]), np.array([[1, 2, 1, 2], [0, 2, 0, 0], [0, 1, 0, 0]]))
    assert rows(graph) == [[1, 2], [0, 2], [0, 1]]
    assert graph.n_edges == 3


def test_a_cell_alone_has_an_empty_row() -> None:
    graph = graph_of_rings(np.array([2, 0, 2]), np.array([[2, -1], [0, 0], [0, -1]]))
    assert rows(graph) == [[2], [], [0]]


def test_a_part_has_its_own_neighbours(icosahedral_mesh: VoronoiMesh) -> None:
    cells = np.random.default_rng(0).permutation(icosahedral_mesh.n_cells)[:300]
    number = {int(cell): place for place, cell in enumerate(cells)}
    whole = plain_neighbours(icosahedral_mesh)
    expected = [sorted(number[other] for other in whole[cell] if other in number) for cell in cells.tolist()]
    assert rows(part_of(cell_graph(icosahedral_mesh), cells)) == expected


def test_pieces_of_stripes(icosahedral_mesh: VoronoiMesh) -> None:
    """Two blocks in five belts: north, tropics and south of the one, and what is between of the other."""
    belt = np.digitize(icosahedral_mesh.lat_cell, [-0.9, -0.3, 0.3, 0.9])
    count, piece = pieces(cell_graph(icosahedral_mesh), belt % 2)
    assert count == 5
    assert len({*zip(belt.tolist(), piece.tolist(), strict=True)}) == 5
    neighbours = block_graph(cell_graph(icosahedral_mesh), belt, 5)
    assert rows(neighbours) == [[1], [0, 2], [1, 3], [2, 4], [3]]


def test_islands_are_pieces(icosahedral_mesh: VoronoiMesh) -> None:
    islands = without_cells(icosahedral_mesh, np.abs(icosahedral_mesh.lat_cell) < 0.2)
    count, piece = pieces(cell_graph(islands), np.zeros(islands.n_cells, dtype=int))
    assert count == 2
    assert np.all((piece == piece[0]) == (np.sign(islands.lat_cell) == np.sign(islands.lat_cell[0])))

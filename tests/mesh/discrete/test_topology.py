import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh
from mesh.discrete.topology import _find_half_edges, build_topology
from mesh.generation.generators import icosahedral_points, icosahedron
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins
from mesh.voronoi_mesh import TOPOLOGY_NAMES


def test_euler_formula(any_mesh: VoronoiMesh) -> None:
    assert any_mesh.n_cells - any_mesh.n_edges + any_mesh.n_vertices == 2


def test_icosahedron_has_twelve_pentagons() -> None:
    topology = build_topology(delaunay(icosahedron()), 12)
    assert topology.n_edges_on_cell.tolist() == [5] * 12
    assert topology.max_edges == 5


def test_result_depends_on_the_triangulation_alone() -> None:
    triangles = delaunay(icosahedral_points(2))
    shuffled = np.random.default_rng(0).permutation(triangles)
    turned = np.roll(shuffled, 1, axis=1)
    first, second = build_topology(triangles, 162), build_topology(turned, 162)
    for name in TOPOLOGY_NAMES:
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_edges_and_vertices_are_numbered_after_their_cells(icosahedral_mesh: VoronoiMesh) -> None:
    assert np.all(np.diff(icosahedral_mesh.cells_on_edge[:, 0]) >= 0)
    assert np.all(np.diff(icosahedral_mesh.cells_on_vertex[:, 0]) >= 0)


def test_wrong_numbers_are_refused() -> None:
    triangles = delaunay(icosahedron())
    with pytest.raises(MeshError, match="13 cells need 22 triangles"):
        build_topology(triangles, 13)


def test_triangles_of_other_generators_are_refused() -> None:
    triangles = delaunay(icosahedron())
    for corner in (-1, 12):
        wrong = triangles.copy()
        wrong[3, 1] = corner
        with pytest.raises(MeshError, match=f"corner {corner}, but the generators are numbered 0 to 11"):
            build_topology(wrong, 12)


def test_a_generator_twice_in_a_triangle_is_refused() -> None:
    twice = np.array([(0, 1, 2), (0, 2, 1), (3, 3, 3), (3, 3, 3)])
    with pytest.raises(MeshError, match=r"two of its corners|close the sphere|more than two"):
        build_topology(twice, 4)


def test_numbers_of_edges_need_64_bits() -> None:
    """Half-edges are found by the product of two numbers of cells, here of some 3e6."""
    triangles = delaunay(icosahedron())
    topology = build_topology(triangles, 12)
    spread = 300_000 * topology.cells_on_vertex
    twins = build_twins(topology.cells_on_vertex, 12).ravel()
    for wanted in (topology.cells_on_edge, topology.cells_on_edge[:, ::-1]):
        found = _find_half_edges(spread, twins, 300_000 * wanted.astype(np.int32))
        start = np.roll(spread, -1, axis=1).ravel()
        np.testing.assert_array_equal(np.stack([start[found], start[twins[found]]], axis=1), 300_000 * wanted)

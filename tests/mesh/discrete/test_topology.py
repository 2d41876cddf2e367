import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh
from mesh.discrete.topology import build_topology
from mesh.generation.generators import icosahedral_points, icosahedron
from mesh.triangulation.delaunay import delaunay
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

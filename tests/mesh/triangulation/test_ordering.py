import numpy as np

from mesh import scvt_mesh
from mesh.generation.generators import icosahedral_mesh
from mesh.triangulation.ordering import hilbert_order, renumber, sort_triangles


def test_order_is_a_permutation_and_neighbours_lie_close() -> None:
    points, triangles = icosahedral_mesh(5)
    order = hilbert_order(points)
    np.testing.assert_array_equal(np.sort(order), np.arange(len(points)))
    _, renumbered = renumber(points, triangles)
    distances = [np.median(np.ptp(numbered, axis=1)) for numbered in (triangles, renumbered)]
    assert distances[1] < 20 < 100 < distances[0]


def test_renumbering_keeps_the_triangles() -> None:
    points, triangles = icosahedral_mesh(2)
    new_points, new_triangles = renumber(points, triangles)
    before, after = (np.sort(p[t].sum(axis=1), axis=0) for p, t in ((points, triangles), (new_points, new_triangles)))
    np.testing.assert_allclose(after, before, atol=1e-14)
    np.testing.assert_array_equal(sort_triangles(new_triangles), new_triangles)


def test_cells_edges_and_vertices_of_meshes_lie_close_in_memory() -> None:
    mesh = scvt_mesh(2562, tolerance=1e-4)
    assert np.median(np.abs(np.diff(mesh.cells_on_edge, axis=1))) < 20
    assert np.median(np.ptp(mesh.edges_on_cell[:, :5], axis=1)) < 100
    assert np.median(np.ptp(mesh.vertices_on_cell[:, :5], axis=1)) < 60

import numpy as np

from mesh import VoronoiMesh
from mesh.geometry.sphere import arc_length, dot, triangle_area


def test_areas_sum_to_the_sphere(any_mesh: VoronoiMesh) -> None:
    np.testing.assert_allclose(any_mesh.area_cell.sum(), 4 * np.pi, rtol=1e-14)
    np.testing.assert_allclose(any_mesh.area_triangle.sum(), 4 * np.pi, rtol=1e-14)


def test_cell_areas_are_those_of_their_polygons(any_mesh: VoronoiMesh) -> None:
    for cell in range(0, any_mesh.n_cells, 7):
        ring = any_mesh.vertices_on_cell[cell, : any_mesh.n_edges_on_cell[cell]]
        corners = any_mesh.vertex_points[ring]
        center = np.broadcast_to(any_mesh.cell_points[cell], corners.shape)
        area = triangle_area(center, corners, np.roll(corners, -1, axis=0)).sum()
        np.testing.assert_allclose(any_mesh.area_cell[cell], area, rtol=1e-9)


def test_triangle_areas_are_those_of_their_corners(any_mesh: VoronoiMesh) -> None:
    a, b, c = (any_mesh.cell_points[any_mesh.cells_on_vertex[:, k]] for k in range(3))
    np.testing.assert_allclose(any_mesh.area_triangle, triangle_area(a, b, c), rtol=1e-8)


def test_normals_and_tangents_have_their_directions(any_mesh: VoronoiMesh) -> None:
    centers = any_mesh.cell_points[any_mesh.cells_on_edge]
    normal = centers[:, 1] - centers[:, 0]
    ends = any_mesh.vertex_points[any_mesh.vertices_on_edge]
    along = dot(ends[:, 1] - ends[:, 0], np.cross(any_mesh.edge_points, normal))
    assert np.all(along >= -1e-12)
    moving = any_mesh.dv_edge > 1e-6
    assert np.all(along[moving] > 0)


def test_edge_angle_counts_from_east(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    centers = mesh.cells_on_edge
    away = np.abs(mesh.lat_edge) < 1.2
    east = (mesh.lon_cell[centers[:, 1]] - mesh.lon_cell[centers[:, 0]] + np.pi) % (2 * np.pi) - np.pi
    north = mesh.lat_cell[centers[:, 1]] - mesh.lat_cell[centers[:, 0]]
    expected = np.arctan2(north, east * np.cos(mesh.lat_edge))
    difference = (mesh.angle_edge - expected + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(difference[away]).max() < 0.02


def test_distances_are_arcs(any_mesh: VoronoiMesh) -> None:
    centers = any_mesh.cell_points[any_mesh.cells_on_edge]
    np.testing.assert_allclose(any_mesh.dc_edge, arc_length(centers[:, 0], centers[:, 1]), rtol=1e-14)


def test_scaling_keeps_shapes(icosahedral_mesh: VoronoiMesh) -> None:
    earth = icosahedral_mesh.scaled(6371220.0)
    np.testing.assert_allclose(earth.area_cell.sum(), 4 * np.pi * 6371220.0**2, rtol=1e-14)
    np.testing.assert_allclose(earth.dc_edge, 6371220.0 * icosahedral_mesh.dc_edge)
    np.testing.assert_array_equal(earth.weights_on_edge, icosahedral_mesh.weights_on_edge)
    np.testing.assert_array_equal(earth.lat_cell, icosahedral_mesh.lat_cell)

"""Runs on planes in other formats: polygons are whole across the seams, coordinates are lengths."""

from pathlib import Path

import netCDF4
import numpy as np

from mesh import VoronoiMesh
from mesh.arrays import Array
from postprocess.convert.conversion import convert_run
from postprocess.convert.vtk_series import cell_grid, edge_grid
from postprocess.runs.reading import read_run


def areas(x: Array, y: Array) -> Array:
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)


def test_polygons_of_vtk_are_whole(any_plane: VoronoiMesh) -> None:
    grid, sources = cell_grid(any_plane)
    parts = np.split(grid.points[grid.connectivity], grid.ends[:-1])
    found = np.array([areas(part[None, :, 0], part[None, :, 1])[0] for part in parts])
    np.testing.assert_allclose(found, any_plane.area_cell, rtol=1e-9)
    np.testing.assert_array_equal(sources[grid.connectivity], any_plane.vertices_on_cell[any_plane.on_ring])
    assert len(np.unique(grid.points.round(3), axis=0)) == len(grid.points)
    assert (len(grid.points) > any_plane.n_vertices) == (any_plane.x_period > 0.0)


def test_lines_of_vtk_are_as_long_as_edges(any_plane: VoronoiMesh) -> None:
    grid, _ = edge_grid(any_plane)
    tail, head = grid.points[grid.connectivity].reshape(-1, 2, 3).transpose(1, 0, 2)
    np.testing.assert_allclose(np.linalg.norm(head - tail, axis=1), any_plane.dv_edge, rtol=1e-9)


def test_values_stand_at_images_too(plane_run: Path, tmp_path: Path) -> None:
    paths = convert_run(plane_run, "vtk", tmp_path / "vtk")
    assert [path.name for path in paths] == ["cells.pvd", "edges.pvd"]
    grid, sources = cell_grid(read_run(plane_run).mesh)
    assert len(sources) == len(grid.points)
    text = (tmp_path / "vtk" / "cells_00001.vtu").read_bytes()
    assert f'NumberOfPoints="{len(grid.points)}"'.encode() in text


def test_ugrid_has_x_and_y(plane_run: Path, tmp_path: Path) -> None:
    run = read_run(plane_run)
    (path,) = convert_run(plane_run, "ugrid", tmp_path / "run.nc")
    with netCDF4.Dataset(path) as file:
        assert (file.x_period, file.y_period) == (run.mesh.x_period, run.mesh.y_period)
        assert "sphere_radius" not in file.ncattrs()
        assert file["mesh"].face_coordinates == "face_x face_y"
        assert (file["face_x"].units, file["face_x"].standard_name) == ("m", "projection_x_coordinate")
        np.testing.assert_array_equal(file["node_y"][:], run.mesh.y_vertex)
        found = areas(file["face_x_bounds"][:], file["face_y_bounds"][:])
        np.testing.assert_allclose(found, run.mesh.area_cell, rtol=1e-9)
        np.testing.assert_array_equal(file["thickness"][-1], run.last_snapshot().fields["thickness"])
        assert file["thickness"].coordinates == "face_x face_y"
        assert not [name for name in file.variables if "lon" in name.split("_") or "lat" in name.split("_")]

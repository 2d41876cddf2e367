"""xarray, cf_xarray, iris, uxarray and VTK open the history and the mesh of a run, and find what is where and when."""

from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, read_mesh, write_mesh
from mesh.files.io import FORMATS
from mesh.parts.culling import culled

COORDINATES = {"thickness": "Cell", "normal_velocity": "Edge", "relative_vorticity": "Vertex"}


def values_of(run: Path, name: str, row: int) -> np.ndarray:
    with netCDF4.Dataset(run / "history.nc") as file:
        return np.asarray(file[name][row])


@pytest.mark.parametrize("name", COORDINATES)
def test_xarray_selects_by_time(mountain_run: Path, name: str) -> None:
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(mountain_run / "history.nc") as data:
        selected = data[name].sel(Time="2000-01-01T06:00")
        np.testing.assert_array_equal(selected, values_of(mountain_run, name, 1))
        assert data[name].sel(Time=slice("2000-01-01T01", "2000-01-02")).sizes["Time"] == 2
        place = COORDINATES[name]
        assert {f"lon{place}", f"lat{place}", "Time"} <= set(selected.coords)
    with xarray.open_dataset(mountain_run / "diagnostics.nc") as data:
        assert data["mass"].sel(Time="2000-01-01T12:00", method="nearest") > 0.0


@pytest.mark.parametrize("name", COORDINATES)
def test_cf_xarray_finds_coordinates_and_time(mountain_run: Path, name: str) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("cf_xarray")
    with xarray.open_dataset(mountain_run / "history.nc") as data:
        assert data[name].cf["longitude"].name == f"lon{COORDINATES[name]}"
        assert data[name].cf["latitude"].name == f"lat{COORDINATES[name]}"
        assert data[name].cf["T"].name == data[name].cf["time"].name == "Time"


@pytest.mark.parametrize(("name", "place"), [("areaCell", "Cell"), ("dcEdge", "Edge"), ("areaTriangle", "Vertex")])
def test_cf_xarray_finds_the_coordinates_of_a_mesh(mountain_run: Path, name: str, place: str) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("cf_xarray")
    with xarray.open_dataset(mountain_run / "mesh.nc") as data:
        assert data[name].cf["longitude"].name == f"lon{place}"


@pytest.mark.filterwarnings("ignore::FutureWarning")
@pytest.mark.parametrize("name", COORDINATES)
def test_iris_finds_coordinates_and_time(mountain_run: Path, name: str) -> None:
    iris = pytest.importorskip("iris")
    wanted = iris.NameConstraint(var_name=name) & iris.Constraint(time=lambda cell: cell.point.hour == 6)
    cube = iris.load_cube(mountain_run / "history.nc", wanted)
    np.testing.assert_array_equal(cube.data, values_of(mountain_run, name, 1))
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        longitudes = np.asarray(file[f"lon{COORDINATES[name]}"][:])
    np.testing.assert_array_equal(cube.coord("longitude").points, longitudes)
    assert str(cube.coord("latitude").units) == "rad"
    assert str(cube.coord("time").units) == "seconds since 2000-01-01 00:00:00"


@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_iris_opens_a_mesh(mountain_run: Path) -> None:
    iris = pytest.importorskip("iris")
    cube = iris.load_cube(mountain_run / "mesh.nc", iris.NameConstraint(var_name="areaCell"))
    assert str(cube.units) == "m2"
    assert cube.coord("longitude").shape == cube.shape == (162,)


def test_uxarray_puts_fields_on_the_mesh(mountain_run: Path) -> None:
    uxarray = pytest.importorskip("uxarray")
    data = uxarray.open_dataset(mountain_run / "mesh.nc", mountain_run / "history.nc")
    assert (data.uxgrid.n_face, data.uxgrid.n_edge, data.uxgrid.n_node) == (162, 480, 320)
    assert [data[name].dims[-1] for name in COORDINATES] == ["n_face", "n_edge", "n_node"]
    np.testing.assert_array_equal(data["thickness"].isel(Time=1), values_of(mountain_run, "thickness", 1))


def test_uxarray_opens_a_mesh_with_walls(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Its cells, edges and vertices, with the areas that they have and no neighbour across the coast."""
    uxarray = pytest.importorskip("uxarray")
    sea = culled(small_mesh, small_mesh.lat_cell < 0.5)
    write_mesh(sea, tmp_path / "sea.nc")
    grid = uxarray.open_grid(tmp_path / "sea.nc")
    assert (grid.n_face, grid.n_edge, grid.n_node) == (sea.n_cells, sea.n_edges, sea.n_vertices)
    columns = grid.face_node_connectivity.values[:, : sea.max_edges]
    np.testing.assert_array_equal(columns[sea.on_ring], sea.vertices_on_cell[sea.on_ring])
    np.testing.assert_array_equal(np.sort(grid.edge_node_connectivity), np.sort(sea.vertices_on_edge))
    np.testing.assert_allclose(grid.face_areas, sea.area_cell, rtol=1e-4)
    data = uxarray.open_dataset(tmp_path / "sea.nc", tmp_path / "sea.nc")
    np.testing.assert_array_equal(data["areaTriangle"], sea.area_triangle)


def opened_by_vtk(path: Path) -> tuple[Any, Any, list[str]]:
    """VTK's reader of MPAS files with all arrays of a file, its grid, and the errors that it reported."""
    reader = pytest.importorskip("vtkmodules.vtkIONetCDF").vtkMPASReader()
    errors: list[str] = []

    def report(_: object, __: str, text: str) -> None:
        errors.append(text)

    report.CallDataType = "string0"  # type: ignore[attr-defined]
    reader.AddObserver("ErrorEvent", report)
    reader.SetFileName(str(path))
    assert reader.CanReadFile(str(path))
    reader.UpdateInformation()
    reader.EnableAllCellArrays()
    reader.EnableAllPointArrays()
    reader.Update()
    return reader, reader.GetOutput(), errors


def array_of(attributes: Any, name: str) -> np.ndarray:
    return pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy(attributes.GetArray(name))


@pytest.mark.parametrize("file_format", FORMATS)
def test_vtk_opens_a_mesh(small_mesh: VoronoiMesh, tmp_path: Path, file_format: str) -> None:
    write_mesh(small_mesh, tmp_path / "mesh.nc", file_format=file_format)
    _, grid, errors = opened_by_vtk(tmp_path / "mesh.nc")
    assert not errors
    # The grid is the dual one: triangles between cell centres, of which VTK has one more, without a meaning, at first.
    assert grid.GetNumberOfCells() == 320
    np.testing.assert_array_equal(array_of(grid.GetPointData(), "areaCell")[1:], small_mesh.area_cell)
    np.testing.assert_array_equal(array_of(grid.GetCellData(), "areaTriangle"), small_mesh.area_triangle)


def test_vtk_opens_a_history(mountain_run: Path) -> None:
    reader, grid, errors = opened_by_vtk(mountain_run / "history.nc")
    assert not errors
    pipeline = pytest.importorskip("vtkmodules.vtkCommonExecutionModel").vtkStreamingDemandDrivenPipeline
    times = reader.GetOutputInformation(0).Get(pipeline.TIME_STEPS())
    assert len(times) == 3
    radius = read_mesh(mountain_run / "mesh.nc").sphere_radius
    assert np.linalg.norm(grid.GetPoint(1)) == pytest.approx(radius)
    for row, time in enumerate(times):
        reader.UpdateTimeStep(time)
        thickness = array_of(reader.GetOutput().GetPointData(), "thickness")[1:]
        np.testing.assert_array_equal(thickness, values_of(mountain_run, "thickness", row))
        vorticity = array_of(reader.GetOutput().GetCellData(), "relative_vorticity")
        np.testing.assert_array_equal(vorticity, values_of(mountain_run, "relative_vorticity", row))

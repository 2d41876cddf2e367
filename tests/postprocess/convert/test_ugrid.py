"""Files in the UGRID conventions: checkers pass, other programs open them, values are those of the run."""

import json
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh.discrete.walls import wall_edges
from postprocess.convert.conversion import convert_run
from postprocess.runs.reading import open_run
from swe.diagnostics.outputs import FIELDS

UGRID_ROLES = {"mesh_topology", "boundary_node_connectivity"} | {
    f"{name}_connectivity" for name in ("face_node", "face_edge", "face_face", "edge_node", "edge_face")
}


@pytest.fixture
def file(any_run: Path, tmp_path: Path) -> Path:
    convert_run(any_run, "ugrid", tmp_path / "run.nc")
    return tmp_path / "run.nc"


def test_ugrid_checks_finds_no_error(file: Path) -> None:
    pytest.importorskip("ugrid_checks")
    done = subprocess.run([sys.executable, "-m", "ugrid_checks", "-e", file], capture_output=True, text=True)
    assert "UGRID conformance checks complete" in done.stdout, done.stderr
    assert "FAIL" not in done.stdout
    assert "No problems found" in done.stdout or "0 Rxxx requirement failures" in done.stdout, done.stdout


@pytest.mark.slow
def test_compliance_checker_finds_no_error(file: Path, tmp_path: Path) -> None:
    """Of its high priority. Section 9.5 is on discrete geometries, and the checker takes the roles of UGRID for those.

    CF has them since 1.11; the checker objects to each of them, and to more than one, and to nothing else.
    """
    pytest.importorskip("compliance_checker")
    report = tmp_path / "report.json"
    arguments = [str(file), ["cf:1.11"], 0, "strict"]
    program = (
        "from compliance_checker.runner import CheckSuite, ComplianceChecker; "
        "CheckSuite.load_all_available_checkers(); "
        f"ComplianceChecker.run_checker(*{arguments}, output_filename={str(report)!r}, output_format='json')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert report.exists(), done.stderr
    errors = json.loads(report.read_text())["cf:1.11"]["high_priorities"]
    assert len(errors) > 10
    sentences = [f"{each['name']}: {text}" for each in errors for text in each["msgs"]]
    expected = ("is not a valid cf_role value", "only be one variable containing the cf_role attribute")
    others = [each for each in sentences if not (each.startswith("§9.5") and any(text in each for text in expected))]
    assert not others
    with netCDF4.Dataset(file) as data:
        roles = {variable.cf_role for variable in data.variables.values() if "cf_role" in variable.ncattrs()}
    assert roles <= UGRID_ROLES


def test_values_times_and_attributes_are_those_of_the_run(any_run: Path, file: Path) -> None:
    locations = {"nCells": "face", "nEdges": "edge", "nVertices": "node"}
    with netCDF4.Dataset(any_run / "history.nc") as source, netCDF4.Dataset(file) as found:
        assert found.Conventions == "CF-1.11 UGRID-1.0"
        assert found.sphere_radius == source.sphere_radius
        np.testing.assert_array_equal(found["time"][:], source["time"][:])
        assert len(found["time"]) == 3
        assert found["time"].calendar == "proleptic_gregorian"
        for name, field in FIELDS.items():
            location = locations[field.place]
            np.testing.assert_array_equal(found[name][:], source[name][:])
            assert (found[name].mesh, found[name].location) == ("mesh", location)
            assert found[name].coordinates == f"{location}_lon {location}_lat"
            assert (found[name].units, found[name].long_name) == (field.units, field.meaning)
            assert getattr(found[name], "standard_name", "") == field.standard_name
            assert found[name].cell_methods == ("area: mean time: point" if name == "thickness" else "time: point")
        np.testing.assert_array_equal(found["topography"][:], source["topography"][:])
        np.testing.assert_array_equal(found["face_area"][:], source["areaCell"][:])
        np.testing.assert_allclose(np.radians(found["node_lat"][:]), source["latVertex"][:], atol=1e-14)


def test_topology_is_that_of_the_mesh(any_run: Path, file: Path) -> None:
    mesh = open_run(any_run).mesh
    with netCDF4.Dataset(file) as found:
        found.set_auto_mask(False)
        corners = found.dimensions["corner"].size
        for name, values in (("face_nodes", mesh.vertices_on_cell), ("face_faces", mesh.cells_on_cell)):
            expected = np.where(mesh.on_ring, values, -1)[:, :corners]
            np.testing.assert_array_equal(found[name][:], expected)
            assert (found[name].start_index, found[name]._FillValue) == (0, -1)
        np.testing.assert_array_equal(found["edge_faces"][:], mesh.cells_on_edge)
        np.testing.assert_array_equal(found["edge_nodes"][:], mesh.vertices_on_edge)
        walls = wall_edges(mesh)
        assert ("wall_nodes" in found.variables) == (len(walls) > 0)
        if len(walls):
            np.testing.assert_array_equal(found["wall_nodes"][:], mesh.vertices_on_edge[walls])
            assert found["mesh"].boundary_node_connectivity == "wall_nodes"


def test_bounds_are_the_corners_and_not_torn(any_run: Path, file: Path) -> None:
    mesh = open_run(any_run).mesh
    with netCDF4.Dataset(file) as found:
        longitudes, middle = found["face_lon_bounds"][:], found["face_lon"][:]
        latitudes = found["face_lat_bounds"][:]
    assert np.abs(longitudes - middle[:, None]).max() <= 180.0
    for cell in (0, 7, mesh.n_cells - 1):
        ring = mesh.vertices_on_cell[cell, : mesh.n_edges_on_cell[cell]]
        np.testing.assert_allclose(latitudes[cell, : len(ring)], np.degrees(mesh.lat_vertex[ring]))
        turns = (longitudes[cell, : len(ring)] - np.degrees(mesh.lon_vertex[ring])) / 360.0
        np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
        assert np.all(latitudes[cell, len(ring) :] == latitudes[cell, len(ring) - 1])


@pytest.mark.slow
def test_uxarray_opens_it(any_run: Path, file: Path) -> None:
    uxarray = pytest.importorskip("uxarray")
    mesh = open_run(any_run).mesh
    data = uxarray.open_dataset(file, file)
    assert (data.uxgrid.n_face, data.uxgrid.n_edge, data.uxgrid.n_node) == (mesh.n_cells, mesh.n_edges, mesh.n_vertices)
    assert data["thickness"].dims == ("time", "n_face")
    assert data["relative_vorticity"].dims == ("time", "n_node")
    assert float(data.uxgrid.face_areas.sum()) == pytest.approx(mesh.area_cell.sum() / mesh.sphere_radius**2, rel=1e-3)


def test_xarray_decodes_times(mountain_run: Path, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    convert_run(mountain_run, "ugrid", tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc") as data:
        assert float(data["thickness"].sel(time="2000-01-01T06:00").min()) > 0.0


@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_iris_puts_fields_on_the_mesh(any_run: Path, file: Path) -> None:
    iris = pytest.importorskip("iris")
    cube = iris.load_cube(file, iris.NameConstraint(var_name="thickness"))
    mesh = open_run(any_run).mesh
    assert cube.location == "face"
    assert cube.mesh.face_node_connectivity.shape[0] == mesh.n_cells
    assert cube.coord("time").shape == (3,)


def test_angles_of_normals_are_degrees_from_east(file: Path) -> None:
    with netCDF4.Dataset(file) as found:
        found.set_auto_mask(False)
        assert found["edge_normal_angle"].units == "degrees"
        angle, faces = found["edge_normal_angle"][:], found["edge_faces"][:]
        longitude, latitude = (np.radians(found[f"edge_{kind}"][:]) for kind in ("lon", "lat"))
        points = unit_vectors(*(np.radians(found[f"face_{kind}"][:]) for kind in ("lon", "lat")))
    east = np.stack([-np.sin(longitude), np.cos(longitude), np.zeros_like(longitude)], axis=1)
    north = unit_vectors(longitude, latitude + 0.5 * np.pi)
    inner = faces.min(axis=1) >= 0
    across = points[faces[inner, 1]] - points[faces[inner, 0]]
    expected = np.degrees(np.arctan2((across * north[inner]).sum(axis=1), (across * east[inner]).sum(axis=1)))
    away = (angle[inner] - expected + 180.0) % 360.0 - 180.0
    assert np.abs(away).max() < 2.0


def unit_vectors(longitude: np.ndarray, latitude: np.ndarray) -> np.ndarray:
    return np.stack(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=1
    )

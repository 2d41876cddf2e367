"""Files of meshes on planes: ours come back to the bit, those of the community's tool are read, damage is told."""

import warnings
from dataclasses import replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, MeshWarning, VoronoiMesh, hexagon_mesh, mesh_quality, read_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.files.io import FORMATS, mesh_hash
from mesh.files.part_of_file import scaled_hash_of_file, write_scaled_copy
from tests.planar_tool import write_planar_file

ROW = 0.5 * np.sqrt(3.0)
PERIODIC = {"xy": ("YES", 6.0, 6.0 * ROW), "x": ("YES", 6.0, 0.0), "none": ("NO", 0.0, 0.0)}


@pytest.fixture(params=PERIODIC)
def mesh(request: pytest.FixtureRequest) -> VoronoiMesh:
    return hexagon_mesh((6e3, 6e3 * ROW), (6, 6), request.param)


def assert_same(found: VoronoiMesh, expected: VoronoiMesh) -> None:
    for variable in MESH_VARIABLES:
        value, wanted = getattr(found, variable.name), getattr(expected, variable.name)
        np.testing.assert_array_equal(value, wanted, err_msg=variable.name, strict=True)
        assert value.tobytes() == wanted.tobytes(), variable.name
    assert [found.sphere_radius, found.x_period, found.y_period] == [0.0, expected.x_period, expected.y_period]


@pytest.mark.parametrize("file_format", FORMATS)
def test_a_file_read_is_the_mesh_with_its_stamp_and_without(
    mesh: VoronoiMesh, tmp_path: Path, file_format: str
) -> None:
    path = tmp_path / "plane.nc"
    write_mesh(mesh, path, file_format=file_format)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_same(read_mesh(path), mesh)
        with netCDF4.Dataset(path, "r+") as file:
            file.delncattr("validated_hash")
        assert_same(read_mesh(path), mesh)


@pytest.mark.parametrize("periodic", PERIODIC)
def test_attributes_are_those_of_planes(periodic: str, tmp_path: Path) -> None:
    write_mesh(hexagon_mesh((6e3, 6e3 * ROW), (6, 6), periodic), tmp_path / "plane.nc")
    with netCDF4.Dataset(tmp_path / "plane.nc") as file:
        said, x_period, y_period = PERIODIC[periodic]
        assert (file.on_a_sphere, file.sphere_radius, file.is_periodic) == ("NO", 0.0, said)
        np.testing.assert_allclose([file.x_period, file.y_period], [1e3 * x_period, 1e3 * y_period], rtol=1e-15)
        assert not file["zCell"][:].any()


def test_metrics_made_anew_are_the_same_but_for_rounding(mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(mesh, tmp_path / "plane.nc")
    rebuilt = read_mesh(tmp_path / "plane.nc", recompute_metrics=True)
    for name in ("area_cell", "dc_edge", "dv_edge", "kite_areas_on_vertex", "weights_on_edge", "x_cell", "y_cell"):
        np.testing.assert_allclose(getattr(rebuilt, name), getattr(mesh, name), rtol=1e-10, atol=1e-10, err_msg=name)


def test_a_file_of_the_community_is_read(tmp_path: Path) -> None:
    write_planar_file(tmp_path / "hexagons.nc", 6, 4, 1e3)
    with pytest.warns(MeshWarning, match=r"made .*edgesOnEdge.*weightsOnEdge"):
        mesh = read_mesh(tmp_path / "hexagons.nc")
    ours = hexagon_mesh((6e3, 4e3 * ROW), (6, 4))
    assert (mesh.x_period, mesh.y_period) == (6000.0, pytest.approx(ours.y_period, rel=1e-15))
    assert mesh_quality(mesh).residual < 1e-13
    found, wanted = (np.sort(np.abs(each.weights_on_edge)) for each in (mesh, ours))
    np.testing.assert_allclose(found, wanted, atol=1e-14)
    with netCDF4.Dataset(tmp_path / "hexagons.nc") as file:
        np.testing.assert_array_equal(mesh.x_vertex, file["xVertex"][:])
        np.testing.assert_array_equal(mesh.cells_on_edge, file["cellsOnEdge"][:] - 1)
        np.testing.assert_array_equal(mesh.angle_edge, file["angleEdge"][:])


def test_positions_may_be_any_images(tmp_path: Path) -> None:
    write_planar_file(tmp_path / "hexagons.nc", 6, 4, 1e3)
    with netCDF4.Dataset(tmp_path / "hexagons.nc", "r+") as file:
        file["xVertex"][::3] = file["xVertex"][::3] + 6e3
        file["yEdge"][::2] = file["yEdge"][::2] - 4e3 * ROW
    with pytest.warns(MeshWarning) as warned:
        read_mesh(tmp_path / "hexagons.nc")
    assert "replaced" not in str(warned[0].message)


def test_coordinates_in_single_precision_are_read(tmp_path: Path) -> None:
    """Rounded relative to the extent of the plane, not to one."""
    write_planar_file(tmp_path / "hexagons.nc", 60, 60, 1e3)
    with netCDF4.Dataset(tmp_path / "hexagons.nc") as source, netCDF4.Dataset(tmp_path / "single.nc", "w") as target:
        target.setncatts({name: source.getncattr(name) for name in source.ncattrs()})
        for name, dimension in source.dimensions.items():
            target.createDimension(name, len(dimension))
        for name, values in source.variables.items():
            kind = np.float32 if name in ("xCell", "yCell", "zCell") else values.dtype
            target.createVariable(name, kind, values.dimensions)[:] = values[:]
    with pytest.warns(MeshWarning, match="coordinates are in single precision, so that all metrics"):
        mesh = read_mesh(tmp_path / "single.nc")
    np.testing.assert_allclose(mesh.area_cell, ROW * 1e6, rtol=1e-4)


def test_damage_is_told(tmp_path: Path) -> None:
    path = tmp_path / "plane.nc"
    write_mesh(hexagon_mesh((6e3, 4e3 * ROW), (6, 4)), path)

    def refused_with(words: str, **attributes: object) -> None:
        with netCDF4.Dataset(path, "r+") as file:
            file.setncatts(attributes)
        with pytest.raises(MeshError, match=words):
            read_mesh(path)

    refused_with("differs from what the generators give", x_period=6500.0)
    refused_with("is_periodic is YES, but x_period and y_period are 0.0 and 0.0", x_period=0.0, y_period=0.0)
    refused_with("has no walls, but its plane is not periodic in both directions", x_period=6000.0)
    with netCDF4.Dataset(path, "r+") as file:
        file.y_period = 4e3 * ROW
        file["xVertex"][5] = file["xVertex"][5] + 900.0
    refused_with("xVertex, yVertex or zVertex differs|vertices of the edge lie against")


def test_the_periods_belong_to_the_hash_and_files_are_copied_as_they_are(tmp_path: Path) -> None:
    mesh = hexagon_mesh((6e3, 4e3 * ROW), (6, 4))
    assert mesh_hash(mesh) != mesh_hash(replace(mesh, x_period=7e3))
    write_mesh(mesh, tmp_path / "plane.nc")
    assert scaled_hash_of_file(tmp_path / "plane.nc", 0.0) == mesh_hash(mesh)
    write_scaled_copy(tmp_path / "plane.nc", tmp_path / "copy.nc", 0.0, mesh_hash(mesh))
    assert_same(read_mesh(tmp_path / "copy.nc"), mesh)

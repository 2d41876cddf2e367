"""Files of validated meshes are read without validating them again, and everything else in full."""

import warnings
from dataclasses import replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, MeshWarning, VoronoiMesh, read_mesh, scvt_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.files import io, stamp
from mesh.files.io import mesh_hash

EARTH = 6371229.0


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    return path


@pytest.fixture
def in_full(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Grows with every mesh that is assembled and validated on reading."""
    assembled: list[object] = []
    true_assembly = io.assembled_mesh

    def counted(*arguments: object) -> object:
        assembled.append(arguments)
        return true_assembly(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(io, "assembled_mesh", counted)
    return assembled


def stamp_in(path: Path) -> str:
    with netCDF4.Dataset(path) as file:
        return str(getattr(file, "validated_hash", ""))


def without_stamp(path: Path) -> VoronoiMesh:
    """The mesh of a file that loses its stamp."""
    with netCDF4.Dataset(path, "r+") as file:
        file.delncattr("validated_hash")
    return read_mesh(path)


def assert_same(found: VoronoiMesh, expected: VoronoiMesh) -> None:
    for name, value in vars(expected).items():
        np.testing.assert_array_equal(getattr(found, name), value, err_msg=name, strict=isinstance(value, np.ndarray))
    assert found.sphere_radius == expected.sphere_radius


@pytest.mark.parametrize("radius", [1.0, EARTH])
def test_a_stamped_file_is_not_validated_and_gives_the_same(
    any_mesh: VoronoiMesh, tmp_path: Path, in_full: list[object], radius: float
) -> None:
    path = tmp_path / "mesh.nc"
    mesh = any_mesh.scaled(radius)
    write_mesh(mesh, path)
    assert stamp_in(path) == mesh_hash(mesh)
    quickly = read_mesh(path)
    assert not in_full
    assert_same(quickly, mesh)
    assert_same(without_stamp(path), quickly)
    assert in_full


@pytest.mark.parametrize("file_format", ["netcdf4", "cdf5", "classic"])
def test_all_formats_are_stamped(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, in_full: list[object], file_format: str
) -> None:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc", file_format=file_format)
    assert_same(read_mesh(tmp_path / "mesh.nc"), icosahedral_mesh)
    assert not in_full


@pytest.mark.slow
def test_a_nested_mesh_and_one_that_was_read_are_stamped(tmp_path: Path, in_full: list[object]) -> None:
    nested = scvt_mesh(nested=scvt_mesh(162), density="refined-circle", cells=200)
    assert nested.fixed_cells is not None
    write_mesh(nested, tmp_path / "nested.nc")
    read = read_mesh(tmp_path / "nested.nc")
    assert_same(read, nested)
    write_mesh(read.scaled(EARTH), tmp_path / "again.nc")
    assert_same(read_mesh(tmp_path / "again.nc"), nested.scaled(EARTH))
    assert not in_full


def test_a_file_that_was_read_in_full_without_a_warning_is_stamped(mesh_file: Path, tmp_path: Path) -> None:
    write_mesh(without_stamp(mesh_file), tmp_path / "again.nc")
    assert stamp_in(tmp_path / "again.nc") == mesh_hash(read_mesh(mesh_file))


@pytest.mark.parametrize("name", [variable.file_name for variable in MESH_VARIABLES])
def test_one_changed_value_leads_to_the_full_check(mesh_file: Path, in_full: list[object], name: str) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        values = file[name][:]
        values[len(values) // 2] += 1
        file[name][:] = values
    found = [outcome(mesh_file), outcome(mesh_file)]
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file.delncattr("validated_hash")
    assert outcome(mesh_file) == found[0] == found[1]
    assert len(in_full) == 3


def outcome(path: Path) -> tuple[list[str], str]:
    """What reading a file warns of, and its error or the hash of its mesh."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            result = mesh_hash(read_mesh(path))
        except MeshError as error:
            result = str(error)
    return [str(each.message) for each in told], result


def test_what_stands_beyond_rings_is_part_of_the_hash(mesh_file: Path, in_full: list[object]) -> None:
    expected = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        pentagon = int(np.argmin(file["nEdgesOnCell"][:]))
        file["edgesOnCell"][pentagon, 5] = 7
    assert_same(read_mesh(mesh_file), expected)
    assert len(in_full) == 1


@pytest.mark.parametrize(("attribute", "value"), [("sphere_radius", 2.0), ("validated_rules", 0)])
def test_other_attributes_lead_to_the_full_check(
    mesh_file: Path, in_full: list[object], attribute: str, value: float
) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file.setncattr(attribute, value)
    outcome(mesh_file)
    assert len(in_full) == 1


def test_units_of_degrees_are_seen(mesh_file: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["latCell"].units = "degrees_north"
    with pytest.warns(MeshWarning, match="replaced latCell"):
        read_mesh(mesh_file)


def test_raised_rules_lead_to_the_full_check(
    mesh_file: Path, in_full: list[object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stamp, "RULES", stamp.RULES + 1)
    read_mesh(mesh_file)
    assert len(in_full) == 1


def test_recomputed_metrics_pay_no_heed_to_the_stamp(mesh_file: Path, in_full: list[object]) -> None:
    read_mesh(mesh_file, recompute_metrics=True)
    assert len(in_full) == 1


def test_arrays_changed_in_place_are_not_stamped(tmp_path: Path) -> None:
    mesh = scvt_mesh(42)
    for change in (1.0, -1.0):
        mesh.weights_on_edge[4:8] *= change
        path = tmp_path / "mesh.nc"
        for each in (mesh, mesh.scaled(EARTH)):
            write_mesh(each, path)
            assert bool(stamp_in(path)) == (change == 1.0)
    with pytest.raises(MeshError, match="weightsOnEdge differs from"):
        read_mesh(path)


def test_meshes_of_other_origin_are_not_stamped(mesh_file: Path, tmp_path: Path) -> None:
    """Copies with other arrays, and files that a warning was given of."""
    mesh = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["areaCell"][:] = file["areaCell"][:] * (1.0 + 1e-8 * np.sin(np.arange(mesh.n_cells)))
    with pytest.warns(MeshWarning, match="holds only to"):
        noisy = read_mesh(mesh_file)
    for other in (replace(mesh, density_name="mine"), noisy, noisy.scaled(EARTH)):
        write_mesh(other, tmp_path / "other.nc")
        assert not stamp_in(tmp_path / "other.nc")

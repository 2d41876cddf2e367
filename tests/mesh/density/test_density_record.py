import hashlib
from dataclasses import replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from density_files import EAST, NORTH, field, write_file

from mesh import VoronoiMesh, mesh_from_points, mesh_quality, read_mesh, scvt_mesh, write_mesh
from mesh.density.gridded import Shaping, read_density
from mesh.density.named import NAMED, RefinedBox, uniform
from mesh.density.record import density_of, name_of
from mesh.discrete.quality import quality_and_note
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits
from mesh.generation.pipeline import mesh_of
from mesh.generation.scvt import generate_scvt
from mesh.generation.well_centered import well_center
from mesh.geometry.sphere import from_lonlat, normalize
from mesh.mesh_request import MeshRequest

TOLERANCE = 3e-5
LATITUDE, LONGITUDE = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)


def grid(path: Path, factor: float = 1.0) -> Path:
    values = factor * field(LONGITUDE[None], LATITUDE[:, None])
    coordinates = {"lat": (("lat",), LATITUDE, NORTH), "lon": (("lon",), LONGITUDE, EAST)}
    return write_file(path, **coordinates, width=(("lat", "lon"), values, {}))


def reread(mesh: VoronoiMesh, path: Path) -> VoronoiMesh:
    write_mesh(mesh, path)
    return read_mesh(path)


@pytest.fixture
def mesh(tmp_path: Path) -> VoronoiMesh:
    """A mesh for a density from a file, read back from its own file."""
    density = read_density(grid(tmp_path / "grid.nc"), "width", Shaping(0.5, -2.0, 1))
    return reread(scvt_mesh(162, density, tolerance=TOLERANCE), tmp_path / "mesh.nc")


def test_residual_is_that_converged_to(mesh: VoronoiMesh) -> None:
    assert mesh.density_name.endswith("grid.nc")
    assert mesh_quality(mesh).residual <= TOLERANCE
    assert quality_and_note(mesh)[1] == ""
    between = replace(mesh, density_name="", density_source="")
    assert mesh_quality(between).residual > 1e-4
    assert quality_and_note(between)[1] == "for the density interpolated between the cells"


def test_density_is_looked_for_in_this_folder_too(
    mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "grid.nc").rename(tmp_path / "elsewhere" / "grid.nc")
    assert np.isnan(mesh_quality(replace(mesh, density_name="grid.nc")).residual)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert mesh_quality(replace(mesh, density_name="grid.nc")).residual <= TOLERANCE


def test_changed_file_is_noticed(mesh: VoronoiMesh, tmp_path: Path) -> None:
    grid(tmp_path / "grid.nc", 1.001)
    assert np.isnan(mesh_quality(mesh).residual)
    assert quality_and_note(mesh)[1].endswith("grid.nc, which is missing or has changed since")
    grid(tmp_path / "grid.nc")
    assert mesh_quality(mesh).residual <= TOLERANCE


@pytest.mark.parametrize("source", ["{", "[]", '{"path": 1}', '{"path": "x", "variable": "y", "floor": "z"}'])
def test_damaged_source_is_said(mesh: VoronoiMesh, source: str) -> None:
    assert density_of(replace(mesh, density_source=source)) == (
        None,
        "unknown, since the attribute density_source of the mesh is damaged",
    )


def test_functions_are_not_in_the_file_but_may_be_given(tmp_path: Path) -> None:
    def towards_x(points: np.ndarray) -> np.ndarray:
        return np.exp(points[:, 0])

    read = reread(scvt_mesh(162, towards_x), tmp_path / "mesh.nc")
    assert read.density_name == "function towards_x"
    assert np.isnan(mesh_quality(read).residual)
    assert quality_and_note(read)[1] == "unknown, since the density was the function towards_x"
    assert mesh_quality(read, towards_x).residual <= 1e-6


def test_sources_tell_values_and_places_of_points(tmp_path: Path) -> None:
    """By their sum, in which nothing else is: it must be the same in every program that reads the field."""
    lon, lat = np.radians(LONGITUDE), np.radians(np.linspace(-80.0, 80.0, 36))
    values = field(LONGITUDE, np.degrees(lat))
    coordinates = {"lat": (("n",), lat, {"units": "rad"}), "lon": (("n",), lon, {"units": "rad"})}
    density = read_density(write_file(tmp_path / "points.nc", **coordinates, width=(("n",), values, {})), "width")
    digest = hashlib.sha256(values.tobytes() + from_lonlat(lon, lat).tobytes()).hexdigest()
    assert density.digest == digest


def test_names_of_densities() -> None:
    assert [name_of(density) for density in NAMED.values()] == list(NAMED)
    assert name_of(RefinedBox()) == "refined-box"
    assert name_of(RefinedBox(ratio=2.0)) == "function RefinedBox"


@pytest.mark.slow
def test_held_generators_do_not_count(tmp_path: Path) -> None:
    box = RefinedBox()
    coarse = generate_scvt(MeshRequest(162))
    result = nested_scvt(coarse.points, coarse.triangles, box, limits=Limits(1e-5))
    assert result.fixed is not None
    read = reread(mesh_of(result, box), tmp_path / "mesh.nc")
    with netCDF4.Dataset(tmp_path / "mesh.nc") as file:
        fixed = file["fixedCell"]
        assert fixed.units == "1"
        assert fixed.long_name == "1 where the generator was held while others moved, 0 elsewhere"
        assert fixed[:].tolist() == np.where(result.fixed, 1, 0).tolist()
    np.testing.assert_array_equal(read.fixed_cells, result.fixed)
    assert mesh_quality(read).residual == pytest.approx(result.history.residual[-1], rel=1e-3)
    assert mesh_quality(replace(read, fixed_cells=None)).residual > 1e-3
    assert quality_and_note(read)[1] == f"{result.fixed.sum()} generators that were held fixed are not counted"
    better = well_center(result.points, result.triangles, box, result.fixed)
    centred = mesh_of(replace(result, points=better.points, triangles=better.triangles), box)
    assert mesh_quality(centred).residual == pytest.approx(better.residual, rel=1e-6)


def test_mesh_that_tells_nothing_has_the_density_of_its_centres() -> None:
    points = generate_scvt(MeshRequest(162)).points
    assert density_of(mesh_from_points(points)) == (uniform, "")
    foreign = mesh_from_points(points, density=lambda x: 2.0 + x[:, 0])
    density, note = density_of(foreign)
    assert density is not None
    np.testing.assert_array_equal(density(normalize(foreign.cell_points)), foreign.mesh_density)
    assert note == "for the density interpolated between the cells"
    for wrong in (np.nan, -1.0, 0.0):
        damaged = replace(foreign, mesh_density=np.where(np.arange(162) == 5, wrong, foreign.mesh_density))
        assert np.isnan(mesh_quality(damaged).residual)
        assert "not positive and finite everywhere" in quality_and_note(damaged)[1]

"""`trisk cull`: what it writes, prints and refuses."""

import json
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, cull_mesh, read_mesh, write_mesh
from tests.trisk.conftest import Call

BOX = "280,350,10,60"


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


def test_the_file_has_the_cells_of_the_region(
    trisk: Call, mesh_file: Path, icosahedral_mesh: VoronoiMesh, tmp_path: Path
) -> None:
    code, out, err = trisk("cull", mesh_file, "--keep", BOX, "-o", tmp_path / "sea.nc")
    assert (code, err) == (0, "")
    expected = cull_mesh(icosahedral_mesh, BOX)
    assert out.splitlines()[0] == (
        f"kept {expected.n_cells} of 642 cells; left out of the region 0 cells of channels, and 0 lakes of 0 cells"
    )
    assert "Quality of" in out
    assert f"│ {expected.n_cells} " in out
    found = read_mesh(tmp_path / "sea.nc")
    np.testing.assert_array_equal(found.cell_points, expected.cell_points)
    np.testing.assert_array_equal(found.cells_on_edge, expected.cells_on_edge)
    with netCDF4.Dataset(tmp_path / "sea.nc") as file:
        cells = file["cellsOnEdge"][:]
        assert (cells[:, 0] > 0).all()
        assert (cells[:, 1] == 0).any()
        assert f"cull {mesh_file} --keep {BOX}" in file.history


def test_quiet_and_a_box_that_begins_with_a_minus(trisk: Call, mesh_file: Path, tmp_path: Path) -> None:
    for name, box in (("a.nc", BOX), ("b.nc", "-80,-10,10,60")):
        assert trisk("cull", mesh_file, "--keep", box, "-o", tmp_path / name, "-q") == (0, "", "")
    first, second = read_mesh(tmp_path / "a.nc"), read_mesh(tmp_path / "b.nc")
    np.testing.assert_array_equal(first.cell_points, second.cell_points)


def test_lakes_and_channels_are_kept_if_asked(trisk: Call, mesh_file: Path, tmp_path: Path) -> None:
    """A second sea, of about half the size, and a row of cells at a corner of the first."""
    seas = [[[0, 0], [60, 0], [60, 40], [0, 40], [0, 0]], [[180, 0], [220, 0], [220, 30], [180, 30], [180, 0]]]
    inlet = [[59, 18], [100, 18], [100, 24], [59, 24], [59, 18]]
    path = tmp_path / "seas.geojson"
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": [[ring] for ring in (*seas, inlet)]}))
    pytest.importorskip("shapely", reason="shapely is not installed; pip install 'trisk[coast]' brings it")
    counts = []
    for options in ([], ["--keep-lakes"], ["--keep-channels"]):
        code, out, _ = trisk("cull", mesh_file, "--keep", path, "-o", tmp_path / "sea.nc", *options)
        assert code == 0
        counts.append([int(word) for word in out.splitlines()[0].replace(";", "").split() if word.isdigit()])
    (sea, _, channels, lakes, lake), every, with_channels = counts
    assert channels > 0
    assert (lakes, lake) == (1, every[0] - sea)
    assert every[3:] == [0, 0]
    assert with_channels[:4] == [sea + channels, 642, 0, 1]


def test_regions_are_listed_in_the_help_and_bad_ones_refused(trisk: Call, mesh_file: Path, tmp_path: Path) -> None:
    for region, words in (
        (
            "atlantis",
            "there is no region named 'atlantis'; choose one of north-atlantic, world-ocean, a box in degrees",
        ),
        ("280,350,60,10", "the box 280,350,60,10 is upside down"),
        ("100,101,5,6", "the region 100,101,5,6 holds the centre of none of the 642 cells; take a larger region"),
        (f"{mesh_file}:depth", "there is no variable named depth; name one of those that it has"),
        (f"{tmp_path}/none.geojson", "none.geojson: No such file or directory; give a GeoJSON file with a polygon"),
    ):
        code, out, err = trisk("cull", mesh_file, "--keep", region, "-o", tmp_path / "sea.nc")
        assert (code, out) == (2, "")
        assert err.startswith("error: ")
        assert words in err
        assert err.count("\n") == 1
    assert not (tmp_path / "sea.nc").exists()
    help_text = " ".join(trisk("cull", "--help")[1].split())
    assert "north-atlantic, world-ocean, a box WEST,EAST,SOUTH,NORTH in degrees" in help_text


def test_real_coasts_without_the_package(
    trisk: Call, mesh_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from mesh.regions import real_ocean

    real_ocean._table.cache_clear()
    monkeypatch.setitem(sys.modules, "landmetrics", None)
    assert trisk("cull", mesh_file, "--keep", "world-ocean", "-o", tmp_path / "sea.nc")[::2] == (
        2,
        "error: a sea with its real coasts needs landmetrics, which is not installed; pip install 'trisk[coast]'\n",
    )

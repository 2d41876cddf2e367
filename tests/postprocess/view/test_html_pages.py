"""What pages hold, without a browser."""

import json
import re
import shutil
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, hexagon_mesh
from mesh.voronoi_mesh import mesh_in_words
from postprocess import open_run
from postprocess.view import html_page, page_of, view_page
from swe.errors import InputError
from tests.postprocess.view.test_packing import unpacked

BYTES_OF_A_MEGABYTE = 1_000_000


def content_of(page: str) -> dict:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def test_fields_of_a_run(mountain_run: Path) -> None:
    content = content_of(page_of(open_run(mountain_run)))
    names = [field["name"] for field in content["fields"]]
    assert names == [
        *("thickness", "surface_height", "kinetic_energy", "velocity_zonal", "velocity_meridional"),
        *("relative_vorticity", "potential_vorticity", "topography", "cell area", "sigma", "distance to centroid"),
    ]
    assert content["days"] == [0.0, 0.25, 0.5]
    assert content["title"] == "williamson5, 162 cells"
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        for field in content["fields"][:8]:
            values = np.atleast_2d(file[field["name"]][:])
            [pane] = field["panes"]
            step = (pane["high"] - pane["low"]) / (2 ** field["bits"] - 2)
            back = pane["low"] + step * unpacked(pane["values"], field["rows"], field["bits"])
            assert np.abs(back - values).max() <= 0.5 * step * (1 + 1e-6)


def test_chosen_fields_may_be_at_edges(mountain_run: Path) -> None:
    content = content_of(page_of(open_run(mountain_run), fields=["normal_velocity", "thickness"]))
    assert [field["name"] for field in content["fields"]][:2] == ["normal_velocity", "thickness"]
    assert set(content["mesh"]["places"]) == {"nCells", "nEdges"}


def test_large_runs_keep_eight_bits(mountain_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    values = 3 * (5 * 162 + 2 * 320) + 3 * 162
    for most, bits in ((values, 16), (values - 1, 8)):
        monkeypatch.setattr(html_page, "MOST_VALUES_OF_16_BITS", most)
        fields = content_of(page_of(open_run(mountain_run)))["fields"]
        assert [field["bits"] for field in fields] == [bits] * 8 + [16] * 3
    monkeypatch.setattr(html_page, "MOST_VALUES_OF_16_BITS", 3 * values - 1)
    both = content_of(page_of(open_run(mountain_run), open_run(mountain_run)))
    assert {field["bits"] for field in both["fields"]} == {8}


def test_two_runs_and_their_difference(mountain_run: Path, damped_run: Path) -> None:
    content = content_of(page_of(open_run(mountain_run), open_run(damped_run)))
    assert len(content["panes"]) == 3
    field = content["fields"][0]
    with netCDF4.Dataset(mountain_run / "history.nc") as first, netCDF4.Dataset(damped_run / "history.nc") as second:
        expected = first["thickness"][:] - second["thickness"][:]
    assert np.abs(expected).max() > 0.0
    difference = field["panes"][2]
    step = (difference["high"] - difference["low"]) / (2**16 - 2)
    back = difference["low"] + step * unpacked(difference["values"], 3, 16)
    np.testing.assert_allclose(back, expected, atol=0.51 * step, rtol=0.0)
    assert {key: field["panes"][0][key] for key in ("low", "high")} == {
        key: field["panes"][1][key] for key in ("low", "high")
    }


def test_what_cannot_be_shown_is_told(mountain_run: Path, sea_run: Path, tmp_path: Path) -> None:
    run = open_run(mountain_run)
    with pytest.raises(InputError, match=r"no field named 'heat'; choose among thickness, .*topography"):
        page_of(run, fields=["heat"])
    with pytest.raises(InputError, match="different meshes"):
        page_of(run, open_run(sea_run))
    with pytest.raises(InputError, match="there is no folder"):
        view_page(run, tmp_path / "nowhere" / "page.html")
    (tmp_path / "folder.html").mkdir()
    with pytest.raises(InputError, match=r"folder\.html cannot be written, as it exists and is not a file; choose"):
        view_page(run, tmp_path / "folder.html")


def test_a_mesh_alone_has_a_page_of_its_measures(icosahedral_mesh: VoronoiMesh, mountain_run: Path) -> None:
    mesh = icosahedral_mesh.scaled(6371e3)
    content = content_of(page_of(mesh))
    assert content["title"] == mesh_in_words(mesh)
    assert (content["days"], content["panes"]) == ([], [])
    assert [field["name"] for field in content["fields"]] == ["cell area", "sigma", "distance to centroid"]
    [area] = content["fields"][0]["panes"]
    back = area["low"] + (area["high"] - area["low"]) / (2**16 - 2) * unpacked(area["values"], 1, 16)[0]
    np.testing.assert_allclose(back, mesh.area_cell / 1e6, rtol=1e-5)
    for others in ({"other": open_run(mountain_run)}, {"fields": ["thickness"]}):
        with pytest.raises(InputError, match="a mesh alone has no run beside it"):
            page_of(mesh, **others)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "unit"),
    [
        (lambda: hexagon_mesh((6e5, 3e5 * np.sqrt(3.0)), (6, 6)), "km²"),
        (lambda: hexagon_mesh((60.0, 30.0 * np.sqrt(3.0)), (6, 6)), "m²"),
    ],
)
def test_regular_cells_are_all_the_same(make: Callable[[], VoronoiMesh], unit: str) -> None:
    """Round-off between them would fill the colours, and small cells have their areas in square metres."""
    mesh = make()
    area, sigma, _ = content_of(page_of(mesh))["fields"]
    assert area["units"] == unit
    [pane] = area["panes"]
    metres = 1e6 if unit == "km²" else 1.0
    assert pane["low"] == pane["high"] == pytest.approx(mesh.area_cell[0] / metres, rel=1e-12)
    assert sigma["panes"][0]["low"] == sigma["panes"][0]["high"] == pytest.approx(1.0)


def test_areas_on_the_unit_sphere_are_solid_angles(icosahedral_mesh: VoronoiMesh) -> None:
    assert icosahedral_mesh.sphere_radius == 1.0
    assert content_of(page_of(icosahedral_mesh))["fields"][0]["units"] == "sr"


def test_two_runs_on_a_plane(plane_run: Path, mountain_run: Path, tmp_path: Path) -> None:
    run = open_run(plane_run)
    assert len(content_of(page_of(run, open_run(plane_run)))["panes"]) == 3
    moved = Path(shutil.copytree(plane_run, tmp_path / "moved"))
    with netCDF4.Dataset(moved / "mesh.nc", "a") as file:
        for name in ("xCell", "xEdge", "xVertex"):
            file[name][:] += 1e3
    with pytest.raises(InputError, match="different meshes"):
        page_of(run, open_run(moved))
    with pytest.raises(InputError, match="different meshes"):
        page_of(run, open_run(mountain_run))


def test_a_page_never_replaces_a_file_of_a_run(mountain_run: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(mountain_run, tmp_path / "run"))
    before = (folder / "history.nc").read_bytes()
    run = open_run(folder)
    with pytest.raises(InputError, match=r"history\.nc is no page for a browser; end its name in .html"):
        view_page(run, folder / "history.nc")
    with pytest.raises(InputError, match=r"end its name in \.html"):
        run.view(fields=["thickness"]).save(folder / "history.nc")
    assert (folder / "history.nc").read_bytes() == before


def test_the_page_is_one_file(mountain_run: Path, tmp_path: Path) -> None:
    path = view_page(open_run(mountain_run), tmp_path / "page.html")
    page = path.read_text()
    assert path.stat().st_size < BYTES_OF_A_MEGABYTE
    assert not re.search(r"(src|href)=|@import|url\(", page.split('<script type="application/json"')[0])
    assert page.count("</script") == 2
    assert [each.name for each in tmp_path.iterdir()] == ["page.html"]


def test_the_program_is_small_and_tells_its_licence() -> None:
    program = (files("postprocess.view") / "page" / "page.js").read_text()
    assert len(program) < BYTES_OF_A_MEGABYTE
    assert "Permission is hereby granted, free of charge" in program
    assert "Copyright © 2010-2026 three.js authors" in program

"""What pages hold, without a browser."""

import json
import re
import shutil
from importlib.resources import files
from pathlib import Path

import netCDF4
import numpy as np
import pytest

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

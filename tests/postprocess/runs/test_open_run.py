"""`open_run`: what it gives, when it reads, and how it refuses."""

import json
import shutil
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import trisk
from mesh import VoronoiMesh
from postprocess.runs import reading
from swe.diagnostics.outputs import FIELDS
from swe.errors import InputError

xarray = pytest.importorskip("xarray")


def test_data_diagnostics_mesh_and_record(mountain_run: Path) -> None:
    with trisk.open_run(mountain_run) as run:
        with netCDF4.Dataset(mountain_run / "history.nc") as file:
            np.testing.assert_array_equal(run.data["thickness"].values, file["thickness"][:])
        assert isinstance(run.diagnostics, xarray.Dataset)
        np.testing.assert_array_equal(run.diagnostics["mass"], run.series["mass"])
        assert run.mesh.n_cells == run.data.sizes["nCells"] == 162
        assert run.record == json.loads((mountain_run / "run.json").read_text())
        assert run.data["thickness"].sel(Time="2000-01-01T06").sizes["nCells"] == 162


def test_values_are_read_when_they_are_asked_for(mountain_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("read too early")

    monkeypatch.setattr(reading, "read_mesh", refuse)
    monkeypatch.setattr(reading, "read_series", refuse)
    monkeypatch.setitem(sys.modules, "xarray", None)
    run = trisk.open_run(mountain_run)
    assert run.cells == 162
    assert repr(run)
    monkeypatch.undo()
    assert not run.data["thickness"].variable._in_memory
    assert run.data["thickness"].isel(Time=0).values.shape == (162,)


def test_files_are_closed_with_the_run_and_opened_again(mountain_run: Path) -> None:
    run = trisk.open_run(mountain_run)
    first = run.data
    assert run.data is first
    closed: list[str] = []
    run.data.set_close(lambda: closed.append("data"))
    run.diagnostics.set_close(lambda: closed.append("diagnostics"))
    with run:
        assert not closed
    assert closed == ["data", "diagnostics"]
    assert run.data is not first
    assert run.data["thickness"].isel(Time=-1).values.min() > 0.0
    run.close()
    run.close()


def test_a_run_shows_itself_in_a_few_lines(mountain_run: Path) -> None:
    run = trisk.open_run(mountain_run)
    assert repr(run).splitlines() == [
        "<Run of williamson5",
        f"  folder: {mountain_run}",
        "  status: completed, day 0.5 of 0.5",
        "  mesh: 162 cells on a sphere of radius 6371.22 km",
        "  scheme: ringler2010",
        "  integrator: rk4",
        f"  step: {run.time_step:g} s, {run.steps} steps",
        "  snapshots: 3, days 0, 0.25, 0.5",
        f"  fields: {', '.join(FIELDS)}>",
    ]
    title, *rows = repr(run.snapshot(0.25)).splitlines()
    assert title == "<Snapshot of day 0.25"
    assert len(rows) == len(FIELDS)
    thickness = run.snapshot(0.25).fields["thickness"]
    assert rows[0] == f"  thickness: {thickness.min():g} to {thickness.max():g} m"


def test_a_run_at_a_coast_shows_the_share_of_the_sea(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    sea = trisk.cull_mesh(small_mesh, "0,360,-90,20")
    trisk.Simulation(sea, trisk.LakeAtRest(), tmp_path / "run").run(days=0.1, progress=False)
    run = trisk.open_run(tmp_path / "run")
    share = 100.0 * sea.area_cell.sum() / (4.0 * np.pi)
    assert 50.0 < share < 75.0
    assert f"coast: the sea covers {share:.3g} % of the sphere\n" in repr(run)
    (tmp_path / "run" / "mesh.nc").write_bytes(b"nothing")
    assert "coast:" not in repr(trisk.open_run(tmp_path / "run"))


@pytest.mark.parametrize(("name", "place"), [("data", "history.nc"), ("diagnostics", "diagnostics.nc")])
def test_without_xarray_a_sentence_names_the_command(
    mountain_run: Path, monkeypatch: pytest.MonkeyPatch, name: str, place: str
) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    run = trisk.open_run(mountain_run)
    with pytest.raises(InputError, match=rf"{place} .* xarray, .*; install it with pip install 'trisk\[xarray\]'$"):
        getattr(run, name)


def copied(run: Path, to: Path) -> Path:
    return Path(shutil.copytree(run, to / "run"))


def test_no_folder_and_no_run(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none holds no readable run \(there is no such folder\); name a directory"):
        trisk.open_run(tmp_path / "none")
    with pytest.raises(InputError, match=r"holds no readable run .*run\.json.*; name a directory that a run wrote"):
        trisk.open_run(tmp_path)


@pytest.mark.parametrize("name", ["run.json", "history.nc"])
def test_a_file_that_cannot_be_read(mountain_run: Path, tmp_path: Path, name: str) -> None:
    run = copied(mountain_run, tmp_path)
    (run / name).write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"holds no readable run \(.*\); name a directory that a run wrote"):
        trisk.open_run(run)


def test_diagnostics_that_cannot_be_read(mountain_run: Path, tmp_path: Path) -> None:
    run = trisk.open_run(copied(mountain_run, tmp_path))
    (run.directory / "diagnostics.nc").write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"diagnostics\.nc cannot be read \(.*\); name a directory that a run wrote"):
        _ = run.diagnostics
    with pytest.raises(InputError, match="holds no readable run"):
        _ = run.series


def test_a_run_without_snapshots(mountain_run: Path, tmp_path: Path) -> None:
    run = copied(mountain_run, tmp_path)
    content = bytearray((run / "history.nc").read_bytes())
    content[4:8] = bytes(4)  # the number of rows
    (run / "history.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"history\.nc has no rows; the run was killed at its start, run it again"):
        trisk.open_run(run)


def test_a_day_without_a_snapshot(mountain_run: Path) -> None:
    with pytest.raises(InputError, match=r"has no snapshot of day 3; its days are 0, 0\.25, 0\.5"):
        trisk.open_run(mountain_run).snapshot(3.0)


def test_a_snapshot_that_has_gone_is_told(mountain_run: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(mountain_run, tmp_path / "run"))
    run = trisk.open_run(folder)
    (folder / "history.nc").unlink()
    for read in (run.last_snapshot, lambda: run.field("thickness", 0)):
        with pytest.raises(
            InputError, match=r"holds no readable run .*No such file.*; name a directory that a run wrote"
        ):
            read()

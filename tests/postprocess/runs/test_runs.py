"""Run directories: what is read of them, and how damaged ones are refused."""

import json
import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from cases import Williamson2
from mesh import MeshError, scvt_mesh
from postprocess.runs.reading import days_in_words, read_run
from swe import Simulation
from swe.errors import InputError


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    Simulation(scvt_mesh(42), Williamson2(), tmp_path / "run", time_step=1800.0).run(0.25, progress=False)
    return tmp_path / "run"


def test_time_step_and_number_of_steps(directory: Path) -> None:
    run = read_run(directory)
    assert (run.time_step, run.steps) == (1800.0, 12)


@pytest.mark.parametrize("content", [b"\x89HDF\xff\xfe", b"[]", b"3", b"{}", b'{"parameters": []}', b"{", b""])
def test_record_that_is_none_is_refused(directory: Path, content: bytes) -> None:
    (directory / "run.json").write_bytes(content)
    with pytest.raises(InputError, match=r"run holds no readable run .*; name a directory that a run wrote"):
        read_run(directory)


def test_record_without_numbers_is_refused(directory: Path) -> None:
    record = json.loads((directory / "run.json").read_text())
    (directory / "run.json").write_text(json.dumps({**record, "steps": "many"}))
    with pytest.raises(InputError, match="holds no readable run"):
        read_run(directory)


def test_mesh_of_another_run_is_refused(directory: Path, tmp_path: Path) -> None:
    Simulation(scvt_mesh(162), Williamson2(), tmp_path / "other").run(0.25, progress=False)
    shutil.copy(tmp_path / "other" / "mesh.nc", directory / "mesh.nc")
    with pytest.raises(InputError, match=r"history\.nc has 42 values of thickness, but mesh\.nc beside it needs 162;"):
        read_run(directory)


def test_mesh_that_is_none_is_told_as_such(directory: Path) -> None:
    (directory / "mesh.nc").write_text("nothing")
    with pytest.raises(MeshError, match=r"mesh\.nc: not a readable NetCDF file"):
        read_run(directory)


def test_a_field_is_read_and_checked_alone(directory: Path) -> None:
    run = read_run(directory)
    with netCDF4.Dataset(directory / "history.nc", "a") as file:
        np.testing.assert_array_equal(run.field("thickness", 1), file["thickness"][1])
        file["kinetic_energy"][1, 7] = np.nan
    assert run.field("thickness", 1).shape == (42,)
    with pytest.raises(InputError, match=r"history\.nc has non-finite kinetic_energy on day"):
        run.field("kinetic_energy", 1)
    with netCDF4.Dataset(directory / "history.nc", "a") as file:
        file["thickness"][1, 7] = 0.0
    with pytest.raises(InputError, match=r"history\.nc has non-positive thickness on day"):
        run.field("thickness", 1)
    with pytest.raises(InputError, match=r"history\.nc holds no vorticity"):
        run.field("vorticity", 1)


@pytest.mark.parametrize(
    ("days", "words"),
    [
        ([], ""),
        ([0.5], "0.5"),
        (range(8), "0, 1, 2, 3, 4, 5, 6, 7"),
        (range(9), "0, 1, 2, ..., 8"),
        (range(50), "0, 1, 2, ..., 49"),
    ],
)
def test_long_lists_of_days_are_shortened(days: list[float], words: str) -> None:
    assert days_in_words(days) == words

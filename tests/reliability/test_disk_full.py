"""A disk that fills up: a sentence, everything that was complete stays readable, and the run goes on afterwards."""

import json
import shlex
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from swe.output.files import read_series

BLOCK = 1024
"""Bytes of a block of the shell's limit of file sizes."""


def run(mesh: Path, directory: Path, limit: int | None, *more: str) -> subprocess.CompletedProcess[str]:
    """Two days of test case 5, where no file may have more than `limit` bytes."""
    command = [
        *(sys.executable, "-m", "trisk", "run", "williamson5", "--mesh", str(mesh), "-o", str(directory), "-q"),
        *("--days", "2", "--snapshot-hours", "1", "--diagnostics-hours", "0.25", "--checkpoint-hours", "3", *more),
    ]
    bound = "" if limit is None else f"ulimit -f {limit // BLOCK}; "
    return subprocess.run(["bash", "-c", f"{bound}exec {shlex.join(command)}"], capture_output=True, text=True)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A mesh, and a run on it that had all the room it wanted."""
    folder = tmp_path_factory.mktemp("whole")
    mesh = folder / "mesh.nc"
    subprocess.run([sys.executable, "-m", "trisk", "mesh", "--cells", "162", "-o", str(mesh), "-q"], check=True)
    assert run(mesh, folder / "run", None).returncode == 0
    return mesh, folder / "run"


@pytest.mark.slow
def test_history_that_finds_no_room(whole: tuple[Path, Path], tmp_path: Path) -> None:
    mesh, complete = whole
    size = (complete / "history.nc").stat().st_size
    done = run(mesh, tmp_path / "run", 2 * size // 3)
    assert done.returncode == 1
    assert "history.nc cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["status"] == "failed"
    with (
        netCDF4.Dataset(tmp_path / "run" / "history.nc") as found,
        netCDF4.Dataset(complete / "history.nc") as expected,
    ):
        rows = len(found["time"])
        assert 10 < rows < len(expected["time"])
        for name in ("time", "thickness", "normal_velocity"):
            np.testing.assert_array_equal(found[name][: rows - 1], expected[name][: rows - 1])
    rows = len(read_series(tmp_path / "run" / "diagnostics.nc")["time"])
    assert rows > 4 * 10
    again = run(mesh, tmp_path / "run", None, "--resume")
    assert again.returncode == 0, again.stderr
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "run" / name).read_bytes() == (complete / name).read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("blocks", [1, 45, 100])
def test_any_file_that_finds_no_room(whole: tuple[Path, Path], tmp_path: Path, blocks: int) -> None:
    """From the record of the run, the smallest, over diagnostics, checkpoints and mesh to the history."""
    mesh, complete = whole
    done = run(mesh, tmp_path / "run", blocks * BLOCK)
    assert done.returncode == 1, done.stderr
    assert "cannot be written" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    again = run(mesh, tmp_path / "run", None, "--resume")
    assert again.returncode == 0, again.stderr
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "run" / name).read_bytes() == (complete / name).read_bytes()

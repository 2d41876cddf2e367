"""Stopping a run and going on with it, from the command line."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mesh import VoronoiMesh, write_mesh


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


@pytest.mark.parametrize("number", [pytest.param(signal.SIGTERM, marks=pytest.mark.slow), signal.SIGINT])
def test_a_signal_leaves_a_checkpoint_and_resume_goes_on(
    trisk, mesh_file: Path, tmp_path: Path, number: signal.Signals
) -> None:
    options = ("--days", "100", "--dt", "1200", "--snapshot-hours", "480", "-q")
    command = [sys.executable, "-m", "trisk", "run", "williamson5", "--mesh", str(mesh_file), "-o"]
    run = subprocess.Popen([*command, str(tmp_path / "run"), *options], stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "run" / "diagnostics.nc").exists():
        assert run.poll() is None
        time.sleep(0.01)
    time.sleep(0.2)
    run.send_signal(number)
    _, err = run.communicate()
    assert run.returncode == 128 + number
    assert err.startswith(f"error: stopped by {number.name} at day ")
    assert err.endswith(f"; its checkpoint is in {tmp_path / 'run'}\n")
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["status"] == "interrupted"
    assert 0 < record["steps"] < 100 * 72
    code, _, err = trisk("run", "williamson5", "-o", tmp_path / "run", "--resume", "--cells", 162, *options)
    assert code == 2
    assert "mesh.nc has 642 cells, not 162; give the same options" in err
    code, out, err = trisk("run", "williamson5", "-o", tmp_path / "run", "--resume", *options)
    assert (code, out, err) == (0, "", "")
    assert trisk("run", "williamson5", "--mesh", mesh_file, "-o", tmp_path / "whole", *options)[0] == 0
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_what_cannot_go_on_is_refused_before_a_mesh_is_made(trisk, tmp_path: Path) -> None:
    run = ("run", "williamson5", "--cells", 42, "--days", 0.1, "-o", tmp_path / "run", "-q")
    assert trisk(*run)[0] == 0
    assert trisk(*run, "--resume")[0] == 0
    million = ("run", "williamson5", "--cells", 1_000_002, "--days", 0.1, "-o", tmp_path / "run", "-q")
    begin = time.monotonic()
    for more, words in (
        ((), "holds a run already"),
        (("--resume", "--force"), "either replaced or resumed"),
        (("--resume",), "mesh.nc has 42 cells, not 1000002"),
    ):
        code, _, err = trisk(*million, *more)
        assert code == 2
        assert words in err
    assert time.monotonic() - begin < 5.0
    code, _, err = trisk("run", "williamson5", "-o", tmp_path / "other", "--resume")
    assert code == 2
    assert "give either --mesh FILE or --cells N" in err


def test_runs_that_would_never_end_are_refused(trisk, mesh_file: Path, tmp_path: Path) -> None:
    for option, words in (
        (("--dt", "1e-300"), "the time step is 1e-300 s, of which 1 days would have"),
        (("--days", "1e300"), "s, of which 1e+300 days would have"),
        (("--snapshot-hours", "1e-12"), "the snapshot interval is 3.6e-09 s"),
        (("--checkpoint-hours", "1e-12"), "the checkpoint interval is 3.6e-09 s"),
    ):
        code, _, err = trisk(
            *("run", "williamson5", "--mesh", mesh_file, "-o", tmp_path / "run", "-q", "--days", "1"), *option
        )
        assert code == 2
        assert words in err
    assert not (tmp_path / "run").exists()


def test_a_finished_run_is_carried_on(trisk, mesh_file: Path, tmp_path: Path) -> None:
    """Days that the record tells are those of a run that goes on without being told any."""
    run = ("run", "williamson5", "--dt", 1100, "-q", "-o")
    assert trisk(*run, tmp_path / "whole", "--mesh", mesh_file, "--days", 2) == (0, "", "")
    assert trisk(*run, tmp_path / "parts", "--mesh", mesh_file, "--days", 1) == (0, "", "")
    before = (tmp_path / "parts" / "history.nc").read_bytes()
    assert trisk(*run, tmp_path / "parts", "--resume") == (0, "", "")
    assert (tmp_path / "parts" / "history.nc").read_bytes() == before
    assert trisk(*run, tmp_path / "parts", "--resume", "--days", 2) == (0, "", "")
    for name in ("history.nc", "diagnostics.nc", "checkpoint.0000000160.npz"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    record = json.loads((tmp_path / "parts" / "run.json").read_text())
    assert (record["status"], record["days"], record["day_reached"], record["steps"]) == ("completed", 2.0, 2.0, 160)
    code, _, err = trisk(*run, tmp_path / "parts", "--resume", "--days", 1.5)
    assert code == 2
    assert err == "error: the run stands at day 2 and cannot go to day 1.5; give a later day\n"

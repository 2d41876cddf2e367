"""Outputs that are full or closed, and names of files that are no text, from the command line."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mesh import VoronoiMesh, read_mesh, write_mesh

COMMAND = [sys.executable, "-m", "trisk"]


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
@pytest.mark.parametrize(
    "command", [["quality"], pytest.param(["quality", "--json"], marks=pytest.mark.slow), ["--help"]]
)
def test_a_full_output(mesh_file: Path, command: list[str]) -> None:
    arguments = command if command == ["--help"] else [*command, str(mesh_file)]
    with open("/dev/full", "w") as full:
        done = subprocess.run([*COMMAND, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == 1
        told = "error: the output cannot be written (No space left on device); send it elsewhere, or make room\n"
        assert done.stderr == told
        assert subprocess.run([*COMMAND, "quality", "none.nc"], stderr=full).returncode == 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
def test_a_full_error_output_does_not_stop_the_work(tmp_path: Path) -> None:
    """The bar of progress is drawn there."""
    with open("/dev/full", "w") as full:
        done = subprocess.run([*COMMAND, "mesh", "--cells", "42", "-o", tmp_path / "new.nc"], stderr=full)
    assert done.returncode == 0
    assert read_mesh(tmp_path / "new.nc").n_cells == 42


def test_a_closed_pipe_ends_quietly(mesh_file: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([*COMMAND, "quality", str(mesh_file)], stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, b"")


@pytest.mark.slow
def test_names_that_are_no_text(mesh_file: Path, tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/run_\xff"
    run = [*COMMAND, "run", "williamson2", "--mesh", mesh_file, "--days", "0.1", "-q", "-o", name]
    for command in (run, [*COMMAND, "compare", name], [*COMMAND, "plot", name]):
        done = subprocess.run(command, capture_output=True)
        assert (done.returncode, done.stderr) == (0, b"")
    missing = subprocess.run([*COMMAND, "quality", name + b".nc"], capture_output=True, text=True)
    assert missing.returncode == 2
    assert missing.stderr.endswith("run_\\udcff.nc: no such file; give an MPAS mesh file\n")


def test_a_run_behind_a_link_that_leads_to_nothing_yet(mesh_file: Path, tmp_path: Path) -> None:
    link, target = tmp_path / "link", tmp_path / "target"
    link.symlink_to(target)
    run = [*COMMAND, "run", "williamson2", "--mesh", mesh_file, "--days", "0.05", "-q", "-o", link]
    assert subprocess.run(run).returncode == 0
    assert link.is_symlink()
    assert (target / "run.json").is_file()


def test_a_threading_layer_that_is_not_there(mesh_file: Path) -> None:
    if importlib.util.find_spec("tbb") is not None:
        pytest.skip("it is there")
    done = subprocess.run(
        [*COMMAND, "quality", str(mesh_file)],
        env={**os.environ, "NUMBA_THREADING_LAYER": "tbb"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: No threading layer could be loaded.")
    assert len(done.stderr.strip().splitlines()) <= 2

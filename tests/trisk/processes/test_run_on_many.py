"""`mpiexec -n N trisk run`: the files of a run on one process, byte for byte, and one end for all processes."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mesh import VoronoiMesh, read_mesh, write_mesh
from mesh.files.io import mesh_hash
from mesh.parts.culling import culled
from tests.conftest import random_mesh
from tests.under_mpiexec import Started, needs_mpi, on_processes, wait_until

pytestmark = needs_mpi

COMMAND: list[object] = [sys.executable, "-m", "trisk"]
ALL_TERMS = ["--scheme", "consistent", "--integrator", "rrk4", "--apvm", "0.5", "--dissipation", "1e15"]
FILES = ("history.nc", "diagnostics.nc")


@pytest.fixture(scope="module")
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mesh") / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    return path


def run(mesh: Path, output: Path, *options: object, case: str = "williamson5") -> list[object]:
    return [*COMMAND, "run", case, "--mesh", mesh, "-o", output, "-q", *options]


def serially(command: list[object]) -> None:
    subprocess.run([*map(str, command)], check=True, env={**os.environ, "NUMBA_NUM_THREADS": "2"})


def record_of(directory: Path) -> dict[str, object]:
    record: dict[str, object] = json.loads((directory / "run.json").read_text())
    for name in ("wall_seconds", "threads", "processes"):
        del record[name]
    return record


def require_same(mine: Path, theirs: Path) -> None:
    for name in FILES:
        assert (mine / name).read_bytes() == (theirs / name).read_bytes(), name
    assert record_of(mine) == record_of(theirs)
    checkpoints = [sorted(path.name for path in each.glob("checkpoint*")) for each in (mine, theirs)]
    assert checkpoints[0] == checkpoints[1]
    for name in checkpoints[0]:
        assert (mine / name).read_bytes() == (theirs / name).read_bytes(), name
    assert mesh_hash(read_mesh(mine / "mesh.nc")) == mesh_hash(read_mesh(theirs / "mesh.nc"))


def test_files_are_those_of_one_process(mesh_file: Path, tmp_path: Path) -> None:
    """Begun on three processes and resumed on two, with the error of a run that is there in between."""
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    serially(run(mesh_file, whole, "--days", 1))
    assert on_processes(3, run(mesh_file, parts, "--days", 0.5)) == (0, "")
    code, said = on_processes(2, run(mesh_file, parts, "--days", 1))
    assert code == 2
    assert said.count("error:") == 1
    assert said.startswith(f"error: {parts} holds a run already")
    resumed = [*COMMAND, "run", "williamson5", "-o", parts, "--resume", "--days", 1]
    code, said = on_processes(2, resumed)
    assert code == 0
    assert "cells, processes, threads of each" in said
    require_same(parts, whole)


@pytest.mark.parametrize(
    ("processes", "options"),
    [(2, []), pytest.param(3, ALL_TERMS, marks=pytest.mark.slow)],
    ids=["two", "three with all terms"],
)
def test_files_of_a_run_between_walls(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, processes: int, options: list[object]
) -> None:
    """Two seas and an island: walls stand within parts, and the rims of parts beside them."""
    kept = np.abs(icosahedral_mesh.lat_cell - 0.6) > 0.1
    kept[np.argmin(icosahedral_mesh.lat_cell)] = False
    write_mesh(culled(icosahedral_mesh, kept), tmp_path / "sea.nc")
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    serially(run(tmp_path / "sea.nc", whole, "--days", 0.5, *options))
    assert on_processes(processes, run(tmp_path / "sea.nc", parts, "--days", 0.5, *options)) == (0, "")
    require_same(parts, whole)


@pytest.mark.slow
@pytest.mark.parametrize("processes", [2, 3, 5])
def test_files_of_other_runs(mesh_file: Path, tmp_path: Path, processes: int) -> None:
    """All terms, on files that trisk has and has not validated, resumed on one process."""
    unknown = tmp_path / "unknown.nc"
    write_mesh(random_mesh(700, seed=4), unknown)
    for number, (mesh, options) in enumerate([(mesh_file, ALL_TERMS), (unknown, ["--integrator", "fbrk3"])]):
        whole, parts = tmp_path / f"whole{number}", tmp_path / f"parts{number}"
        serially(run(mesh, whole, "--days", 0.5, *options))
        assert on_processes(processes, run(mesh, parts, "--days", 0.25, *options))[0] == 0
        serially(run(mesh, parts, "--days", 0.5, "--resume", *options))
        require_same(parts, whole)


@pytest.mark.slow
def test_a_mesh_is_made_once(mesh_file: Path, tmp_path: Path) -> None:
    parts, whole = tmp_path / "parts", tmp_path / "whole"
    command = [*COMMAND, "run", "williamson5", "--cells", 642, "--days", 0.25, "-q", "-o"]
    serially([*command, whole])
    assert on_processes(2, [*command, parts]) == (0, "")
    require_same(parts, whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["parts", "whole"], "no other file is left"


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("one", [False, True])
def test_a_signal_to_one_or_all_stops_them(mesh_file: Path, tmp_path: Path, number: signal.Signals, one: bool) -> None:
    directory = tmp_path / "run"
    with Started(2, run(mesh_file, directory, "--days", 9999, "--checkpoint-hours", 240)) as started:
        wait_until(lambda: bool(list(directory.glob("checkpoint*"))))
        os.kill(started.workers()[-1] if one else started.program.pid, number)
        code, said = started.end()
    assert code == 128 + number
    assert said.count(f"error: stopped by {number.name} at day ") == 1
    assert json.loads((directory / "run.json").read_text())["status"] == "interrupted"


@pytest.mark.slow
def test_a_killed_process_ends_all_and_the_run_goes_on(mesh_file: Path, tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    days = ["--days", 60]
    serially(run(mesh_file, whole, *days))
    with Started(3, run(mesh_file, parts, *days)) as started:
        wait_until(lambda: len(list(parts.glob("checkpoint*"))) > 1)
        os.kill(started.workers()[1], signal.SIGKILL)
        code, _ = started.end(timeout=20.0)
    assert code != 0
    assert json.loads((parts / "run.json").read_text())["status"] == "running"
    assert on_processes(2, run(mesh_file, parts, *days, "--resume"))[0] == 0
    require_same(parts, whole)


@pytest.mark.slow
def test_what_goes_wrong_is_said_once(mesh_file: Path, tmp_path: Path) -> None:
    unsound = run(mesh_file, tmp_path / "unsound", "--days", 5, "--dt", 20000)
    code, said = on_processes(3, unsound)
    assert code == 1
    assert said.count("the thickness is ") == 1
    assert "Traceback" not in said
    serial = subprocess.run(
        [*map(str, run(mesh_file, tmp_path / "serial", *unsound[-4:]))], capture_output=True, text=True
    )
    assert said.split(" cell ")[0] == serial.stderr.split(" cell ")[0]
    assert on_processes(2, [*COMMAND, "mesh", "--cells", 42, "-o", tmp_path / "m.nc"]) == (
        2,
        "error: trisk mesh works in one process; start it without mpiexec\n",
    )
    one, other = (run(mesh_file, tmp_path / "other", "--days", days) for days in (1, 2))
    assert on_processes(1, [*one, ":", "-n", 1, *other]) == (
        2,
        "error: the processes were started with different arguments; give all of them the same\n",
    )
    small = tmp_path / "small.nc"
    subprocess.run([*map(str, COMMAND), "mesh", "--cells", "42", "-o", str(small), "-q"], check=True)
    assert on_processes(6, run(small, tmp_path / "small")) == (
        2,
        "error: 6 processes are too many for a mesh of 42 cells; start 5 at most\n",
    )
    assert not (tmp_path / "other").exists()


@pytest.mark.slow
def test_without_mpi4py_it_is_asked_for(mesh_file: Path, tmp_path: Path) -> None:
    (tmp_path / "mpi4py").mkdir()
    (tmp_path / "mpi4py/__init__.py").write_text("raise ImportError")
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).parents[3])])
    code, said = on_processes(2, run(mesh_file, tmp_path / "run"), {"PYTHONPATH": path})
    assert code == 2
    assert (
        said.count("error: mpiexec started 2 processes, but they cannot speak with each other, as mpi4py is not") == 1
    )


CASE = """
from dataclasses import dataclass
import numpy as np
from cases import Williamson2

@dataclass(frozen=True)
class Uneven(Williamson2):
    name = "uneven"
    def thickness(self, longitude, latitude, time=0.0):
        h = super().thickness(longitude, latitude, time)
        return h - h.mean() + 3000.0
    def {function}
"""


@pytest.mark.slow
def test_cases_that_look_at_the_whole_mesh_are_refused(mesh_file: Path, tmp_path: Path) -> None:
    """And one that fails on one process only, while the others wait, ends all of them."""
    file = tmp_path / "uneven.py"
    file.write_text(CASE.format(function="unused(self): pass"))
    code, said = on_processes(2, run(mesh_file, tmp_path / "run", case=f"{file}:Uneven"))
    assert code == 2
    assert "Uneven depends on the part of the mesh that it is asked for; let it follow from the place alone" in said
    assert said.count("error:") == 1
    file.write_text(
        CASE.format(
            function="parameters(self):\n        from mpi4py import MPI\n        if MPI.COMM_WORLD.rank == 1:\n"
            "            raise ValueError('only here')\n        return super().parameters()"
        ).replace("h - h.mean() + 3000.0", "h")
    )
    code, said = on_processes(2, run(mesh_file, tmp_path / "run", case=f"{file}:Uneven"))
    assert code == 2
    assert said.count("ValueError('only here')") == 1
    assert "Traceback" not in said


@pytest.mark.slow
def test_the_program_of_the_page_runs(mesh_file: Path, tmp_path: Path) -> None:
    page = (Path(__file__).parents[3] / "docs/processes.md").read_text()
    program = page.split("## In Python")[1].split("    # mpiexec")[1].split("Arrays of the state")[0]
    (tmp_path / "program.py").write_text("# mpiexec" + program.replace("\n    ", "\n"))
    shutil.copy(mesh_file, tmp_path / "mesh.nc")
    command = [sys.executable, "-c", f"import os; os.chdir({str(tmp_path)!r}); exec(open('program.py').read())"]
    code, said = on_processes(2, command)
    assert code == 0, said
    serially(run(mesh_file, tmp_path / "serial", "--days", 1))
    require_same(tmp_path / "run", tmp_path / "serial")

"""`mpiexec -n N trisk run` on planes: cases with forcing, walls and streamfunctions have the files of one process."""

import sys
from pathlib import Path

import numpy as np
import pytest

from mesh import hexagon_mesh, write_mesh
from tests.trisk.conftest import Call
from tests.under_mpiexec import needs_mpi, on_processes

RUN = ("--days", 0.1, "--snapshot-hours", 1.2, "--diagnostics-hours", 1.2, "--quiet")
ROW = 0.5 * np.sqrt(3.0)


@needs_mpi
@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "length", "periodic", "processes"),
    [
        ("manufactured", 1e6, "xy", 2),
        ("stommel-box", 1e6, "none", 3),
        ("munk-box", 1e6, "none", 2),
        ("dual-vortex", 5e6, "xy", 2),
    ],
)
def test_files_are_those_of_one_process(
    trisk: Call, tmp_path: Path, case: str, length: float, periodic: str, processes: int
) -> None:
    plane = tmp_path / "plane.nc"
    write_mesh(hexagon_mesh((length, length * ROW), (12, 12), periodic), plane)
    assert trisk("run", case, "--mesh", plane, *RUN, "-o", tmp_path / "one") == (0, "", "")
    command = [sys.executable, "-m", "trisk", "run", case, "--mesh", plane, *RUN, "-o", tmp_path / "many"]
    code, output = on_processes(processes, command)
    assert code == 0, output
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "many" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()

"""A few kills; `python tests/reliability/kill_runs.py 20` makes as many as one likes."""

import random
import subprocess
import sys
from pathlib import Path

import pytest
from kill_runs import kill_and_resume, time_of_run

pytestmark = pytest.mark.slow


def test_killed_runs_go_on_to_equal_files(tmp_path: Path) -> None:
    mesh = tmp_path / "mesh.nc"
    subprocess.run([sys.executable, "-m", "trisk", "mesh", "--cells", "642", "-o", str(mesh), "-q"], check=True)
    seconds = time_of_run(mesh, tmp_path / "whole")
    kills = kill_and_resume(mesh, tmp_path / "whole", tmp_path / "killed", seconds, random.Random(5))
    assert kills

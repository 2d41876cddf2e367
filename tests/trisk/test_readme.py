"""The Python of README runs as it stands."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

README = Path(__file__).parents[2] / "README.md"
BLOCK = re.compile(r"(?:^    .*\n|^\n(?=    ))+", re.MULTILINE)


def programs() -> list[str]:
    """Indented blocks that begin with an import."""
    blocks = (re.sub("^    ", "", block, flags=re.MULTILINE).strip() for block in BLOCK.findall(README.read_text()))
    return [block for block in blocks if block.startswith(("import ", "from "))]


def test_programs_are_found_and_the_first_has_six_lines() -> None:
    first, *others = programs()
    assert first.startswith("import trisk\n")
    assert len([line for line in first.splitlines() if line.strip()]) == 6
    assert others


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the first program ran, so that the others find its run."""
    where = tmp_path_factory.mktemp("readme")
    done = subprocess.run([sys.executable, "-c", programs()[0]], cwd=where, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Invariants(mass=")
    return where


@pytest.mark.slow
@pytest.mark.parametrize("number", range(1, len(programs())))
def test_the_other_programs_run(folder: Path, number: int) -> None:
    program = programs()[number]
    for name in re.findall(r"^import (\w+)", program, flags=re.MULTILINE):
        if importlib.util.find_spec(name) is None:
            pytest.skip(f"{name} is not installed")
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_the_budget_of_the_wind_is_in_the_diagnostics(folder: Path) -> None:
    """The case of the user's own, in fifteen lines at most, leaves the rates of its term."""
    (program,) = [program for program in programs() if "Forcing" in program]
    assert len([line for line in program.splitlines() if line.strip()]) <= 15
    if not (folder / "windy").exists():
        subprocess.run([sys.executable, "-c", program], cwd=folder, check=True, capture_output=True)
    with netCDF4.Dataset(folder / "windy" / "diagnostics.nc") as file:
        assert np.all(file["total_energy_rate_wind"][1:] > 0.0)
        assert file["total_energy_rate_wind"].units == "m5 s-3"
        assert file["absolute_vorticity_rate_wind"].long_name == "rate of absolute vorticity by wind"


def test_ten_lines_from_nothing_to_the_difference_of_two_runs(tmp_path: Path) -> None:
    """As they stand, but for smaller meshes and shorter runs."""
    pytest.importorskip("xarray")
    (program,) = [program for program in programs() if "difference.png" in program]
    assert len([line for line in program.splitlines() if line.strip()]) <= 10
    small = program.replace("cells=2562", "cells=162").replace("days=5", "days=1").replace("day=5", "day=1")
    assert "2562" not in small
    done = subprocess.run([sys.executable, "-c", small], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "difference.png").read_bytes().startswith(b"\x89PNG")

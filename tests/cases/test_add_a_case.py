"""A case is added as `docs/extending.md` says: a dataclass in a file, which runs as any other."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cases import find_case
from mesh import VoronoiMesh
from swe import Simulation
from swe.output.files import read_series

FILE = '''
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases import Case, parameter


@dataclass(frozen=True)
class Vortex(Case):
    """A vortex over the pole, its surface level."""

    title: ClassVar[str] = "Vortex over the pole"
    recommended_days: ClassVar[float] = 2.0

    depth: float = parameter(5000.0, "m", "Depth of the fluid")
    wind_speed: float = parameter(20.0, "m/s", "Speed of the wind at 45 degrees")

    def thickness(self, longitude, latitude, time=0.0):
        return self.depth

    def streamfunction(self, longitude, latitude, time=0.0):
        return -self.radius * self.wind_speed * np.sin(latitude) ** 2
'''
HOUR = 1.0 / 24.0


FORCED = (
    FILE.replace("class Vortex(Case)", "class Forced(Case)").replace(
        "from cases import Case, parameter", "from cases import Case, parameter\nfrom swe import Forcing, LinearDrag"
    )
    + '''
    def terms(self):
        return LinearDrag(1e-5), Forcing("tide", acceleration=tide, source=rain)


def tide(mesh, state, time):
    """Towards the moon, whatever the state."""
    return 1e-5 * np.cos(mesh.angle_edge) * np.sin(2.0 * mesh.lon_edge - 1.4e-4 * time)


def rain(mesh, state, time):
    return 1e-6
'''
)


@pytest.fixture
def address(tmp_path: Path) -> str:
    """The file with the case, and the name of the class."""
    path = tmp_path / "vortex.py"
    path.write_text(FILE)
    return f"{path}:Vortex"


def test_an_added_case_runs_for_an_hour(address: str, icosahedral_mesh: VoronoiMesh) -> None:
    case = find_case(address, {"wind_speed": "30"})
    assert case.name == address
    simulation = Simulation(icosahedral_mesh, case)
    speed = np.abs(simulation.state.normal_velocity).max()
    assert speed == pytest.approx(30.0, rel=0.1)
    simulation.run(days=HOUR, progress=False)
    assert simulation.time == 3600.0
    assert np.ptp(simulation.state.thickness) > 1.0  # the level surface does not balance the wind
    assert abs(simulation.invariants.mass / Simulation(icosahedral_mesh, case).invariants.mass - 1.0) < 1e-14


def test_an_added_case_shows_its_parameters(address: str) -> None:
    command = [sys.executable, "-m", "trisk", "cases", address]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "200"})
    rows = [line.replace("│", " ").split() for line in shown.stdout.splitlines()]
    assert ["depth", "5000", "m", "Depth", "of", "the", "fluid"] in rows
    assert ["wind_speed", "20", "m/s"] in [row[:3] for row in rows]


def test_an_added_case_brings_terms_of_its_own(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Beside ready ones, without touching the package; the diagnostics have the budgets of both."""
    path = tmp_path / "forced.py"
    path.write_text(FORCED)
    simulation = Simulation(icosahedral_mesh, find_case(f"{path}:Forced"), tmp_path / "run", diagnostics_interval=600.0)
    assert [term.name for term in simulation.model.terms] == ["linear_drag", "tide"]
    simulation.run(days=HOUR, progress=False)
    series = read_series(tmp_path / "run" / "diagnostics.nc")
    assert np.all(series["total_energy_rate_linear_drag"] < 0.0)
    assert np.all(series["total_energy_rate_tide"] != 0.0)
    assert series["mass"][-1] - series["mass"][0] == pytest.approx(1e-6 * 3600.0 * simulation.model.area, rel=1e-9)

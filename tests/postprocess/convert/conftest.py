"""A run on a mesh with a coast, and a converter of runs."""

from pathlib import Path

import pytest

from cases import Williamson2
from mesh import VoronoiMesh
from mesh.parts.culling import culled
from swe import Simulation


@pytest.fixture(scope="session")
def sea_run(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of a tenth of a day on the cells south of 30 degrees north."""
    directory = tmp_path_factory.mktemp("convert") / "sea"
    sea = culled(small_mesh, small_mesh.lat_cell < 0.5)
    Simulation(sea, Williamson2(), directory, time_step=1440.0, snapshot_interval=4320.0).run(0.1, progress=False)
    return directory


@pytest.fixture(scope="session", params=["whole", "coast"])
def any_run(request: pytest.FixtureRequest, mountain_run: Path, sea_run: Path) -> Path:
    return mountain_run if request.param == "whole" else sea_run

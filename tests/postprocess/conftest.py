"""Meshes and runs that several tests of this folder share."""

from pathlib import Path

import numpy as np
import pytest

from cases import find_case
from mesh import VoronoiMesh, hexagon_mesh, periodic_mesh, scvt_mesh
from swe import Simulation

LENGTHS = (1e6, 5e5 * np.sqrt(3.0))
"""Of a plane that 12 rows of 12 hexagons fit."""


@pytest.fixture(scope="session")
def refined_mesh() -> VoronoiMesh:
    """Cells three times narrower within 30 degrees of 270 E, 30 N than elsewhere."""
    return scvt_mesh(1000, density="refined-circle", tolerance=1e-3)


@pytest.fixture(scope="session", params=["xy", "x", "none", "random"])
def any_plane(request: pytest.FixtureRequest) -> VoronoiMesh:
    """Hexagons of a periodic plane, a channel and a box, and cells of random generators."""
    if request.param == "random":
        return periodic_mesh(np.random.default_rng(3).random((300, 2)) * LENGTHS, LENGTHS)
    return hexagon_mesh(LENGTHS, (12, 12), request.param)


@pytest.fixture(scope="session")
def periodic_plane() -> VoronoiMesh:
    """Hexagons of a plane that is periodic in both directions."""
    return hexagon_mesh(LENGTHS, (12, 12))


@pytest.fixture(scope="session")
def channel() -> VoronoiMesh:
    """Hexagons of a channel along x."""
    return hexagon_mesh(LENGTHS, (12, 12), "x")


@pytest.fixture(scope="session")
def plane_run(periodic_plane: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of an inertia-gravity wave, with snapshots at the start, in the middle and at the end."""
    return wave_run(periodic_plane, tmp_path_factory.mktemp("plane") / "run")


@pytest.fixture(scope="session")
def finer_plane_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same on a mesh with four times as many cells."""
    return wave_run(hexagon_mesh(LENGTHS, (24, 24)), tmp_path_factory.mktemp("plane") / "finer")


def wave_run(mesh: VoronoiMesh, directory: Path) -> Path:
    simulation = Simulation(
        mesh,
        find_case("inertia-gravity-wave"),
        directory,
        time_step=432.0,
        snapshot_interval=864.0,
        diagnostics_interval=864.0,
    )
    simulation.run(0.02, progress=False)
    return directory

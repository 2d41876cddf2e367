"""Meshes and runs that the tests share, made once a session."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

# Tests of threads want two of them on any machine; numba reads this once, as it is imported.
os.environ["NUMBA_NUM_THREADS"] = str(max(2, os.cpu_count() or 1))

import numpy as np
import pytest

from cases import Williamson1, Williamson2, Williamson5
from mesh import VoronoiMesh, mesh_from_points, scvt_mesh
from swe import Simulation
from swe.integrators import Integrator

MANY_TESTS = 500


def pytest_collection_finish(session: pytest.Session) -> None:
    """Let two workers of many tests begin with other kernels, as neither should compile what the other does."""
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    if worker is None or len(session.items) < MANY_TESTS:
        return
    integrators: tuple[Integrator, ...] = ("rk4", "rrk4") if worker == "gw0" else ("fbrk3", "rfbrk3")
    mesh = scvt_mesh(42) if worker == "gw0" else random_mesh(42, seed=1)
    for integrator in integrators:
        Simulation(mesh, Williamson5(), integrator=integrator).run(days=0.1, progress=False)


def random_mesh(cells: int, seed: int) -> VoronoiMesh:
    """Voronoi mesh of uniformly random points: obtuse triangles, cells with 3 to 11 edges."""
    return mesh_from_points(np.random.default_rng(seed).normal(size=(cells, 3)))


def stretched_mesh(cells: int) -> VoronoiMesh:
    """SCVT moved towards one point, so that cell widths vary by about three."""
    points = scvt_mesh(cells, start="fibonacci", tolerance=1e-6).cell_points
    points = points + np.array([0.3, -0.35, 0.2])
    return mesh_from_points(points)


@pytest.fixture(autouse=True)
def usual_signals() -> Iterator[None]:
    """Signals as in a program in the foreground, for tests and for what they start, however the tests were started."""
    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    before = {number: signal.signal(number, handler) for number, handler in usual.items()}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture(scope="session")
def icosahedral_mesh() -> VoronoiMesh:
    return scvt_mesh(642)


@pytest.fixture(scope="session")
def larger_mesh() -> VoronoiMesh:
    return scvt_mesh(2562)


@pytest.fixture(scope="session", params=["icosahedral", "octahedron-like", "random", "stretched"])
def any_mesh(request: pytest.FixtureRequest, icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    """One mesh of each family; identities must hold on all."""
    if request.param == "icosahedral":
        return icosahedral_mesh
    if request.param == "random":
        return random_mesh(500, seed=1)
    if request.param == "stretched":
        return stretched_mesh(600)
    grid = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float)
    return mesh_from_points(grid)


@pytest.fixture(scope="session")
def small_mesh() -> VoronoiMesh:
    return scvt_mesh(162)


@pytest.fixture(scope="session")
def mountain_run(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of test case 5 on 162 cells: half a day, snapshots and rows every quarter; do not write to."""
    directory = tmp_path_factory.mktemp("values") / "mountain"
    simulation = Simulation(small_mesh, Williamson5(), directory, time_step=1800.0, snapshot_interval=21600.0)
    simulation.run(days=0.5, progress=False)
    return directory


@pytest.fixture(scope="session")
def damped_run(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with anticipation of potential vorticity and with dissipation."""
    directory = tmp_path_factory.mktemp("values") / "damped"
    simulation = Simulation(
        small_mesh,
        Williamson5(),
        directory,
        time_step=1800.0,
        snapshot_interval=21600.0,
        anticipation=0.5,
        dissipation=1e17,
    )
    simulation.run(days=0.5, progress=False)
    return directory


@pytest.fixture(scope="session")
def bell_run(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of test case 1, whose wind is prescribed, on 162 cells for half a day."""
    directory = tmp_path_factory.mktemp("values") / "bell"
    simulation = Simulation(small_mesh, Williamson1(), directory, time_step=1800.0, snapshot_interval=21600.0)
    simulation.run(days=0.5, progress=False)
    return directory


@pytest.fixture(scope="session")
def steady_run(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of test case 2, whose solution is known, on 162 cells for half a day."""
    directory = tmp_path_factory.mktemp("values") / "steady"
    simulation = Simulation(small_mesh, Williamson2(), directory, time_step=1800.0, snapshot_interval=21600.0)
    simulation.run(days=0.5, progress=False)
    return directory

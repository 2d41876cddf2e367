"""Runs on two and three processes have the bits of a run on one: state, derived fields, invariants and rates."""

import json
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mesh import VoronoiMesh
from swe.parallel.exact_sum import exact_sums
from tests.conftest import random_mesh
from tests.cut_mesh import random_sea, without_cap
from tests.swe.parallel.short_run import fields_of, hash_of, row_of, short_run
from tests.under_mpiexec import needs_mpi, on_processes

PROGRAM = Path(__file__).with_name("mpi_program.py")

pytestmark = needs_mpi

CONSISTENT = {"scheme": "consistent", "anticipation": 0.5, "dissipation": 1e15}
QUICK: list[dict[str, Any]] = [{}, {"integrator": "rrk4"}, {"integrator": "fbrk3"}]
SLOW: list[dict[str, Any]] = [
    CONSISTENT,
    {"integrator": "rfbrk3", "dissipation": 1e15},
    {"integrator": "rrk4", "upwinding": 0.5},
    {"integrator": "fbrk3", **CONSISTENT},  # in plain loops
    {"scheme": "consistent", "upwinding": 1.0},
]


def results(count: int, mesh: VoronoiMesh, jobs: list[dict[str, Any]], folder: Path) -> list[dict[str, Any]]:
    """The results of jobs on `count` processes with one thread each."""
    paths = [folder / name for name in ("mesh", "jobs", "results")]
    paths[0].write_bytes(pickle.dumps(mesh))
    paths[1].write_text(json.dumps(jobs))
    code, output = on_processes(count, [sys.executable, "-m", "mpi4py", PROGRAM, *paths])
    assert code == 0, output[-3000:]
    found: list[dict[str, Any]] = json.loads(paths[2].read_text())
    return found


def of_one(mesh: VoronoiMesh, options: dict[str, Any]) -> dict[str, Any]:
    """What the program finds of a run, found by one process."""
    simulation = short_run(mesh, options)
    return {
        "fields": {name: hash_of(values) for name, (_, values) in fields_of(simulation).items()},
        "row": row_of(simulation),
        "steps": simulation.steps,
        "loops": simulation.loops,
    }


def require_same_runs(mesh: VoronoiMesh, processes: int, runs: list[dict[str, Any]], folder: Path) -> None:
    jobs = [{"kind": "run", "options": options, "less": 0} for options in runs]
    for options, found in zip(runs, results(processes, mesh, jobs, folder), strict=True):
        expected = of_one(mesh, options)
        assert {name: found[name] for name in expected} == expected, options
        assert found["sent"] == found["received"] > 0
        assert found["messages"] >= processes
        assert expected["row"]["max_speed"] > 1.0


@pytest.mark.parametrize("processes", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_runs_are_those_of_one_process(icosahedral_mesh: VoronoiMesh, processes: int, tmp_path: Path) -> None:
    require_same_runs(icosahedral_mesh, processes, QUICK, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("processes", [2, 3, 5])
def test_other_runs_are_those_of_one_process(icosahedral_mesh: VoronoiMesh, processes: int, tmp_path: Path) -> None:
    require_same_runs(icosahedral_mesh, processes, SLOW, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["coast", "random"])
def test_runs_on_other_meshes(icosahedral_mesh: VoronoiMesh, kind: str, tmp_path: Path) -> None:
    """A mesh with walls of its own, and one of obtuse triangles and cells with up to 11 edges."""
    mesh = without_cap(icosahedral_mesh) if kind == "coast" else random_mesh(700, seed=4)
    runs = [{}, {"integrator": "rrk4"}, {**CONSISTENT, "dissipation": 1e11}]
    require_same_runs(mesh, 3, [{"time_step": None, **options} for options in runs], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("processes", [2, 3])
def test_runs_on_a_sea_with_islands(icosahedral_mesh: VoronoiMesh, processes: int, tmp_path: Path) -> None:
    """Coasts that cross from part to part, with slip along them: the rim of a part is no coast."""
    runs: list[dict[str, Any]] = [
        {"integrator": "rrk4"},
        {"wall_slip": 0.5},
        {"wall_slip": 1.0, "integrator": "rfbrk3", "dissipation": 1e15},
        {"wall_slip": 0.3, **CONSISTENT},
    ]
    require_same_runs(random_sea(icosahedral_mesh, islands=6), processes, runs, tmp_path)


@pytest.mark.slow
def test_one_ring_fewer_gives_other_bits(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """`rings_needed` asks for no more than the run needs."""
    runs: list[dict[str, Any]] = [
        {},
        {"integrator": "fbrk3"},
        {"scheme": "consistent"},
        {"anticipation": 0.5},
        {"upwinding": 0.5},
        {"dissipation": 1e15},
    ]
    jobs = [{"kind": "run", "options": options, "less": less} for options in runs for less in (0, 1)]
    found = results(2, icosahedral_mesh, jobs, tmp_path)
    for options, enough, fewer in zip(runs, found[::2], found[1::2], strict=True):
        expected = of_one(icosahedral_mesh, options)["fields"]["thickness"]
        assert enough["fields"]["thickness"] == expected, options
        assert fewer["fields"]["thickness"] != expected, options


@pytest.mark.slow
def test_sums_and_the_end_of_a_run_that_fails(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Sums and extremes are the same in any division; every process stops after the step that one found unsound."""
    failing: list[dict[str, Any]] = [{}, {"integrator": "rrk4"}, {"integrator": "fbrk3"}, {"dissipation": 1e15}]
    jobs = [{"kind": "collect"}, *({"kind": "break_off", "options": options} for options in failing)]
    sums, *ends = results(3, icosahedral_mesh, jobs, tmp_path)
    random = np.random.default_rng(3)
    rows = random.normal(size=(3, 999)) * 10.0 ** random.integers(-200, 200, (3, 999))
    rows[2, 500] = np.nan
    np.testing.assert_array_equal(sums["exact"], exact_sums(rows))
    assert np.isnan(sums["exact"][2])
    assert sums["sums"] == [3.0, 7.0]
    np.testing.assert_array_equal(sums["largest"], [1.0, np.nan, 2.0])
    for end in ends:
        assert end["unsound"] == [True] * 3
        assert len(set(end["taken"])) == 1
        assert end["taken"][0] < 50

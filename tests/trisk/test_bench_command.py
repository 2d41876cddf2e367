import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import swe.run.benchmark
from cases import Williamson5
from mesh import VoronoiMesh, mesh_from_points, scvt_mesh, write_mesh
from swe import Simulation
from swe.run.benchmark import measure
from tests.trisk.conftest import Call
from trisk.cli.bench import DEFAULT_CELLS

CONTRACT = {"cells", "threads", "ns_per_cell_step", "triad_gb_per_s", "bytes_per_cell_step", "plain_twin_ratio"}


@pytest.fixture(autouse=True)
def short_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(swe.run.benchmark, "ROUNDS", 3)
    monkeypatch.setattr(swe.run.benchmark, "SECONDS_PER_TURN", 0.01)
    monkeypatch.setattr(swe.run.benchmark, "TRIAD_SIZE", 100_000)


def test_json_has_one_object_for_every_size(trisk: Call) -> None:
    code, out, err = trisk("bench", "--cells", 162, "--cells", 642, "--json")
    timings = json.loads(out)
    assert code == 0
    assert [timing["cells"] for timing in timings] == [162, 642]
    assert "timing 642 cells" in err
    for timing in timings:
        assert set(timing) >= CONTRACT
        assert timing["threads"] == 1
        # States alone are 32 bytes a cell, moved twelve times in a step, and a cell's geometry is read four times.
        assert 12 * 32 + 4 * 200 < timing["bytes_per_cell_step"] < 12 * 32 + 4 * 600
        assert timing["plain_twin_ratio"] > 1.0
        assert timing["gb_per_s"] == pytest.approx(timing["bytes_per_cell_step"] / timing["ns_per_cell_step"])
        assert timing["fraction_of_triad"] == pytest.approx(timing["gb_per_s"] / timing["triad_gb_per_s"])


def test_another_integrator_is_timed(trisk: Call, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    code, out, _ = trisk("bench", "--mesh", path, "--integrator", "fbrk3", "--json", "-q")
    (timing,) = json.loads(out)
    assert code == 0
    assert timing["integrator"] == "fbrk3"
    # Eight arrays of three edges a cell and ten of cells are moved, and a cell's geometry is read three times.
    states = 8 * (8 * 3) + 10 * 8
    assert states + 3 * 200 < timing["bytes_per_cell_step"] < states + 3 * 600
    assert timing["plain_twin_ratio"] > 1.0
    code, out, _ = trisk("bench", "--mesh", path, "--integrator", "fbrk3", "-q")
    assert "FB-RK(3,2)" in out


def test_terms_are_timed_too(trisk: Call, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    found = []
    for terms in ([], ["--apvm", 0.5], ["--dissipation", 1e15]):
        code, out, _ = trisk("bench", "--mesh", path, "--json", "-q", *terms)
        assert code == 0
        found += json.loads(out)
    assert [timing["terms"] for timing in found] == [[], ["anticipation"], ["dissipation"]]
    bytes_moved = [timing["bytes_per_cell_step"] for timing in found]
    # Anticipation adds a ring of halo; dissipation reads and writes three edges a cell, and some 200 bytes of geometry.
    assert bytes_moved[0] < bytes_moved[1] < 2.0 * bytes_moved[0]
    assert 3 * 16 + 100 < bytes_moved[2] - bytes_moved[0] < 3 * 16 + 500
    code, out, _ = trisk("bench", "--mesh", path, "-q", "--dissipation", 1e15)
    assert "with dissipation" in out


def test_table_of_a_mesh_file(trisk: Call, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    code, out, err = trisk("bench", "--mesh", path, "-q")
    assert code == 0
    assert "642" in out
    assert "ratio" in out
    assert err == ""


def test_mesh_and_cells_are_refused_together(trisk: Call, tmp_path: Path) -> None:
    code, _, err = trisk("bench", "--mesh", tmp_path / "mesh.nc", "--cells", 42)
    assert code == 2
    assert "either --mesh FILE or --cells N" in err


def test_a_state_that_does_not_survive_is_no_timing(
    trisk: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Random generators: a few hundred steps at the default time step, and the run blows up."""
    monkeypatch.setattr(swe.run.benchmark, "SECONDS_PER_TURN", 0.5)
    path = tmp_path / "mesh.nc"
    write_mesh(mesh_from_points(np.random.default_rng(1).normal(size=(500, 3))), path)
    code, out, err = trisk("bench", "--mesh", path, "-q")
    assert code == 1
    assert out == ""
    assert "blew up" in err


def test_sizes_where_none_are_given() -> None:
    assert DEFAULT_CELLS == (10242, 40962)


def test_schemes_are_timed(trisk: Call, tmp_path: Path, icosahedral_mesh: VoronoiMesh) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path)
    code, out, _ = trisk("bench", "--mesh", path, "--scheme", "consistent", "--json", "-q")
    assert code == 0
    (found,) = json.loads(out)
    assert found["scheme"] == "consistent"
    assert found["bytes_per_cell_step"] > 1800.0
    code, _, err = trisk("bench", "--mesh", path, "--scheme", "consistent", "--integrator", "fbrk3", "-q")
    assert code == 2
    assert "the scheme is consistent and the integrator fbrk3: there are no fused steps to time" in err


def test_figures_are_medians_of_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a clock of our own: 2, 4 and 9 ms for fused steps, thrice as much for plain ones, 1 ms for a triad."""
    turns: list[int] = []
    clock = iter([0.002] * 3 + [0.01, 0.006, 0.001, 0.02, 0.012, 0.001, 0.045, 0.027, 0.001])

    def seconds(work: Callable[[], object], repeats: int) -> float:
        work()
        turns.append(repeats)
        return next(clock)

    monkeypatch.setattr(swe.run.benchmark, "_seconds", seconds)
    timing = measure(Simulation(scvt_mesh(162), Williamson5()))
    # A turn of 10 ms has five fused steps of 2 ms, measured together, and half as many plain ones.
    assert turns == [1] * 3 + [1, 2, 1] * 3
    assert timing.cells == 162
    assert timing.ns_per_cell_step == pytest.approx(4e6 / 162)
    assert timing.plain_ns_per_cell_step == pytest.approx(12e6 / 162)
    assert timing.plain_twin_ratio == pytest.approx(3.0)
    assert timing.triad_gb_per_s == pytest.approx(24 * 100_000 / 0.001 / 1e9)
    assert timing.gb_per_s == pytest.approx(timing.bytes_per_cell_step * 162 / 0.004 / 1e9)
    assert timing.fraction_of_triad == pytest.approx(timing.gb_per_s / timing.triad_gb_per_s)

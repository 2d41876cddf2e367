"""A run carried on to a later day leaves what one run to that day leaves, byte for byte."""

import json
import warnings
from pathlib import Path

import pytest

from cases import Williamson5
from mesh import VoronoiMesh, scvt_mesh
from swe import RunError, Simulation
from swe.diagnostics.outputs import Evaluation
from swe.errors import InputError, SetupWarning
from swe.integrators import STEPPINGS
from swe.output.checkpoint import checkpoint_paths, last_checkpoint
from swe.output.files import DiagnosticsFile, read_series
from swe.stepping.schedule import Schedule, last_shared

HOUR = 3600.0
OPTIONS = {"time_step": 1000.0, "snapshot_interval": 12 * HOUR, "diagnostics_interval": 3 * HOUR}


@pytest.fixture(scope="module")
def small_mesh() -> VoronoiMesh:
    return scvt_mesh(42)


def run_to(mesh: VoronoiMesh, folder: Path, days: float, **options: object) -> Simulation:
    """A run that goes on without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulation = Simulation(mesh, Williamson5(), folder, resume=True, **{**OPTIONS, **options})
        simulation.run(until=days, progress=False)
    return simulation


def kept_files(folder: Path) -> dict[str, bytes]:
    """All that a run leaves, apart from the record and the mesh, which tell of time and date."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in (".nc", ".npz")} | {
        "mesh.nc": b""
    }


@pytest.mark.slow
@pytest.mark.parametrize("integrator", STEPPINGS)
@pytest.mark.parametrize("checkpoint_hours", [1.0, 12.0, 1000.0])
@pytest.mark.parametrize("ends", [(1.0, 2.0), (1.0, 1.3), (1.01, 2.0), (0.3, 0.625, 1.99), (0.1, 1.0), (1.125, 1.5)])
def test_a_finished_run_is_carried_on(
    small_mesh: VoronoiMesh, tmp_path: Path, ends: tuple[float, ...], checkpoint_hours: float, integrator: str
) -> None:
    """Ends that are multiples of the intervals, of one of them, of none, and before the first multiple."""
    options = {"checkpoint_interval": checkpoint_hours * HOUR, "integrator": integrator}
    whole = run_to(small_mesh, tmp_path / "whole", ends[-1], **options)
    for days in ends:
        parts = run_to(small_mesh, tmp_path / "parts", days, **options)
    assert kept_files(tmp_path / "whole") == kept_files(tmp_path / "parts")
    one, other = (json.loads((tmp_path / name / "run.json").read_text()) for name in ("whole", "parts"))
    for name in ("status", "days", "day_reached", "steps", "configuration"):
        assert one[name] == other[name]
    assert parts.steps == whole.steps
    assert read_series(tmp_path / "parts" / "diagnostics.nc")["time"][-1] == ends[-1] * 86400.0


@pytest.mark.parametrize(
    ("stop", "ends"), [(1.05, (1.1, 2.0)), (0.4, (3.0, 0.5)), (0.4, (0.45, 2.0)), (0.9, (2.0, 1.01))]
)
def test_an_interrupted_run_gets_another_end(
    small_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stop: float, ends: tuple[float, float]
) -> None:
    """Broken off after a checkpoint, also in the last interval before the end, and taken to a later or earlier end."""
    options = {"checkpoint_interval": 0.05 * 86400.0, "integrator": "rrk4"}
    run_to(small_mesh, tmp_path / "whole", ends[-1], **options)
    monkeypatch.setattr("swe.run.simulation.CELL_STEPS_PER_CALL", 1)
    advance = Simulation._advance

    def fail(simulation: Simulation, event: float, most: int) -> None:
        advance(simulation, event, most)
        if simulation.time > stop * 86400.0:
            raise KeyboardInterrupt

    monkeypatch.setattr(Simulation, "_advance", fail)
    with pytest.raises(KeyboardInterrupt):
        run_to(small_mesh, tmp_path / "parts", ends[0], **options)
    monkeypatch.setattr(Simulation, "_advance", advance)
    run_to(small_mesh, tmp_path / "parts", ends[-1], **options)
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "parts" / name).read_bytes()


def test_what_goes_wrong_while_a_run_is_carried_on(
    small_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a failure between the two ends nothing of the first end is left to go on from."""
    run_to(small_mesh, tmp_path / "whole", 2.0)
    run_to(small_mesh, tmp_path / "parts", 1.01)
    append = DiagnosticsFile.append

    def fail(file: DiagnosticsFile, now: Evaluation) -> None:
        if now.time > 1.2 * 86400.0:
            raise RunError("no room")
        append(file, now)

    monkeypatch.setattr(DiagnosticsFile, "append", fail)
    with pytest.raises(RunError, match="no room"):
        run_to(small_mesh, tmp_path / "parts", 2.0)
    monkeypatch.setattr(DiagnosticsFile, "append", append)
    checkpoint = last_checkpoint(tmp_path / "parts", small_mesh.n_cells, small_mesh.n_edges)
    assert checkpoint is not None
    assert checkpoint.time == 86400.0
    run_to(small_mesh, tmp_path / "parts", 2.0)
    assert kept_files(tmp_path / "whole") == kept_files(tmp_path / "parts")


def test_a_run_does_not_go_back(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    run_to(small_mesh, tmp_path, 1.01)
    before = kept_files(tmp_path)
    with pytest.raises(InputError, match=r"the run stands at day 1\.01 and cannot go to day 1; give a later day"):
        run_to(small_mesh, tmp_path, 1.0)
    assert run_to(small_mesh, tmp_path, 1.01).time == 1.01 * 86400.0
    assert kept_files(tmp_path) == before


def test_without_a_shared_checkpoint_a_longer_run_begins_again(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """So it is for runs of versions that kept none before the end."""
    run_to(small_mesh, tmp_path / "whole", 2.0)
    run_to(small_mesh, tmp_path / "parts", 1.01)
    (tmp_path / "parts" / "checkpoint.shared.npz").unlink()
    checkpoint_paths(tmp_path / "parts")[0].unlink()
    with pytest.warns(SetupWarning, match="no checkpoint from which a run to day 2 goes on; the run begins again"):
        Simulation(small_mesh, Williamson5(), tmp_path / "parts", resume=True, **OPTIONS).run(until=2.0, progress=False)
    assert kept_files(tmp_path / "whole") == kept_files(tmp_path / "parts")


def test_last_shared_time() -> None:
    def shared(end: float) -> float:
        return last_shared((Schedule(10.0, end), Schedule(3.0, end)))

    assert [shared(end) for end in (30.0, 60.0)] == [30.0, 60.0]  # multiples of both
    assert [shared(end) for end in (12.0, 10.0, 20.0, 13.5)] == [10.0, 9.0, 18.0, 12.0]  # of one, or none
    assert shared(2.0) == 0.0
    assert shared(30.0 - 1e-9) == 27.0  # the end that takes the place of the multiple is none
    assert shared(30.0 + 1e-9) == 27.0


def test_rows_are_on_the_disk_while_the_run_goes_on(small_mesh: VoronoiMesh, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("swe.output.files.SECONDS_BETWEEN_WRITES", 0.0)
    rows: list[int] = []
    append = DiagnosticsFile.append

    def count(file: DiagnosticsFile, *arguments: object) -> None:
        append(file, *arguments)
        rows.append(len(read_series(tmp_path / "diagnostics.nc")["time"]))

    monkeypatch.setattr(DiagnosticsFile, "append", count)
    run_to(small_mesh, tmp_path, 0.5)
    assert rows == [1, 2, 3, 4, 5]

"""Checkpoints are whole or not there, and a run that goes on leaves what one without a stop leaves."""

import json
import os
import signal
import threading
import warnings
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from cases import Williamson2, Williamson5
from mesh import VoronoiMesh, scvt_mesh, write_mesh
from swe import RunError, Simulation, State
from swe.diagnostics.outputs import Evaluation
from swe.errors import InputError, RunStopped, SetupWarning
from swe.integrators import STEPPINGS
from swe.output.checkpoint import Checkpoint, checkpoint_paths, last_checkpoint, write_checkpoint
from swe.output.files import DiagnosticsFile, HistoryFile
from swe.output.recorder import Recorder
from swe.run.signals import stop_requests

OPTIONS = {"time_step": 1000.0, "snapshot_interval": 7200.0, "diagnostics_interval": 3600.0}


def same_files(one: Path, other: Path) -> bool:
    return all((one / name).read_bytes() == (other / name).read_bytes() for name in ("history.nc", "diagnostics.nc"))


def run_and_stop(mesh: VoronoiMesh, folder: Path, **options: object) -> None:
    """Run for three days, and ask to stop on the second."""
    simulation = Simulation(mesh, Williamson5(), folder, **{**OPTIONS, **options})
    append = DiagnosticsFile.append

    def append_and_ask(file: DiagnosticsFile, now: Evaluation) -> None:
        append(file, now)
        if now.time > 1e5:
            os.kill(os.getpid(), signal.SIGTERM)

    with (
        mock.patch.object(DiagnosticsFile, "append", append_and_ask),
        pytest.raises(RunStopped, match=r"stopped by SIGTERM at day .*; its checkpoint is in"),
    ):
        simulation.run(until=3, progress=False)


def test_round_trip(tmp_path: Path) -> None:
    state = State(np.array([1.0, 2.0 / 3.0]), np.array([-0.1, np.pi, 5e-324]))
    for steps in (9, 10, 11):
        write_checkpoint(tmp_path, Checkpoint(state, 0.1 * steps, steps, 3, 4, 500, 600))
    assert [path.name for path in checkpoint_paths(tmp_path)] == [
        *("checkpoint.0000000010.npz", "checkpoint.0000000011.npz")
    ]
    found = last_checkpoint(tmp_path, 2, 3)
    assert found is not None
    assert (found.time, found.steps, found.snapshots, found.rows) == (0.1 * 11, 11, 3, 4)
    assert (found.history_size, found.diagnostics_size) == (500, 600)
    np.testing.assert_array_equal(found.state.thickness, state.thickness)
    np.testing.assert_array_equal(found.state.normal_velocity, state.normal_velocity)


@pytest.mark.parametrize("damage", [lambda data: data[:100], lambda data: data[:-60], lambda data: b"", None])
def test_a_damaged_checkpoint_gives_way_to_the_one_before(tmp_path: Path, damage) -> None:
    state = State(np.ones(50), np.ones(70))
    for steps in (1, 2):
        write_checkpoint(tmp_path, Checkpoint(state, float(steps), steps, 1, 1, 1, 1))
    path = checkpoint_paths(tmp_path)[1]
    data = bytearray(path.read_bytes())
    if damage is None:
        data[300] ^= 1
    path.write_bytes(data if damage is None else damage(data))
    with pytest.warns(SetupWarning, match=r"checkpoint.0000000002.npz is damaged .* and ignored"):
        found = last_checkpoint(tmp_path, 50, 70)
    assert found is not None
    assert found.steps == 1
    assert last_checkpoint(tmp_path / "elsewhere", 50, 70) is None
    with (
        pytest.warns(SetupWarning, match="is damaged"),
        pytest.raises(InputError, match=r"no checkpoint in .* is whole; start anew"),
    ):
        last_checkpoint(tmp_path, 51, 70)


def test_any_bit_of_a_checkpoint_may_be_another(tmp_path: Path) -> None:
    """It is refused, or the very same: never an error of another kind, never another state."""
    state = State(np.array([1.0, 2.0]), np.array([3.0]))
    write_checkpoint(tmp_path, Checkpoint(state, 5.0, 1, 1, 1, 1, 1))
    path = checkpoint_paths(tmp_path)[0]
    data = path.read_bytes()
    refused = 0
    for place in range(0, 8 * len(data), 7):
        changed = bytearray(data)
        changed[place // 8] ^= 1 << (place % 8)
        path.write_bytes(changed)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                found = last_checkpoint(tmp_path, 2, 1)
            except InputError:
                refused += 1
                continue
        assert found is not None
        assert found.time == 5.0
        np.testing.assert_array_equal(found.state.thickness, state.thickness)
        np.testing.assert_array_equal(found.state.normal_velocity, state.normal_velocity)
    assert refused > 100


@pytest.mark.parametrize(
    "change",
    [
        *({"thickness": np.ones(3)}, {"thickness": np.array(1.0)}, {"thickness": np.array(["a", "b"])}),
        *({"thickness": np.array([1.0, -1.0])}, {"normal_velocity": np.array([np.nan])}),
        *({"time": np.array([1.0, 2.0])}, {"time": np.array(-1.0)}, {"time": np.array(np.nan)}),
        *({"counts": np.array(3)}, {"counts": np.ones(5)}, {"counts": np.array([1, -5, 1, 1, 1])}),
    ],
)
def test_a_checkpoint_of_nonsense_is_refused(tmp_path: Path, change: dict[str, np.ndarray]) -> None:
    good = {
        "thickness": np.array([1.0, 2.0]),
        "normal_velocity": np.array([3.0]),
        "time": np.array(5.0),
        "counts": np.ones(5, np.int64),
    }
    np.savez(tmp_path / "checkpoint.0000000001.npz", **good)
    assert last_checkpoint(tmp_path, 2, 1) is not None
    np.savez(tmp_path / "checkpoint.0000000001.npz", **{**good, **change})
    with pytest.warns(SetupWarning, match="is damaged"), pytest.raises(InputError, match="no checkpoint"):
        last_checkpoint(tmp_path, 2, 1)


@pytest.mark.parametrize("integrator", STEPPINGS)
def test_a_stopped_run_goes_on_to_the_same_files(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, integrator: str
) -> None:
    whole = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "whole", integrator=integrator, **OPTIONS)
    whole.run(until=3, progress=False)
    run_and_stop(icosahedral_mesh, tmp_path / "parts", integrator=integrator)
    record = json.loads((tmp_path / "parts" / "run.json").read_text())
    assert record["status"] == "interrupted"
    assert 0 < record["day_reached"] < 3
    assert not same_files(tmp_path / "whole", tmp_path / "parts")
    again = Simulation(
        icosahedral_mesh, Williamson5(), tmp_path / "parts", integrator=integrator, resume=True, **OPTIONS
    )
    assert again.steps == record["steps"]
    again.run(until=3, progress=False)
    assert same_files(tmp_path / "whole", tmp_path / "parts")
    np.testing.assert_array_equal(again.state.normal_velocity, whole.state.normal_velocity)
    after = json.loads((tmp_path / "parts" / "run.json").read_text())
    assert after["steps"] == whole.steps
    assert after["wall_seconds"] > record["wall_seconds"]
    assert len(checkpoint_paths(tmp_path / "parts")) == 2
    Simulation(icosahedral_mesh, Williamson5(), tmp_path / "parts", integrator=integrator, resume=True, **OPTIONS).run(
        until=3, progress=False
    )
    assert same_files(tmp_path / "whole", tmp_path / "parts")


def test_without_a_checkpoint_a_run_begins_again(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    for name in ("whole", "parts"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path / name, resume=True).run(until=1, progress=False)
    for path in checkpoint_paths(tmp_path / "parts"):
        path.unlink()
    (tmp_path / "parts" / "history.nc").write_bytes(b"half")
    with pytest.warns(SetupWarning, match="holds no checkpoint; the run begins again"):
        again = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "parts", resume=True)
    assert again.steps == 0
    again.run(until=1, progress=False)
    assert same_files(tmp_path / "whole", tmp_path / "parts")


def test_files_that_lost_rows_are_refused(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    Simulation(icosahedral_mesh, Williamson5(), tmp_path / "a").run(until=1, progress=False)
    Simulation(icosahedral_mesh, Williamson5(), tmp_path / "b").run(until=0.3, progress=False)
    (tmp_path / "a" / "diagnostics.nc").write_bytes((tmp_path / "b" / "diagnostics.nc").read_bytes())
    record = (tmp_path / "a" / "run.json").read_bytes()
    with pytest.raises(InputError, match=r"diagnostics.nc is not what its run had written, 5 rows"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path / "a", resume=True).run(until=1, progress=False)
    history = tmp_path / "b" / "history.nc"
    whole = history.read_bytes()
    for content in (whole[: len(whole) // 2], whole[:-8], b"text", (tmp_path / "b" / "diagnostics.nc").read_bytes()):
        history.write_bytes(content)
        with pytest.raises(InputError, match=r"history.nc .*start anew"):
            Simulation(icosahedral_mesh, Williamson5(), tmp_path / "b", resume=True).run(until=0.3, progress=False)
    history.unlink()
    with pytest.raises(InputError, match=r"history.nc cannot be opened to go on"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path / "b", resume=True).run(until=0.3, progress=False)
    assert (tmp_path / "a" / "run.json").read_bytes() == record


def test_another_mesh_case_or_option_is_named(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    run_and_stop(icosahedral_mesh, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def resumed(mesh: VoronoiMesh = icosahedral_mesh, case: object = None, **options: object) -> Simulation:
        return Simulation(mesh, case or Williamson5(), tmp_path, resume=True, **{**OPTIONS, **options})

    with pytest.raises(InputError, match="holds a run on another mesh; give the same options"):
        resumed(mesh=scvt_mesh(162))
    with pytest.raises(InputError, match="holds a run with case = williamson5, not williamson2"):
        resumed(case=Williamson2())
    with pytest.raises(InputError, match=r"holds a run with wind speed = 20, not 21"):
        resumed(case=Williamson5(wind_speed=21.0))
    for name, value in (
        *(("time_step", 900.0), ("snapshot_interval", 3600.0), ("diagnostics_interval", 7200.0)),
        *(
            ("integrator", "rrk4"),
            ("anticipation", 0.5),
            ("upwinding", 0.25),
            ("wall_slip", 0.5),
            ("dissipation", 1e14),
            ("sampling", "mean"),
        ),
    ):
        with pytest.raises(InputError, match=f"holds a run with {name.replace('_', ' ')} = .*, not .*; give the same"):
            resumed(**{name: value})
    with pytest.raises(InputError, match="leave out --force or --resume"):
        resumed(overwrite=True)

    class Moved(Williamson5):
        def coriolis_on(self, mesh: VoronoiMesh) -> np.ndarray:
            return 1.001 * super().coriolis_on(mesh)

    with pytest.raises(InputError, match="a run of a case with another start, topography, rotation or forcing"):
        resumed(case=Moved())
    assert before == {path.name: path.read_bytes() for path in tmp_path.iterdir()}


def test_other_versions_are_warned_of(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    Simulation(icosahedral_mesh, Williamson5(), tmp_path).run(until=0.5, progress=False)
    record = json.loads((tmp_path / "run.json").read_text())
    record["versions"]["numba"] = "0.1"
    (tmp_path / "run.json").write_text(json.dumps(record))
    with pytest.warns(SetupWarning, match="begun with other versions of packages"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path, resume=True)
    (tmp_path / "run.json").write_text("[1]")
    with pytest.raises(InputError, match=r"run\.json is not the record of a run; remove it"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path, resume=True)
    (tmp_path / "run.json").write_text('{"case": ')
    with pytest.raises(InputError, match=r"run\.json is not the record of a run"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path)


def test_a_second_signal_stops_at_once(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    handler = signal.getsignal(signal.SIGINT)
    with stop_requests() as request:
        os.kill(os.getpid(), signal.SIGINT)
        request.listen()
        assert request.signal == signal.SIGINT
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) == handler


def test_a_run_in_another_thread_leaves_signals_alone(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path)
    thread = threading.Thread(target=simulation.run, args=(0.5, False))
    thread.start()
    thread.join()
    assert simulation.time == 43200.0


def test_two_runs_do_not_write_to_one_directory(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    first = Simulation(icosahedral_mesh, Williamson5(), tmp_path)
    second = Simulation(icosahedral_mesh, Williamson5(), tmp_path)
    assert first.recorder is not None
    with (
        first._recording(first.recorder, 1.0),
        pytest.raises(InputError, match="is written to by another run just now"),
    ):
        second.run(until=1, progress=False)
    with pytest.raises(InputError, match="holds a run already"):
        second.run(until=1, progress=False)
    replacing = Simulation(icosahedral_mesh, Williamson5(), tmp_path, overwrite=True)
    replacing.run(until=0.25, progress=False)


def test_what_is_no_run_is_not_written_over(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    content = (tmp_path / "mesh.nc").read_bytes()
    for resume in (False, True):
        with pytest.raises(InputError, match=r"holds mesh.nc, but no run.json of a run; choose another directory"):
            Simulation(icosahedral_mesh, Williamson5(), tmp_path, resume=resume)
    assert (tmp_path / "mesh.nc").read_bytes() == content
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "history.nc").mkdir()
    (tmp_path / "other" / ".notes.part").write_text("of the user")
    with pytest.raises(InputError, match="is not a file, but a run has a file of that name"):
        Simulation(icosahedral_mesh, Williamson5(), tmp_path / "other", overwrite=True)
    (tmp_path / "other" / "history.nc").rmdir()
    Simulation(icosahedral_mesh, Williamson5(), tmp_path / "other").run(until=0.1, progress=False)
    assert (tmp_path / "other" / ".notes.part").exists()


def test_a_run_that_broke_off_is_made_again(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a failed writing the object cannot go on, as its files lack rows; from the checkpoint all is well."""
    whole = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "whole", **OPTIONS)
    whole.run(until=1, progress=False)
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "parts", checkpoint_interval=7200.0, **OPTIONS)
    with monkeypatch.context() as patch:
        append = HistoryFile.append

        def fail_once(self: HistoryFile, now: Evaluation) -> None:
            if now.time > 30000.0:
                raise RunError("no room")
            append(self, now)

        patch.setattr(HistoryFile, "append", fail_once)
        with pytest.raises(RunError, match="no room"):
            simulation.run(until=1, progress=False)
    with pytest.raises(InputError, match="the run broke off and cannot go on; make the simulation again"):
        simulation.run(until=1, progress=False)
    Simulation(icosahedral_mesh, Williamson5(), tmp_path / "parts", resume=True, **OPTIONS).run(until=1, progress=False)
    assert same_files(tmp_path / "whole", tmp_path / "parts")


def test_signals_that_are_ignored_or_come_too_late(icosahedral_mesh: VoronoiMesh) -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with stop_requests() as request:
            os.kill(os.getpid(), signal.SIGINT)
            request.listen()
            assert request.signal is None
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    with pytest.raises(KeyboardInterrupt), stop_requests():
        os.kill(os.getpid(), signal.SIGINT)


def test_a_run_on_another_mesh_killed_at_its_start_goes_on(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The mesh of the run that is replaced is gone before anything says that there is a new run."""
    Simulation(icosahedral_mesh, Williamson5(), tmp_path).run(until=0.1, progress=False)

    def die(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Recorder, "_write_mesh", die)
        with pytest.raises(KeyboardInterrupt):
            Simulation(scvt_mesh(162), Williamson5(), tmp_path, overwrite=True).run(until=0.1, progress=False)
    assert not (tmp_path / "mesh.nc").exists()
    with pytest.warns(SetupWarning, match="holds no checkpoint"):
        again = Simulation(scvt_mesh(162), Williamson5(), tmp_path, resume=True)
    again.run(until=0.1, progress=False)

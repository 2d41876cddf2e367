"""Runs in pieces, callbacks on schedules and conditions that end a run; none of them changes what is computed."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from swe import Callback, InputError, Simulation
from swe.integrators import STEPPINGS

HOUR = 3600.0


def test_days_go_on_and_until_is_a_day(small_mesh: VoronoiMesh) -> None:
    pieces, whole = (Simulation(small_mesh, Williamson5()) for _ in range(2))
    pieces.run(days=0.5, progress=False)
    pieces.run(days=0.25, progress=False)
    assert pieces.time == 0.75 * 86400.0
    pieces.run(until=1.25, progress=False)
    assert pieces.time == 1.25 * 86400.0
    whole.run(1.25, False)
    np.testing.assert_array_equal(pieces.state.thickness, whole.state.thickness)
    with pytest.raises(InputError, match=r"the run stands at day 1.25 and cannot go to day 1; give a later day"):
        pieces.run(until=1.0)
    for wrong in ({}, {"days": 1.0, "until": 2.0}):
        with pytest.raises(InputError, match=r"give the days that the run goes on, run\(days=...\), or the day of its"):
            pieces.run(**wrong)


@pytest.mark.parametrize("integrator", STEPPINGS)
def test_callbacks_come_at_their_times_and_change_nothing(
    small_mesh: VoronoiMesh, tmp_path: Path, integrator: str
) -> None:
    """Each after the first step that reaches a multiple, however many steps are taken at once without it."""
    called: dict[float, list[float]] = {5000.0: [], HOUR: [], 100.0: []}
    callbacks = [
        Callback(lambda simulation, interval=interval: called[interval].append(simulation.time), interval)
        for interval in called
    ]
    options: dict[str, Any] = {"time_step": 1000.0, "integrator": integrator, "snapshot_interval": 0.5 * 86400.0}
    for name, given in (("watched", callbacks), ("alone", [])):
        simulation = Simulation(small_mesh, Williamson5(), tmp_path / name, **options)
        simulation.run(days=0.5, progress=False, callbacks=given)
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "watched" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
    for interval in (5000.0, HOUR):
        counts = np.floor(np.array(called[interval]) / interval + 1e-6)
        np.testing.assert_array_equal(counts, np.arange(1, int(43200.0 / interval) + 1))
        late = np.array(called[interval]) - interval * counts
        assert np.all(late < 1010.0)
    assert len(called[100.0]) == simulation.steps


def test_a_condition_ends_a_run_that_can_go_on(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    options: dict[str, Any] = {"time_step": 1000.0}

    def past_a_third(simulation: Simulation) -> bool:
        return simulation.time > 30_000.0

    stopped = Simulation(small_mesh, Williamson5(), tmp_path / "parts", **options)
    stopped.run(days=1, progress=False, stop_when=past_a_third)
    assert 30_000.0 < stopped.time <= 31_000.0
    record = json.loads((tmp_path / "parts" / "run.json").read_text())
    assert (record["status"], record["reason"]) == ("stopped", "past_a_third held")
    again = Simulation(small_mesh, Williamson5(), tmp_path / "parts", resume=True, **options)
    assert again.time == stopped.time
    again.run(until=1, progress=False)
    assert json.loads((tmp_path / "parts" / "run.json").read_text())["status"] == "completed"
    Simulation(small_mesh, Williamson5(), tmp_path / "whole", **options).run(days=1, progress=False)
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    stopped.run(until=1, progress=False)
    np.testing.assert_array_equal(stopped.state.thickness, again.state.thickness)


@pytest.mark.parametrize(
    ("function", "interval", "message"),
    [
        (print, 0.0, "the interval of a callback is 0 s; it must be positive and finite"),
        (print, float("nan"), "the interval of a callback is nan s; it must be positive and finite"),
        (print, "often", "the interval of a callback is 'often'"),
        (3, 60.0, "a callback is 3; it must be a function of the simulation"),
    ],
)
def test_callbacks_that_are_none(function: object, interval: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Callback(function, interval)  # type: ignore[arg-type]


def test_a_function_alone_is_no_callback(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(InputError, match=r"a callback is <built-in function print>; give swe.Callback\(function"):
        Simulation(small_mesh, Williamson5()).run(days=1, callbacks=[print])  # type: ignore[list-item]

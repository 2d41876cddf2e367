"""The run loop: clock, schedules, output, progress and the watch over the state."""

import os
import time as clock
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import numba
import numpy as np

from mesh.arrays import Array
from mesh.io import mesh_hash, write_mesh
from mesh.quadrature import Sampling
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import SECONDS_PER_DAY
from swe.errors import RunError, SetupError
from swe.fused import FusedRungeKutta
from swe.invariants import Invariants, measure_invariants, relative_changes
from swe.memory import return_freed_memory
from swe.model import ShallowWaterModel, check_field
from swe.output import (
    DIAGNOSTICS_FILE,
    HISTORY_FILE,
    MESH_FILE,
    RECORD_FILE,
    DiagnosticsFile,
    HistoryFile,
    create_diagnostics,
    create_history,
    package_versions,
    write_record,
)
from swe.progress import ProgressBar
from swe.schedule import Schedule, dividing_step, steps_towards
from swe.state import State
from swe.threads import worthwhile_threads

DEFAULT_COURANT_NUMBER = 0.8
"""Courant number of the default time step, 70 percent of the limit for gravity waves (`courant_number`)."""

CELL_STEPS_PER_CALL = 400_000
"""Cells times steps between two looks at the keyboard and the bar of progress: some twentieth of a second."""

DEFAULT_SNAPSHOT_INTERVAL = SECONDS_PER_DAY
DEFAULT_DIAGNOSTICS_INTERVAL = SECONDS_PER_DAY / 4


class Case(Protocol):
    """What a simulation asks of a test case: see `cases.base.Case`."""

    @property
    def name(self) -> str:
        """Name by which the case is run."""

    @property
    def radius(self) -> float:
        """Radius of the sphere, m."""

    @property
    def gravity(self) -> float:
        """Acceleration of gravity, m/s2."""

    @property
    def prescribed_wind(self) -> bool:
        """Whether the wind stays as it is at the start, so that only thickness evolves."""

    def initial_state(self, mesh: VoronoiMesh, sampling: Sampling) -> State:
        """State at time zero, thickness at the centres of cells or the mean over each."""

    def topography_on(self, mesh: VoronoiMesh, sampling: Sampling) -> Array:
        """Height of the bottom at the centres of cells or the mean over each, m."""

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices, 1/s."""

    def parameters(self) -> dict[str, float]:
        """Parameters of the case by name, for the record of the run."""


@dataclass(frozen=True)
class Configuration:
    """What determines a run besides mesh and case; times in seconds."""

    time_step: float
    snapshot_interval: float
    diagnostics_interval: float
    sampling: Sampling


class Simulation:
    """One run of a case on a mesh.

    Parameters
    ----------
    mesh
        Any Voronoi mesh; it is scaled to the radius of the case.
    case
        A test case, such as those of `cases`.
    output
        Run directory to create; nothing is written if None. Refused where it holds a run already, unless
        `overwrite`.
    time_step
        Seconds; by default the largest up to `DEFAULT_COURANT_NUMBER` that divides the shorter output interval.
        Steps are shortened where they would pass an output time.
    snapshot_interval, diagnostics_interval
        Seconds between snapshots and between rows of diagnostics.
    sampling
        "point" where initial thickness and topography are those of the cells' centres, "mean" where they are means
        over the cells.

    Raises
    ------
    SetupError
        Where an option is out of range, the case gives no sound fields, the initial thickness is not positive, or
        the directory cannot be used.
    """

    def __init__(
        self,
        mesh: VoronoiMesh,
        case: Case,
        output: str | os.PathLike[str] | None = None,
        *,
        time_step: float | None = None,
        snapshot_interval: float = DEFAULT_SNAPSHOT_INTERVAL,
        diagnostics_interval: float = DEFAULT_DIAGNOSTICS_INTERVAL,
        sampling: Sampling = "point",
        overwrite: bool = False,
    ) -> None:
        _require_positive("the snapshot interval", snapshot_interval)
        _require_positive("the diagnostics interval", diagnostics_interval)
        self.case = case
        self.mesh = mesh.scaled(case.radius)
        self.model = ShallowWaterModel(
            self.mesh,
            case.topography_on(self.mesh, sampling),
            case.coriolis_on(self.mesh),
            case.gravity,
            case.prescribed_wind,
        )
        self.state = case.initial_state(self.mesh, sampling)
        check_field("initial thickness", self.state.thickness, self.mesh.n_cells)
        check_field("initial normal velocity", self.state.normal_velocity, self.mesh.n_edges)
        self.time = 0.0
        self.steps = 0
        problem = self._problem_with_state()
        if problem:
            raise SetupError(f"the initial {problem}; correct the parameters of {case.name}")
        if time_step is None:
            time_step = self._default_time_step(min(snapshot_interval, diagnostics_interval))
        _require_positive("the time step", time_step)
        self.configuration = Configuration(time_step, snapshot_interval, diagnostics_interval, sampling)
        self.initial_courant_number = self.courant_number = self.model.courant_number(self.state, time_step)
        self.initial_invariants = self.invariants
        self._directory = None if output is None else Path(output)
        if self._directory is not None:
            _check_directory(self._directory, overwrite)
        self.stepper = FusedRungeKutta(self.model)
        return_freed_memory()

    def _default_time_step(self, interval: float) -> float:
        """Largest step up to the default Courant number that divides `interval`."""
        per_second = self.model.courant_number(self.state, 1.0)
        # Where nothing moves, under a prescribed wind of zero, any step does.
        return dividing_step(DEFAULT_COURANT_NUMBER / per_second, interval) if per_second > 0.0 else interval

    @property
    def invariants(self) -> Invariants:
        """Invariants of the present state."""
        return measure_invariants(self.model, self.state, self.model.diagnose(self.state))

    def run(self, days: float, progress: bool = True) -> None:
        """Integrate to `days` after the start, writing output on the way.

        Raises `SetupError` where `days` is not later than now, `RunError` where the state ceases to be finite
        or the thickness to be positive; what was written before stays.
        """
        end = days * SECONDS_PER_DAY
        if not (np.isfinite(end) and end > self.time):
            raise SetupError(
                f"the run stands at day {self.time / SECONDS_PER_DAY:g} and cannot go to day {days:g}; give a later day"
            )
        snapshots = Schedule(self.configuration.snapshot_interval, end)
        diagnostics = Schedule(self.configuration.diagnostics_interval, end)
        with worthwhile_threads(self.mesh.n_cells), ProgressBar(self.time / SECONDS_PER_DAY, days, progress) as bar:
            recorder = _Recorder(self, days)
            try:
                recorder.begin()
                while self.time < end:
                    event = min(snapshots.next_after(self.time), diagnostics.next_after(self.time))
                    self._advance_to(event, bar)
                    recorder.record(snapshots.is_due(self.time), diagnostics.is_due(self.time))
            except BaseException as error:
                recorder.end("interrupted" if isinstance(error, KeyboardInterrupt) else "failed", str(error))
                raise
            recorder.end("completed")

    def _advance_to(self, event: float, bar: ProgressBar) -> None:
        """Step until `event`, seconds, is reached exactly."""
        self.stepper.count_taken()  # not those that others took with it
        most = max(1, CELL_STEPS_PER_CALL // self.mesh.n_cells)
        while self.time < event:
            step, times = steps_towards(self.time, event, self.configuration.time_step, most)
            try:
                self.stepper.advance(self.state, step, len(times))
            finally:
                taken = self.stepper.count_taken()
                self.time = [self.time, *times][taken]
                self.steps += taken
            if self.stepper.unsound:
                raise RunError(
                    f"at day {self.time / SECONDS_PER_DAY:.3f}, step {self.steps}, the {self._problem_with_state()}; "
                    f"the Courant number was {self.initial_courant_number:.2f} at the start: where that is above "
                    f"{DEFAULT_COURANT_NUMBER}, a smaller time step than {self.configuration.time_step:g} s helps"
                )
            bar.update(self.time / SECONDS_PER_DAY)
        self.courant_number = self.model.courant_number(self.state, self.configuration.time_step)
        bar.show_courant_number(self.courant_number)

    def _problem_with_state(self) -> str | None:
        """What is wrong with the state, as the end of a sentence; None if nothing is."""
        h, u = self.state.thickness, self.state.normal_velocity
        if not np.isfinite(u.sum()):
            edge = int(np.argmax(~np.isfinite(u)))
            return f"normal velocity is {u[edge]:g} m/s at edge {edge} (counted from 0)"
        if h.min() > 0.0 and np.isfinite(h.max()):
            return None
        cell = int(np.argmax(~((h > 0.0) & np.isfinite(h))))
        longitude, latitude = np.degrees(self.mesh.lon_cell[cell]), np.degrees(self.mesh.lat_cell[cell])
        return (
            f"thickness is {h[cell]:g} m in cell {cell} (counted from 0) at longitude {longitude:.1f} and "
            f"latitude {latitude:.1f} degrees"
        )


class _Recorder:
    """Writes what a run leaves in its directory; does nothing for a run without one."""

    def __init__(self, simulation: Simulation, days: float) -> None:
        self.simulation = simulation
        self.directory = simulation._directory
        self.days = days
        self.started = clock.perf_counter()
        self.history: HistoryFile | None = None
        self.diagnostics: DiagnosticsFile | None = None

    def begin(self) -> None:
        """Create the files and write the state at the start; open them again where the run goes on."""
        if self.directory is None:
            return
        simulation = self.simulation
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RunError(f"{self.directory} cannot be made: {error.strerror or error}") from error
        self._write_status("running")
        starting = simulation.steps == 0
        if starting:
            write_mesh(simulation.mesh, self.directory / MESH_FILE, f"mesh of a run of {simulation.case.name}")
            create_history(self.directory / HISTORY_FILE, simulation.mesh, simulation.model.topography)
            create_diagnostics(self.directory / DIAGNOSTICS_FILE)
        self.history = HistoryFile(self.directory / HISTORY_FILE)
        self.diagnostics = DiagnosticsFile(self.directory / DIAGNOSTICS_FILE)
        if starting:
            self.record(True, True)

    def record(self, snapshot: bool, diagnostics: bool) -> None:
        """Write the present state to the files that are due."""
        simulation = self.simulation
        if self.history is None or self.diagnostics is None or not (snapshot or diagnostics):
            return
        model, state = simulation.model, simulation.state
        diagnosis = model.diagnose(state)
        if snapshot:
            self.history.append(simulation.time, model, state, diagnosis)
        if diagnostics:
            invariants = measure_invariants(model, state, diagnosis)
            self.diagnostics.append(
                simulation.time,
                invariants,
                relative_changes(simulation.initial_invariants, invariants),
                simulation.courant_number,
                float(np.sqrt(2.0 * diagnosis.kinetic_energy.max())),
            )

    def end(self, status: str, reason: str = "") -> None:
        """Close the files and write the final status."""
        for file in (self.history, self.diagnostics):
            if file is not None:
                file.close()
        if self.directory is not None and self.directory.is_dir():
            self._write_status(status, reason)

    def _write_status(self, status: str, reason: str = "") -> None:
        simulation = self.simulation
        assert self.directory is not None
        write_record(
            self.directory,
            {
                "status": status,
                "reason": reason,
                "case": simulation.case.name,
                "parameters": simulation.case.parameters(),
                "configuration": asdict(simulation.configuration),
                "days": self.days,
                "day_reached": simulation.time / SECONDS_PER_DAY,
                "steps": simulation.steps,
                "wall_seconds": clock.perf_counter() - self.started,
                "threads": numba.get_num_threads(),
                "cells": simulation.mesh.n_cells,
                "mesh_hash": mesh_hash(simulation.mesh),
                "versions": package_versions(),
            },
        )


def _require_positive(what: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise SetupError(f"{what} is {value:g} s; it must be positive")


def _check_directory(directory: Path, overwrite: bool) -> None:
    """Raise `SetupError` where a run directory holds a run already or cannot be made or written to."""
    if (directory / RECORD_FILE).exists() and not overwrite:
        raise SetupError(f"{directory} holds a run already; choose another directory, or overwrite it (--force)")
    existing = next(path for path in (directory, *directory.absolute().parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK):
        raise SetupError(f"{directory} cannot be used as a run directory: {existing} is no folder one can write to")

"""What a run leaves in its directory, and how it goes on from there."""

import hashlib
import os
import time as clock
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numba
import numpy as np

from mesh.errors import MeshError
from mesh.files import held, place_of, remove_leftovers
from mesh.io import mesh_hash, write_mesh
from mesh.plain import recorded
from swe.budgets import measure_rates
from swe.checkpoint import (
    PATTERN,
    Checkpoint,
    last_checkpoint,
    remove_checkpoints,
    remove_superseded,
    write_checkpoint,
)
from swe.constants import SECONDS_PER_DAY
from swe.errors import RunError, RunStopped, SetupError, SetupWarning
from swe.invariants import measure_invariants, relative_changes
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
    read_record,
    write_record,
)

if TYPE_CHECKING:
    from swe.simulation import Simulation


class Recorder:
    """Writes snapshots, diagnostics, checkpoints and the record of a run.

    Raises `SetupError` where the directory cannot be used, holds a run already that is neither to be replaced nor to
    go on, or one to go on with that was made otherwise.
    """

    def __init__(self, simulation: "Simulation", directory: Path, overwrite: bool, resume: bool) -> None:
        self.directory = directory
        self._days = 0.0
        self._days_before: float | None = None
        self._seconds_before = 0.0
        self._description = _description(simulation)
        self._versions = package_versions()
        self._history: HistoryFile | None = None
        self._diagnostics: DiagnosticsFile | None = None
        self._begun = clock.perf_counter()
        self._reached: Checkpoint | None = None
        self._overwrite, self._resume = overwrite, resume
        self._found = run_to_go_on_with(directory, overwrite, resume)
        self._began = False
        if self._found is not None:
            self._require_same(self._found)

    @property
    def resumed(self) -> bool:
        """Whether the run goes on from what an earlier one left."""
        return self._found is not None

    def _require_same(self, before: dict[str, object]) -> None:
        """Raise `SetupError` where the run of an earlier record was made otherwise; take over its days and time."""
        for name, now in self._description.items():
            then = before.get(name)
            if then != now:
                raise SetupError(f"{self.directory} holds {_difference(name, then, now)}; {HOW_TO_GO_ON}")
        if before.get("versions") != self._versions:
            warnings.warn(
                f"{self.directory} was begun with other versions of packages; its files may differ in the last digits",
                SetupWarning,
                stacklevel=4,
            )
        self._days_before = days_of(before, self.directory)
        self._seconds_before = _number_in(before, "wall_seconds", self.directory)

    def restore(self, simulation: "Simulation") -> None:
        """Put the run to be gone on with, if any, back to where its last checkpoint is."""
        if not self.resumed:
            return
        self._reached = last_checkpoint(self.directory, simulation.mesh.n_cells, simulation.mesh.n_edges)
        if self._reached is None:
            warnings.warn(f"{self.directory} holds no checkpoint; the run begins again", SetupWarning, stacklevel=3)
            return
        simulation.set_back_to(self._reached.state, self._reached.time, self._reached.steps)

    def choose_end(self, simulation: "Simulation", days: float) -> None:
        """Give the run to be gone on with, if any, another end: go back to where a run to `days` has been as well."""
        before, self._days_before = self._days_before, None
        if before is None or days == before:
            return
        shared = min(simulation.last_shared_time(before), simulation.last_shared_time(days))
        cells, edges = simulation.mesh.n_cells, simulation.mesh.n_edges
        self._reached = last_checkpoint(self.directory, cells, edges, latest=shared)
        if self._reached is not None:
            simulation.set_back_to(self._reached.state, self._reached.time, self._reached.steps)
            return
        if shared > 0.0:
            warnings.warn(
                f"{self.directory} holds no checkpoint from which a run to day {days:g} goes on; the run begins again",
                SetupWarning,
                stacklevel=3,
            )
        simulation.set_back_to_start()

    def _require_unchanged(self) -> None:
        """Raise `SetupError` where another run wrote to the directory since this one looked at it."""
        if not self._began and run_to_go_on_with(self.directory, self._overwrite, self._resume) != self._found:
            raise SetupError(f"{self.directory} was written to by another run meanwhile; start again")
        self._began = True

    @contextmanager
    def recording(self, simulation: "Simulation", days: float) -> Iterator[None]:
        """Keep the files open in the course of a run to `days`, and write how it ended."""
        self._days = days
        self._begun = clock.perf_counter()
        self._make_directory()
        with held(self.directory) as free:
            if not free:
                raise SetupError(f"{self.directory} is written to by another run just now; wait for it, or stop it")
            self._require_unchanged()
            try:
                self._open(simulation)
                yield
                self._close()
            except SetupError:
                self._close()  # the files are not those of a run to go on with, and stay as they are
                raise
            except BaseException as error:
                stopped = isinstance(error, RunStopped | KeyboardInterrupt)
                self._end(simulation, "interrupted" if stopped else "failed", str(error))
                raise
            if simulation.last_shared_time(days) == simulation.time:
                remove_superseded(self.directory, simulation.steps)
            self._end(simulation, "completed")

    def _open(self, simulation: "Simulation") -> None:
        """Open the files where the run goes on; at its start create them, and write the first snapshot and row."""
        remove_leftovers(self.directory, (*FILES, PATTERN))
        history, diagnostics = self.directory / HISTORY_FILE, self.directory / DIAGNOSTICS_FILE
        starting, reached = simulation.steps == 0, self._reached
        if starting:
            remove_checkpoints(self.directory)
            (self.directory / MESH_FILE).unlink(missing_ok=True)  # so that what goes on finds no mesh of another run
            self._write_status(simulation, "running")
            create_history(history, simulation.mesh, simulation.model.topography, self._description)
            create_diagnostics(diagnostics, self._description)
        if reached is None:
            self._history, self._diagnostics = HistoryFile(history), DiagnosticsFile(diagnostics)
        else:
            self._history = HistoryFile(history, reached.snapshots, reached.history_size)
            self._diagnostics = DiagnosticsFile(diagnostics, reached.rows, reached.diagnostics_size)
            remove_checkpoints(self.directory, after=reached.steps)
            self._reached = None
        self._write_status(simulation, "running")
        if starting or reached is not None:
            self._write_mesh(simulation)
        if starting:
            self.record(simulation, True, True)

    def _write_mesh(self, simulation: "Simulation") -> None:
        try:
            write_mesh(simulation.mesh, self.directory / MESH_FILE, f"mesh of a run of {simulation.case.name}")
        except MeshError as error:
            raise RunError(str(error)) from error

    def _make_directory(self) -> None:
        try:
            place_of(self.directory).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SetupError(
                f"{self.directory} cannot be made ({error.strerror or error}); choose another directory"
            ) from error

    def record(self, simulation: "Simulation", snapshot: bool, diagnostics: bool) -> None:
        """Write the present state to the files that are due."""
        assert self._history is not None
        assert self._diagnostics is not None
        if not (snapshot or diagnostics):
            return
        model, state = simulation.model, simulation.state
        diagnosis = model.diagnose(state)
        if snapshot:
            self._history.append(simulation.time, model, state, diagnosis)
        if diagnostics:
            tendency = state.empty_like()
            simulation.method.tendency(state, tendency)
            invariants = measure_invariants(model, state, diagnosis)
            self._diagnostics.append(
                simulation.time,
                invariants,
                relative_changes(simulation.initial_invariants, invariants),
                measure_rates(model, state, diagnosis, tendency, simulation.dissipation),
                simulation.courant_number,
                float(np.sqrt(2.0 * diagnosis.kinetic_energy.max())),
            )

    def checkpoint(self, simulation: "Simulation", shared: bool = False) -> None:
        """Write a checkpoint, after all that comes before it; see `write_checkpoint`."""
        assert self._history is not None
        assert self._diagnostics is not None
        self._diagnostics.flush()
        write_checkpoint(
            self.directory,
            Checkpoint(
                simulation.state,
                simulation.time,
                simulation.steps,
                self._history.rows,
                self._diagnostics.rows,
                self._history.size,
                self._diagnostics.size,
            ),
            shared,
        )
        self._write_status(simulation, "running")

    def _close(self) -> None:
        for file in (self._history, self._diagnostics):
            if file is not None:
                file.close()
        self._history = self._diagnostics = None

    def _end(self, simulation: "Simulation", status: str, reason: str = "") -> None:
        """Close what is open and write the final status, however little of it the disk takes."""
        try:
            self._close()
        except RunError:
            if status == "completed":
                raise
        if self.directory.is_dir():
            self._write_status(simulation, status, reason)

    def _write_status(self, simulation: "Simulation", status: str, reason: str = "") -> None:
        record = {
            "status": status,
            "reason": reason,
            "days": self._days,
            "day_reached": simulation.time / SECONDS_PER_DAY,
            "steps": simulation.steps,
            "wall_seconds": self._seconds_before + clock.perf_counter() - self._begun,
            "threads": numba.get_num_threads(),
            "cells": simulation.mesh.n_cells,
            **self._description,
            "versions": self._versions,
        }
        try:
            write_record(self.directory, record)
        except OSError as error:
            if status == "failed":
                return  # the error that comes first is the one to tell
            raise RunError(
                f"{self.directory / RECORD_FILE} cannot be written ({error.strerror or error}); is the disk full?"
            ) from error


FILES = (RECORD_FILE, MESH_FILE, HISTORY_FILE, DIAGNOSTICS_FILE)

HOW_TO_GO_ON = "give the same options, or another directory"


def _description(simulation: "Simulation") -> dict[str, object]:
    """What a run must have in common with the one that it goes on from, as the record has it."""
    parameters = simulation.case.parameters()
    try:
        as_recorded = recorded(parameters)
    except (TypeError, ValueError, RecursionError) as error:
        raise SetupError(
            f"the parameters of {simulation.case.name} cannot be recorded ({error}); give numbers, words, or lists of "
            "them"
        ) from error
    return {
        "mesh_hash": mesh_hash(simulation.mesh),
        "case": simulation.case.name,
        "parameters": as_recorded,
        "configuration": asdict(simulation.configuration),
        "start_hash": _start_hash(simulation),
    }


def _start_hash(simulation: "Simulation") -> str:
    """SHA-256, in hexadecimal, of the initial state, the topography and the Coriolis parameter."""
    digest = hashlib.sha256(np.float64(simulation.model.gravity).tobytes())
    for values in (*vars(simulation.state).values(), simulation.model.topography, simulation.model.coriolis):
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def _difference(name: str, then: object, now: object) -> str:
    """What is different between the run that a directory holds and the one that is asked for, as part of a sentence."""
    if isinstance(then, dict) and isinstance(now, dict):
        for key in (*now, *then):
            if then.get(key) != now.get(key):
                return _difference(key, then.get(key), now.get(key))
    if name == "mesh_hash":
        return "a run on another mesh"
    if name == "start_hash":
        return "a run of a case with another start, topography or rotation"
    return f"a run with {name.replace('_', ' ')} = {_shown(then)}, not {_shown(now)}"


def _shown(value: object) -> str:
    return f"{value:.15g}" if isinstance(value, float | int) else str(value)


def run_to_go_on_with(directory: Path, overwrite: bool, resume: bool) -> dict[str, object] | None:
    """The record of the run in `directory` where it is to be gone on with; None where a run begins there.

    Raises `SetupError` where the directory cannot be used, or holds a run that is neither to be replaced nor to go on.
    """
    existing = next(path for path in (directory, *directory.absolute().parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise SetupError(f"{directory} cannot be used as a run directory: {existing} is no folder one can write to")
    if overwrite and resume:
        raise SetupError("a run is either replaced or gone on with, not both; leave out --force or --resume")
    present = [path for name in (*FILES, PATTERN) for path in directory.glob(name)]
    for path in present:
        if not path.is_file():
            raise SetupError(f"{path} is no file, but a run has a file of that name; choose another directory")
    if overwrite:
        return None
    before = read_record(directory)
    if before is None and present:
        raise SetupError(
            f"{directory} holds {present[0].name}, but no {RECORD_FILE} of a run; choose another directory, or replace "
            "what it holds (--force)"
        )
    if before is not None and not resume:
        raise SetupError(
            f"{directory} holds a run already; choose another directory, go on with it (--resume) or replace it "
            "(--force)"
        )
    return before


def days_of(record: dict[str, object], directory: Path) -> float:
    """Days that a run was to last according to its `record`; raise `SetupError` where that does not tell."""
    return _number_in(record, "days", directory)


def _number_in(record: dict[str, object], name: str, directory: Path) -> float:
    value = record.get(name)
    if not isinstance(value, int | float) or not 0.0 <= value < float("inf"):
        raise SetupError(
            f"{directory / RECORD_FILE} does not tell the {name.replace('_', ' ')} of the run; start anew (--force)"
        )
    return float(value)

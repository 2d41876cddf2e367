"""What a run leaves in its directory, and how it resumes from there."""

import os
import time as clock
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import numba

from mesh.errors import MeshError
from mesh.safe_files import held, place_of, remove_leftovers
from swe.constants import SECONDS_PER_DAY
from swe.diagnostics.outputs import Evaluation, series_of
from swe.errors import InputError, RunError, RunStopped, SetupWarning
from swe.output.checkpoint import (
    PATTERN,
    Checkpoint,
    last_checkpoint,
    remove_checkpoints,
    remove_superseded,
    shared_checkpoint,
    write_checkpoint,
)
from swe.output.description import ABSENT, ABSENT_CONFIGURATION, Moment, RunDescription, described, difference
from swe.output.files import (
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
from swe.state import State


class Recorder:
    """Writes snapshots, diagnostics, checkpoints and the record of a run.

    Every process of the run has one, but only the first reads and writes files. `early_end` says, in words, why a run
    ended early, if it did.

    Raises `InputError` if the directory cannot be used, already holds a run that is neither to be replaced nor resumed,
    or holds a run to resume that was made with other settings.
    """

    def __init__(self, run: RunDescription, directory: Path, overwrite: bool, resume: bool) -> None:
        self.directory = directory
        self._days = 0.0
        self._days_before: float | None = None
        self._seconds_before = 0.0
        self._run = run
        self._processes = run.processes
        self._description = described(run)
        self._versions = package_versions()
        self._history: HistoryFile | None = None
        self._diagnostics: DiagnosticsFile | None = None
        self._begun = clock.perf_counter()
        self._reached: Checkpoint | None = None
        self._overwrite, self._resume = overwrite, resume
        self._found = self._processes.on_first(lambda: run_to_go_on_with(directory, overwrite, resume))
        self._began = False
        self.early_end = ""
        if self._found is not None:
            self._require_same(self._found)

    @property
    def resumed(self) -> bool:
        """Whether the run resumes an earlier one."""
        return self._found is not None

    def _require_same(self, before: dict[str, object]) -> None:
        """Raise `InputError` if the earlier run was made with other settings; take over its days and elapsed time."""
        for name, now in self._description.items():
            then = before.get(name, ABSENT.get(name))
            if name == "configuration" and isinstance(then, dict):
                then = {**ABSENT_CONFIGURATION, **then}
            if then != now:
                raise InputError(f"{self.directory} holds {difference(name, then, now)}; {HOW_TO_GO_ON}")
        if before.get("versions") != self._versions:
            warnings.warn(
                f"{self.directory} was begun with other versions of packages; its files may differ in the last digits",
                SetupWarning,
                stacklevel=4,
            )
        self._days_before = days_of(before, self.directory)
        self._seconds_before = _number_in(before, "wall_seconds", self.directory)

    def restore(self) -> Checkpoint | None:
        """The last checkpoint of the run to resume; None for a new run or, with a warning, if there is none."""
        if not self.resumed:
            return None
        self._reached = self._last_checkpoint()
        if self._reached is None:
            warnings.warn(f"{self.directory} holds no checkpoint; the run begins again", SetupWarning, stacklevel=3)
        return self._reached

    def other_end(self, days: float) -> float | None:
        """Days that the run to resume was to last, if they differ from `days`; None at any later call."""
        before, self._days_before = self._days_before, None
        return None if before == days else before

    def restore_shared(self, days: float, shared: float) -> Checkpoint | None:
        """The last checkpoint up to `shared` seconds, from which a run to `days` resumes; None to begin again."""
        self._reached = self._last_checkpoint(shared)
        if self._reached is None and shared > 0.0:
            warnings.warn(
                f"{self.directory} holds no checkpoint from which a run to day {days:g} goes on; the run begins again",
                SetupWarning,
                stacklevel=4,
            )
        return self._reached

    def _last_checkpoint(self, latest: float = float("inf")) -> Checkpoint | None:
        mesh = self._run.mesh
        return shared_checkpoint(
            lambda: last_checkpoint(self.directory, mesh.n_cells, mesh.n_edges, latest=latest), self._processes
        )

    def _require_unchanged(self) -> None:
        """Raise `InputError` if another run has written to the directory since this one looked at it."""
        if not self._began and run_to_go_on_with(self.directory, self._overwrite, self._resume) != self._found:
            raise InputError(f"{self.directory} was written to by another run meanwhile; start again")
        self._began = True

    @contextmanager
    def recording(self, days: float, shared: float, now: Callable[[], Moment]) -> Iterator[None]:
        """Keep the files open during a run to `days`, and write how it ended; `now` returns where it stands.

        Up to `shared` seconds the run is the same as any longer one.
        """
        self._days = days
        self._begun = clock.perf_counter()
        first, on_first = self._processes.first, self._processes.on_first
        on_first(self._make_directory)
        with held(self.directory) if first else nullcontext(True) as free:
            on_first(lambda: self._require_free(free))
            try:
                self._open(now())
                yield
                on_first(self._close)
            except InputError:
                self._close()  # the files are not those of the run to resume, and stay as they are
                raise
            except BaseException as error:
                # The error may be one that other processes do not know of, so that nobody may wait for them.
                stopped = isinstance(error, RunStopped | KeyboardInterrupt)
                if first:
                    self._end(now(), "interrupted" if stopped else "failed", str(error))
                raise
            on_first(lambda: self._complete(now(), shared))

    def _require_free(self, free: bool) -> None:
        """Raise `InputError` if another run writes to the directory, or did so since this one looked at it."""
        if not free:
            raise InputError(f"{self.directory} is written to by another run just now; wait for it, or stop it")
        self._require_unchanged()

    def _complete(self, moment: Moment, shared: float) -> None:
        if shared == moment.time:
            remove_superseded(self.directory, moment.steps)
        self._end(moment, "stopped" if self.early_end else "completed", self.early_end)

    def _open(self, moment: Moment) -> None:
        """Open the files where the run continues; at its start create them, and write the first snapshot and row."""
        on_first, processes = self._processes.on_first, self._processes
        on_first(lambda: remove_leftovers(self.directory, (*FILES, PATTERN)))
        history, diagnostics = self.directory / HISTORY_FILE, self.directory / DIAGNOSTICS_FILE
        starting, reached = moment.steps == 0, self._reached
        run, series = self._run, series_of(self._run.model.terms)
        if starting:
            on_first(lambda: self._clear(moment))
            create_history(history, run, self._description)
            create_diagnostics(diagnostics, run, series, self._description)
        if reached is None:
            self._history = HistoryFile(history, run.fields, processes)
            self._diagnostics = DiagnosticsFile(diagnostics, series, processes)
        else:
            self._history = HistoryFile(history, run.fields, processes, reached.snapshots, reached.history_size)
            self._diagnostics = DiagnosticsFile(diagnostics, series, processes, reached.rows, reached.diagnostics_size)
            on_first(lambda: remove_checkpoints(self.directory, after=reached.steps))
            self._reached = None
        on_first(lambda: self._write_status(moment, "running"))
        if starting or reached is not None:
            on_first(self._write_mesh)
        if starting:
            self.record(moment, True, True)

    def _clear(self, moment: Moment) -> None:
        """Remove what an earlier run left that would be taken for this one's."""
        remove_checkpoints(self.directory)
        (self.directory / MESH_FILE).unlink(missing_ok=True)  # so that a resumed run finds no mesh of another run
        self._write_status(moment, "running")

    def _write_mesh(self) -> None:
        try:
            history, known = f"mesh of a run of {self._run.case_name}", str(self._description["mesh_hash"])
            self._run.mesh.write(self.directory / MESH_FILE, history, known)
        except MeshError as error:
            raise RunError(str(error)) from error

    def _make_directory(self) -> None:
        try:
            place_of(self.directory).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"{self.directory} cannot be made ({error.strerror or error}); choose another directory"
            ) from error

    def record(self, moment: Moment, snapshot: bool, diagnostics: bool) -> None:
        """Write the state of a moment to the files that are due."""
        assert self._history is not None
        assert self._diagnostics is not None
        if not (snapshot or diagnostics):
            return
        now = Evaluation(
            self._run.model,
            moment.state,
            moment.time,
            moment.courant_number,
            moment.tendency,
            self._run.initial_invariants,
        )
        if snapshot:
            self._history.append(now)
        if diagnostics:
            self._diagnostics.append(now)

    def checkpoint(self, moment: Moment, shared: bool = False) -> None:
        """Write a checkpoint, after all output that precedes it; see `write_checkpoint`."""
        gathered, state = self._processes.gathered, moment.state
        whole = State(gathered("cells", state.thickness), gathered("edges", state.normal_velocity))
        self._processes.on_first(lambda: self._write_checkpoint(moment, whole, shared))

    def _write_checkpoint(self, moment: Moment, state: State, shared: bool) -> None:
        assert self._history is not None
        assert self._diagnostics is not None
        self._diagnostics.flush()
        write_checkpoint(
            self.directory,
            Checkpoint(
                state,
                moment.time,
                moment.steps,
                self._history.rows,
                self._diagnostics.rows,
                self._history.size,
                self._diagnostics.size,
            ),
            shared,
        )
        self._write_status(moment, "running")

    def _close(self) -> None:
        for file in (self._history, self._diagnostics):
            if file is not None:
                file.close()
        self._history = self._diagnostics = None

    def _end(self, moment: Moment, status: str, reason: str = "") -> None:
        """Close the open files and write the final status, as far as the disk allows."""
        try:
            self._close()
        except RunError:
            if status in ("completed", "stopped"):
                raise
        if self.directory.is_dir():
            self._write_status(moment, status, reason)

    def _write_status(self, moment: Moment, status: str, reason: str = "") -> None:
        record = {
            "status": status,
            "reason": reason,
            "days": self._days,
            "day_reached": moment.time / SECONDS_PER_DAY,
            "steps": moment.steps,
            "wall_seconds": self._seconds_before + clock.perf_counter() - self._begun,
            "processes": self._processes.count,
            "threads": numba.get_num_threads(),
            "cells": self._run.model.cells,
            "loops": self._run.loops,
            **self._description,
            "versions": self._versions,
        }
        try:
            write_record(self.directory, record)
        except OSError as error:
            if status == "failed":
                return  # the first error is the one to report
            raise RunError(
                f"{self.directory / RECORD_FILE} cannot be written ({error.strerror or error}); is the disk full?"
            ) from error


FILES = (RECORD_FILE, MESH_FILE, HISTORY_FILE, DIAGNOSTICS_FILE)

HOW_TO_GO_ON = "give the same options, or another directory"


def run_to_go_on_with(directory: Path, overwrite: bool, resume: bool) -> dict[str, object] | None:
    """The record of the run in `directory` if it is to be resumed; None if a new run begins there.

    Raises `InputError` if the directory cannot be used, or holds a run that is neither to be replaced nor resumed.
    """
    existing = next(path for path in (directory, *directory.absolute().parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(f"{directory} cannot be used as a run directory: {existing} is not a writable folder")
    if overwrite and resume:
        raise InputError("a run is either replaced or resumed, not both; leave out --force or --resume")
    present = [path for name in (*FILES, PATTERN) for path in directory.glob(name)]
    for path in present:
        if not path.is_file():
            raise InputError(f"{path} is not a file, but a run has a file of that name; choose another directory")
    if overwrite:
        return None
    before = read_record(directory)
    if before is None and present:
        raise InputError(
            f"{directory} holds {present[0].name}, but no {RECORD_FILE} of a run; choose another directory, or replace "
            "what it holds (--force)"
        )
    if before is not None and not resume:
        raise InputError(
            f"{directory} holds a run already; choose another directory, go on with it (--resume) or replace it "
            "(--force)"
        )
    return before


def days_of(record: dict[str, object], directory: Path) -> float:
    """Days that a run was to last according to its `record`; raise `InputError` if the record does not say."""
    return _number_in(record, "days", directory)


def fields_of(record: dict[str, object] | None) -> list[str] | None:
    """Names of the fields that a run writes according to its `record`; None, for all, if it does not say."""
    fields = None if record is None else record.get("fields")
    return [str(name) for name in fields] if isinstance(fields, list) else None


def _number_in(record: dict[str, object], name: str, directory: Path) -> float:
    value = record.get(name)
    if not isinstance(value, int | float) or not 0.0 <= value < float("inf"):
        raise InputError(
            f"{directory / RECORD_FILE} does not give the {name.replace('_', ' ')} of the run; start anew (--force)"
        )
    return float(value)

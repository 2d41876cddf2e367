"""Checkpoints of a run: the state to resume from, written aside and renamed; the last two are kept.

A file is a zip archive of numpy arrays, whose checksums show whether it is whole.
"""

import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mesh.safe_files import written_aside
from swe.errors import InputError, RunError, SetupWarning
from swe.parallel.processes import Processes
from swe.state import State

NO_STATE = State(np.empty(0), np.empty(0))
"""What other processes hold of the state of a checkpoint that the first one has read."""

KEPT = 2

PATTERN = "checkpoint.*.npz"
"""All checkpoints of a run."""

NUMBERED = "checkpoint.[0-9]*.npz"
"""Those written at intervals, at a stop and at an end that a longer run would not pass through, by number of steps."""

SHARED = "checkpoint.shared.npz"
"""The last state that a longer run passes through too (`last_shared`), which perhaps no numbered one holds."""

COUNTS = ("steps", "snapshots", "rows", "history_size", "diagnostics_size")
"""Integers that a checkpoint holds."""


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A state at `time`, seconds since the start, after `steps` steps.

    `snapshots` and `rows` are the numbers of snapshots and of rows of diagnostics written until then, and
    `history_size` and `diagnostics_size` the sizes of their files, bytes.
    """

    state: State
    time: float
    steps: int
    snapshots: int
    rows: int
    history_size: int
    diagnostics_size: int


def write_checkpoint(directory: Path, checkpoint: Checkpoint, shared: bool = False) -> None:
    """Write a checkpoint to a run directory and remove all but the last two; raise `RunError` if that fails.

    The one `shared` with longer runs has a file of its own, which stays until the next one replaces it.
    """
    path = directory / (SHARED if shared else _name(checkpoint.steps))
    try:
        with written_aside(path) as aside, aside.open("wb") as file:
            np.savez(
                file,
                thickness=checkpoint.state.thickness,
                normal_velocity=checkpoint.state.normal_velocity,
                time=checkpoint.time,
                counts=np.array([getattr(checkpoint, name) for name in COUNTS], np.int64),
            )
            file.flush()
            os.fsync(file.fileno())
        for old in checkpoint_paths(directory)[:-KEPT]:
            old.unlink()
    except OSError as error:
        raise RunError(f"{path} cannot be written ({error.strerror or error}); is the disk full?") from error


def last_checkpoint(directory: Path, n_cells: int, n_edges: int, latest: float = float("inf")) -> Checkpoint | None:
    """The last whole checkpoint in a run directory not after `latest`, seconds; None if there is none.

    Warns with `SetupWarning` of damaged ones; raises `InputError` if all are damaged.
    """
    shared = [path for path in (directory / SHARED,) if path.exists()]
    numbered = checkpoint_paths(directory)[::-1]
    found, any_whole = [], False
    for paths in (shared, numbered):
        for path in paths:
            try:
                checkpoint = _read(path, n_cells, n_edges)
            except Exception as error:  # of any kind, as any byte may be corrupt
                warnings.warn(f"{path} is damaged ({error}) and ignored", SetupWarning, stacklevel=2)
                continue
            any_whole = True
            if checkpoint.time <= latest:
                found.append(checkpoint)
                break
    if (shared or numbered) and not any_whole:
        raise InputError(f"no checkpoint in {directory} is whole; start anew (--force)")
    return max(found, key=lambda checkpoint: checkpoint.time, default=None)


def shared_checkpoint(find: Callable[[], Checkpoint | None], processes: Processes) -> Checkpoint | None:
    """The checkpoint that the first process finds, with every process's part of the state."""
    found: list[State] = []

    def without_state() -> Checkpoint | None:
        checkpoint = find()
        if checkpoint is None:
            return None
        found.append(checkpoint.state)
        return replace(checkpoint, state=NO_STATE)

    checkpoint = processes.on_first(without_state)
    if checkpoint is None:
        return None
    state = found[0] if found else NO_STATE
    h, u = processes.scattered("cells", state.thickness), processes.scattered("edges", state.normal_velocity)
    return replace(checkpoint, state=State(h, u))


def remove_checkpoints(directory: Path, after: int = 0) -> None:
    """Remove the checkpoints of a run to be replaced, or those `after` so many steps if it takes a different course.

    The shared one is removed only together with all the others.
    """
    if after == 0:
        (directory / SHARED).unlink(missing_ok=True)
    for path in checkpoint_paths(directory):
        if path.name > _name(after):
            path.unlink()


def remove_superseded(directory: Path, steps: int) -> None:
    """Remove the shared checkpoint if there is a numbered one after `steps` steps, the last of the run."""
    if (directory / _name(steps)).exists():
        (directory / SHARED).unlink(missing_ok=True)


def _name(steps: int) -> str:
    return f"checkpoint.{steps:010d}.npz"


def checkpoint_paths(directory: Path) -> list[Path]:
    """Numbered checkpoints in a run directory, oldest first."""
    return sorted(directory.glob(NUMBERED))


def _read(path: Path, n_cells: int, n_edges: int) -> Checkpoint:
    """The checkpoint at `path`; raises one of several errors if it is not one for such a mesh."""
    with np.load(path) as file:
        state = State(file["thickness"], file["normal_velocity"])
        time, counts = file["time"], file["counts"]
    for name, values, size in (("thickness", state.thickness, n_cells), ("velocity", state.normal_velocity, n_edges)):
        if values.shape != (size,) or values.dtype != np.float64 or not np.isfinite(values).all():
            raise ValueError(f"its {name} is not that of a state on the mesh")
    if not state.thickness.min() > 0.0:
        raise ValueError("its thickness is not positive")
    if counts.shape != (len(COUNTS),) or counts.dtype != np.int64 or counts.min() < 1:
        raise ValueError("its counts are not positive whole numbers")
    if time.shape != () or time.dtype != np.float64 or not 0.0 < time < np.inf:
        raise ValueError("its time is not a positive number of seconds")
    return Checkpoint(state, float(time), **dict(zip(COUNTS, counts.tolist(), strict=True)))

"""Checkpoints of a run: the state to go on from, written aside and renamed; the last two are kept.

A file is a zip archive of numpy arrays whose check sums tell whether it is whole.
"""

import os
import warnings
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mesh.files import written_aside
from swe.errors import RunError, SetupWarning
from swe.state import State

KEPT = 2

PATTERN = "checkpoint.*.npz"


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A state at `time`, seconds since the start, after `steps` steps.

    `snapshots` and `rows` are the numbers of snapshots and of rows of diagnostics that were written until then.
    """

    state: State
    time: float
    steps: int
    snapshots: int
    rows: int


def write_checkpoint(directory: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint to a run directory and remove all but the last two; raise `RunError` where that fails."""
    path = directory / f"checkpoint.{checkpoint.steps:010d}.npz"
    try:
        with written_aside(path) as aside, aside.open("wb") as file:
            np.savez(
                file,
                thickness=checkpoint.state.thickness,
                normal_velocity=checkpoint.state.normal_velocity,
                time=checkpoint.time,
                counts=np.array([checkpoint.steps, checkpoint.snapshots, checkpoint.rows]),
            )
            file.flush()
            os.fsync(file.fileno())
        for old in checkpoint_paths(directory)[:-KEPT]:
            old.unlink()
    except OSError as error:
        raise RunError(f"{path} cannot be written ({error.strerror or error}); is the disk full?") from error


def last_checkpoint(directory: Path) -> Checkpoint | None:
    """The last checkpoint of a run directory that is whole; None where there is none.

    Warns with `SetupWarning` of one that is damaged.
    """
    for path in reversed(checkpoint_paths(directory)):
        try:
            return _read(path)
        except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile) as error:
            warnings.warn(f"{path} is damaged ({error}); going back to an earlier one", SetupWarning, stacklevel=2)
    return None


def remove_checkpoints(directory: Path) -> None:
    """Remove the checkpoints of a run that is to be replaced."""
    for path in checkpoint_paths(directory):
        path.unlink()


def checkpoint_paths(directory: Path) -> list[Path]:
    """Checkpoints of a run directory, the oldest first."""
    return sorted(directory.glob(PATTERN))


def _read(path: Path) -> Checkpoint:
    with np.load(path) as file:
        steps, snapshots, rows = file["counts"].tolist()
        state = State(file["thickness"], file["normal_velocity"])
        return Checkpoint(state, float(file["time"]), steps, snapshots, rows)

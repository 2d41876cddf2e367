"""Checkpoints of a mesh generation: the best points so far, to go on from after an interruption."""

import json
import time
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.generation.optimizer import Iterate
from mesh.safe_files import written_aside

SECONDS_BETWEEN = 30.0
"""How much work a sudden end may lose."""


def checkpoint_path(output: Path) -> Path:
    """Where the generation of mesh file `output` keeps its checkpoint."""
    return output.with_name(output.name + ".checkpoint.npz")


class CheckpointKeeper:
    """A callback that keeps the iterate of the smallest residual, and writes it to `path` every half minute.

    `description` says what is being generated; only the same generation may go on from the file.
    """

    def __init__(self, path: Path, description: Mapping[str, object]) -> None:
        self._path = path
        self._description = dict(description)
        self._best: tuple[float, Array] | None = None
        self._saved = time.monotonic()

    def __call__(self, iterate: Iterate) -> None:
        """Take note of an iterate."""
        if self._best is None or iterate.residual < self._best[0]:
            self._best = (iterate.residual, iterate.points.copy())
        if time.monotonic() - self._saved > SECONDS_BETWEEN:
            self.save()

    def save(self) -> bool:
        """Write the best points now; False where there are none yet."""
        if self._best is None:
            return False
        residual, points = self._best
        description = json.dumps(self._description)
        with written_aside(self._path) as aside, aside.open("wb") as file:
            np.savez(file, points=points, residual=residual, description=description)
        self._saved = time.monotonic()
        return True

    def remove(self) -> None:
        """Delete the file of a generation that is complete."""
        self._path.unlink(missing_ok=True)


def load_checkpoint(path: Path, description: Mapping[str, object]) -> Array:
    """Points (n, 3) to go on from; raise `MeshError` where there are none, or they belong to another generation."""
    try:
        with np.load(path) as file:
            points, stored = file["points"], dict(json.loads(str(file["description"])).items())
        if points.ndim != 2 or points.shape[1] != 3 or points.dtype != np.float64 or not np.isfinite(points).all():
            raise ValueError("its points are none")
    except FileNotFoundError as error:
        raise MeshError(f"{path}: there is no checkpoint to resume from; start without --resume") from error
    except (OSError, EOFError, LookupError, ValueError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise MeshError(f"{path}: not a readable checkpoint ({error}); remove it and start anew") from error
    for name, value in description.items():
        if stored.get(name) != value:
            raise MeshError(
                f"{path}: the checkpoint was made with {name} = {stored.get(name)}, not {value}; "
                "give the same options, or start without --resume"
            )
    if len(points) != description.get("cells", len(points)):
        raise MeshError(f"{path}: the checkpoint has {len(points)} points, not {description['cells']}; start anew")
    return points

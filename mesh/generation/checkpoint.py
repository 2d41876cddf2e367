"""Checkpoints of a mesh generation: the best points so far, to continue from after an interruption."""

import json
import os
import time
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Self

import numpy as np

from mesh.arrays import Array
from mesh.density.gridded import FileDensity, Shaping
from mesh.density.record import name_of
from mesh.errors import MeshError
from mesh.generation.optimizer import Iterate
from mesh.mesh_request import MeshRequest
from mesh.safe_files import written_aside

SECONDS_BETWEEN = 30.0
"""Most work that a crash can lose."""


def checkpoint_path(output: Path) -> Path:
    """Where the generation of mesh file `output` keeps its checkpoint."""
    return output.with_name(output.name + ".checkpoint.npz")


class CheckpointKeeper:
    """A callback that keeps the iterate of the smallest residual, and writes it to `path` every half minute.

    Only the same `request` may continue from the file. As a context manager, it saves the points if its block fails
    and removes the file if all goes well.
    """

    def __init__(self, path: Path, request: MeshRequest) -> None:
        self._path = path
        self._description = described(request)
        self._best: tuple[float, Array] | None = None
        self._saved = time.monotonic()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.remove()
        else:
            self.save()

    @property
    def has_points(self) -> bool:
        """Whether there are points to continue from."""
        return self._best is not None

    def __call__(self, iterate: Iterate) -> None:
        """Record an iterate."""
        if self._best is None or iterate.residual < self._best[0]:
            # The same array each time: memory that is new to the process costs more than the copy.
            points = np.empty_like(iterate.points) if self._best is None else self._best[1]
            np.copyto(points, iterate.points)
            self._best = (iterate.residual, points)
        if time.monotonic() - self._saved > SECONDS_BETWEEN:
            self.save()

    def save(self) -> bool:
        """Write the best points now; False if there are none yet."""
        if self._best is None:
            return False
        residual, points = self._best
        description = json.dumps(self._description)
        with written_aside(self._path) as aside, aside.open("wb") as file:
            np.savez(file, points=points, residual=residual, description=description)
        self._saved = time.monotonic()
        return True

    def remove(self) -> None:
        """Delete the file."""
        self._path.unlink(missing_ok=True)

    def load(self) -> Array:
        """Points (n, 3) to continue from.

        Raises `MeshError` if there are none, or if they belong to another request.
        """
        path, points, stored = self._path, *_read(self._path)
        for name, value in self._description.items():
            if stored.get(name) != value:
                raise MeshError(
                    f"{path}: the checkpoint was made with {name} = {stored.get(name)}, not {value}; "
                    "give the same options, or start without --resume"
                )
        if len(points) != self._description["cells"]:
            raise MeshError(
                f"{path}: the checkpoint has {len(points)} points, not {self._description['cells']}; start anew"
            )
        return points


def described(request: MeshRequest) -> dict[str, object]:
    """What determines the points of a generation, as words and numbers; its limits do not."""
    density = request.density
    if isinstance(density, FileDensity):
        variable, shaping = density.variable, density.shaping
    else:
        variable = request.density_variable
        shaping = Shaping(request.density_floor, request.density_power, request.density_smoothing)
    return {
        "cells": request.cells,
        "density": os.fspath(density) if isinstance(density, str | os.PathLike) else name_of(density),
        "density variable": variable,
        **{f"density {name}": value for name, value in asdict(shaping).items()},
        "start": request.start,
        "seed": request.seed,
        "method": request.method,
    }


def _read(path: Path) -> tuple[Array, dict[str, object]]:
    """Points (n, 3) in a checkpoint and the description of their mesh; raise `MeshError` if it is unreadable."""
    try:
        with np.load(path) as file:
            points, stored = file["points"], dict(json.loads(str(file["description"])).items())
        if points.ndim != 2 or points.shape[1] != 3 or points.dtype != np.float64 or not np.isfinite(points).all():
            raise ValueError("it holds no valid points")
    except FileNotFoundError as error:
        raise MeshError(f"{path}: there is no checkpoint to resume from; start without --resume") from error
    except (OSError, EOFError, LookupError, ValueError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise MeshError(f"{path}: not a readable checkpoint ({error}); remove it and start anew") from error
    return points, stored

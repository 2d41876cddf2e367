"""Read what a run left in its directory."""

import json
from dataclasses import dataclass
from pathlib import Path

import netCDF4
import numpy as np

from mesh.arrays import Array
from mesh.io import read_mesh
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import SECONDS_PER_DAY
from swe.errors import SetupError
from swe.output import DIAGNOSTICS_FILE, FIELDS, HISTORY_FILE, MESH_FILE, RECORD_FILE, read_series


@dataclass(frozen=True)
class Snapshot:
    """Fields by name at one day since the start."""

    day: float
    fields: dict[str, Array]


@dataclass(frozen=True)
class Run:
    """A run directory: its mesh in metres, the name of the case and the series of diagnostics by name."""

    directory: Path
    mesh: VoronoiMesh
    case: str
    series: dict[str, Array]

    def last_snapshot(self) -> Snapshot:
        """The last snapshot in the history file."""
        with netCDF4.Dataset(self.directory / HISTORY_FILE) as file:
            file.set_auto_mask(False)
            return Snapshot(
                float(file["time"][-1]) / SECONDS_PER_DAY,
                {name: np.asarray(file[name][-1]) for name in FIELDS},
            )


def read_run(directory: Path) -> Run:
    """Open a run directory; raise `SetupError` where it holds no run, `MeshError` where its mesh is not valid."""
    try:
        record = json.loads((directory / RECORD_FILE).read_text())
        series = read_series(directory / DIAGNOSTICS_FILE)
        run = Run(directory, read_mesh(directory / MESH_FILE), str(record["case"]), series)
        run.last_snapshot()
        return run
    except (OSError, json.JSONDecodeError, IndexError, KeyError, TypeError) as error:
        raise SetupError(f"{directory} holds no readable run ({error}); name a directory that a run wrote") from error

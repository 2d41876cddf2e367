"""What studies share: runs that are made once, tables as CSV, fitted orders."""

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mesh.errors import MeshError
from mesh.files.io import mesh_hash
from mesh.plain import recorded
from mesh.safe_files import written_aside
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.runs.reading import Run, read_run
from swe.configuration import Options, SchemeName
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError, RunError
from swe.output.description import ABSENT_CONFIGURATION
from swe.output.files import load_record
from swe.run.case import Case
from swe.run.simulation import Simulation

TABLE_FILE = "study.csv"
CONSERVATION = (
    "mass_change",
    "absolute_vorticity_change",
    "total_energy_change_of_total",
    "potential_enstrophy_change",
)
"""Series of diagnostics that are in the tables."""

Tell = Callable[[str], None]
"""Receives a line about what has been done."""

StudyRow = dict[str, Any]
"""One line of a table by column: numbers and words."""


MOST_DAYS = 1e5


def require_days(days: float) -> None:
    """Raise `InputError` unless runs of a study can last for `days`."""
    if not 0.0 < days <= MOST_DAYS:
        raise InputError(f"runs of a study cannot last {days:g} days; give a number above 0 and up to {MOST_DAYS:g}")


@dataclass(frozen=True)
class Task:
    """A run that a study needs: `case` on `mesh` for `days`, a snapshot every `snapshot_days`, in `directory`.

    `diagnostics_interval` is in seconds; the default time step divides the shorter of the two intervals.
    """

    directory: Path
    case: Case
    mesh: VoronoiMesh
    days: float
    snapshot_days: float
    time_step: float | None = None
    scheme: SchemeName = Options.scheme
    diagnostics_interval: float = Options.diagnostics_interval

    def carry_out(self, progress: bool, tell: Tell) -> tuple[Run | None, str]:
        """The run, made unless it is there already; or None and the reason why it failed."""
        run = self.finished_run()
        if run is not None:
            return run, ""
        tell(f"{self.directory.name}: {self.case.name} to day {self.days:g} on {self.mesh.n_cells} cells")
        try:
            self._run(progress)
        except RunError as error:
            tell(f"{self.directory.name}: {error}")
            return None, str(error)
        return read_run(self.directory), ""

    def _run(self, progress: bool) -> None:
        """Resume the run if the directory holds part of it, else start it."""
        try:
            self._simulation(resume=True).run(until=self.days, progress=progress)
        except InputError:
            self._simulation(resume=False).run(until=self.days, progress=progress)

    def _simulation(self, resume: bool) -> Simulation:
        """The simulation, which resumes the run or replaces what the directory holds."""
        return Simulation(
            self.mesh,
            self.case,
            self.directory,
            time_step=self.time_step,
            snapshot_interval=self.snapshot_days * SECONDS_PER_DAY,
            diagnostics_interval=self.diagnostics_interval,
            scheme=self.scheme,
            resume=resume,
            overwrite=not resume,
        )

    def finished_run(self) -> Run | None:
        """The run in the directory, if it is this run, on this mesh, complete and readable; else None."""
        if not self._is_recorded():
            return None
        try:
            return read_run(self.directory)
        except (InputError, MeshError):
            return None

    def _is_recorded(self) -> bool:
        try:
            record = load_record(self.directory)
            configuration = ABSENT_CONFIGURATION | record["configuration"]
            return bool(
                record["status"] == "completed"
                and record["case"] == self.case.name
                and record["parameters"] == recorded(self.case.parameters())
                and record["days"] == self.days
                and configuration["snapshot_interval"] == self.snapshot_days * SECONDS_PER_DAY
                and configuration["sampling"] == "point"
                and configuration["scheme"] == self.scheme
                and self.time_step in (None, configuration["time_step"])
                and record["mesh_hash"] == mesh_hash(self.mesh.scaled(self.case.radius))
            )
        except (OSError, ValueError, KeyError, TypeError):
            return False


def write_table(rows: Sequence[StudyRow], path: Path) -> None:
    """Write rows as CSV; a column is empty where a row lacks it."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with written_aside(path) as aside, aside.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


def fitted_order(size: Sequence[float], error: Sequence[float]) -> float:
    """Slope of the least-squares line through log(error) over log(size); NaN for fewer than two different sizes."""
    x, y = np.array(size, dtype=float), np.array(error, dtype=float)
    usable = y > 0.0
    if len(np.unique(x[usable])) < 2:
        return float("nan")
    return float(np.polyfit(np.log(x[usable]), np.log(y[usable]), 1)[0])

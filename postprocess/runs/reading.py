"""Read a run directory."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_args

import numpy as np

from mesh.arrays import Array, Index
from mesh.errors import MeshError
from mesh.files.io import read_mesh
from mesh.integrals.quadrature import Sampling
from mesh.safe_files import AnyPath, dataset
from mesh.shown import Rows, Shown, in_words, span
from mesh.voronoi_mesh import VoronoiMesh, share_of_sphere, sphere_in_words
from postprocess.runs.labelled import grid_of_uxarray, opened_by_xarray
from swe.constants import SECONDS_PER_DAY
from swe.diagnostics.outputs import FIELDS
from swe.errors import InputError
from swe.numerics_in_words import numerics_in_words
from swe.output.files import DIAGNOSTICS_FILE, HISTORY_FILE, MESH_FILE, load_record, read_series

if TYPE_CHECKING:
    import uxarray
    import xarray

Progress = Callable[[str, float], None]
"""Takes the name of a task and the fraction of it that is done, 0 to 1."""

DAY_TOLERANCE = 1e-6
"""Snapshots closer together than this, in days, belong to the same day."""

DAYS_TOLD = 8
"""Error messages list up to this many days."""


class _Fields(dict[str, Array]):
    """Fields of a run by name; raises `InputError` for one that the run was not asked to write."""

    def __init__(self, directory: Path, fields: dict[str, Array]) -> None:
        super().__init__(fields)
        self._directory = directory

    def __missing__(self, name: str) -> Array:
        raise InputError(
            f"{self._directory / HISTORY_FILE} holds no {name}; run it again with {name} among its fields (--fields)"
        )


@dataclass(frozen=True, repr=False)
class Snapshot(Shown):
    """Fields by name, on one day since the start."""

    day: float
    fields: dict[str, Array]

    def _title_and_rows(self) -> tuple[str, Rows]:
        units = {name: FIELDS[name].units if name in FIELDS else "" for name in self.fields}
        return f"Snapshot of day {self.day:g}", {name: span(self.fields[name], units[name]) for name in self.fields}


@dataclass(frozen=True, eq=False, repr=False)
class Run(Shown):
    """A run directory: what its record says, and its files, each read on first use.

    `case` is the name of the case and `parameters` are its parameters; `sampling` says how the initial thickness was
    sampled, see `mesh.integrals.quadrature`. `time_step` is the longest step, s, and `steps` the number of steps.
    `days` lists the days of the snapshots; the mesh has `cells` cells. `record` is the content of `run.json`.

    `data` and `diagnostics` keep their files open until `close`, or the end of a `with` block.
    """

    directory: Path
    record: Mapping[str, Any]
    case: str
    parameters: dict[str, float]
    sampling: Sampling
    time_step: float
    steps: int
    days: Array
    cells: int

    def _title_and_rows(self) -> tuple[str, Rows]:
        of_days = "" if "days" not in self.record else f" of {in_words(self.record['days'])}"
        radius = self.parameters.get("radius")
        rows = {
            "folder": str(self.directory),
            "status": f"{self.record.get('status', 'unknown')}, day {self.days[-1]:g}{of_days}",
            "mesh": f"{self.cells} cells" + ("" if radius is None else f" on {sphere_in_words(radius)}"),
            "coast": self._coast_in_words(),
            **numerics_in_words(self.record["configuration"], self.record.get("forcings", [])),
            "step": f"{self.time_step:g} s, {self.steps} steps",
            "snapshots": f"{len(self.days)}, days {days_in_words(self.days)}",
            "fields": ", ".join(self.record.get("fields", FIELDS)),
        }
        return f"Run of {self.case}", rows

    def _coast_in_words(self) -> str:
        """What the file of the mesh tells of its coast, without reading more; empty if it has none or is not there."""
        try:
            with dataset(self.directory / MESH_FILE) as file:
                if np.any(file["boundaryVertex"][:]):
                    radius = float(file.sphere_radius)
                    return share_of_sphere(np.asarray(file["areaCell"][:]), radius) if radius > 0.0 else "walls"
        except (OSError, RuntimeError, LookupError, AttributeError, ValueError):
            pass  # whoever reads the mesh is told what is wrong with it
        return ""

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the files of `data` and `diagnostics`; the next use opens them again."""
        for name in ("data", "diagnostics"):
            opened = vars(self).pop(name, None)
            if opened is not None:
                opened.close()

    @cached_property
    def mesh(self) -> VoronoiMesh:
        """The mesh, in metres; raises `MeshError` where it is not valid."""
        return read_mesh(self.directory / MESH_FILE)

    @cached_property
    def series(self) -> dict[str, Array]:
        """Diagnostics (n,) by name, and their `time`, s."""
        with _readable(self.directory):
            return read_series(self.directory / DIAGNOSTICS_FILE)

    @cached_property
    def data(self) -> "xarray.Dataset":
        """Snapshots and geometry from `history.nc`, read lazily. Needs xarray."""
        return opened_by_xarray(self.directory / HISTORY_FILE)

    @cached_property
    def diagnostics(self) -> "xarray.Dataset":
        """Time series from `diagnostics.nc`: invariants, their changes and budgets, Courant number. Needs xarray."""
        return opened_by_xarray(self.directory / DIAGNOSTICS_FILE)

    @cached_property
    def grid(self) -> "uxarray.Grid":
        """The mesh as a Grid of uxarray, which it needs."""
        return grid_of_uxarray(self.directory / MESH_FILE)

    def snapshot(self, day: float) -> Snapshot:
        """The snapshot of `day`; raise `InputError` if there is none."""
        return self._read(self.number_of(day))

    def number_of(self, day: float) -> int:
        """The number, from 0, of the snapshot of `day`; raise `InputError` if there is none."""
        self.require_snapshot(day)
        return int(np.argmin(np.abs(self.days - day)))

    def numbers_between(self, first: float, last: float) -> Index:
        """Numbers, from 0, of the snapshots from day `first` to day `last`."""
        return np.flatnonzero((self.days >= first - DAY_TOLERANCE) & (self.days <= last + DAY_TOLERANCE))

    def require_snapshot(self, day: float) -> None:
        """Raise `InputError` if there is no snapshot of `day`."""
        if not days_of_both([day], self.days):
            raise InputError(
                f"{self.directory} has no snapshot of day {day:g}; its days are {days_in_words(self.days)}"
            )

    def last_snapshot(self) -> Snapshot:
        """The last snapshot in the history file."""
        return self._read(len(self.days) - 1)

    def field(self, name: str, row: int) -> Array:
        """The field `name` in a row of `days`, read and checked alone; raises `InputError` if it is not there."""
        return self._read(row, (name,)).fields[name]

    def _read(self, row: int, names: Collection[str] = FIELDS) -> Snapshot:
        with _readable(self.directory), dataset(self.directory / HISTORY_FILE) as file:
            file.set_auto_mask(False)
            present = {name: np.asarray(file[name][row]) for name in names if name in file.variables}
        snapshot = Snapshot(float(self.days[row]), _Fields(self.directory, present))
        wrong = [name for name, values in present.items() if not np.isfinite(values).all()]
        if wrong or ("thickness" in present and not present["thickness"].min(initial=np.inf) > 0.0):
            what = f"non-finite {wrong[0]}" if wrong else "non-positive thickness"
            raise InputError(
                f"{self.directory / HISTORY_FILE} has {what} on day {snapshot.day:g}; it is damaged, run it again"
            )
        return snapshot


AnyRun = TypeVar("AnyRun", bound=Run)


def open_run(directory: AnyPath) -> Run:
    """Open the directory of a run that has finished or is still going; raise `InputError` if it holds no run.

    Mesh, fields and diagnostics are read and checked on first use.
    """
    return open_as(Run, directory)


def open_as(kind: type[AnyRun], directory: AnyPath) -> AnyRun:
    """Open the directory of a run as a class derived from `Run`; see `open_run`."""
    directory = Path(directory)
    with _readable(directory):
        record = load_record(directory)
        with dataset(directory / HISTORY_FILE) as file:
            days = np.asarray(file["time"][:]) / SECONDS_PER_DAY
            cells = len(file.dimensions["nCells"])
        configuration = record["configuration"]
        if configuration["sampling"] not in get_args(Sampling):
            raise ValueError(f"its sampling is {configuration['sampling']!r}")
        run = kind(
            directory,
            record,
            case=str(record["case"]),
            parameters=dict(record["parameters"].items()),
            sampling=configuration["sampling"],
            time_step=float(configuration["time_step"]),
            steps=int(record["steps"]),
            days=days,
            cells=cells,
        )
    _require_rows(directory / HISTORY_FILE, run.days)
    return run


def read_run(directory: AnyPath) -> Run:
    """Open a run directory and check it, see `open_run` and `checked`."""
    return checked(open_run(directory))


def checked(run: Run) -> Run:
    """Read the mesh, the diagnostics and the last snapshot of a run, and return the run.

    Raises `InputError` if they cannot be read or do not fit together, and `MeshError` if the mesh is not valid.
    """
    _require_rows(run.directory / DIAGNOSTICS_FILE, run.series["time"])
    with _readable(run.directory):
        _require_sizes(run.last_snapshot(), run)
    return run


@contextmanager
def _readable(directory: Path) -> Iterator[None]:
    """Raise `InputError` if a file of the run directory is missing, or is not what a run writes."""
    try:
        yield
    except (MeshError, InputError):
        raise
    except (OSError, RuntimeError, ValueError, AttributeError, LookupError, TypeError, ArithmeticError) as error:
        reason: object = error if directory.exists() else "there is no such folder"
        raise InputError(f"{directory} holds no readable run ({reason}); name a directory that a run wrote") from error


def _require_rows(path: Path, times: Array) -> None:
    """Raise `InputError` if a file has no rows, or its times do not ascend."""
    if not len(times):
        raise InputError(f"{path} has no rows; the run was killed at its start, run it again")
    if not np.all(np.diff(times, prepend=-1.0) > 0.0):
        raise InputError(f"{path} has times that do not ascend; it is damaged, run it again")


def _require_sizes(snapshot: Snapshot, run: Run) -> None:
    """Raise `InputError` if the fields of `snapshot` do not fit the mesh of `run`."""
    places = {"nCells": run.mesh.n_cells, "nEdges": run.mesh.n_edges, "nVertices": run.mesh.n_vertices}
    for name in snapshot.fields:
        place = FIELDS[name].place
        if snapshot.fields[name].shape != (places[place],):
            raise InputError(
                f"{run.directory / HISTORY_FILE} has {snapshot.fields[name].size} values of {name}, but "
                f"{MESH_FILE} beside it needs {places[place]}; put the files of one run together"
            )


def days_in_words(days: Iterable[float]) -> str:
    """Days as part of a sentence; a long list is shortened in the middle."""
    shown = [f"{day:g}" for day in days]
    if len(shown) > DAYS_TOLD:
        shown = [*shown[:3], "...", shown[-1]]
    return ", ".join(shown)


def days_of_both(days: Iterable[float], others: Iterable[float]) -> list[float]:
    """Those of `days` that are among `others`, up to round-off."""
    known = np.array(list(others))
    return [day for day in days if np.any(np.abs(known - day) < DAY_TOLERANCE)]

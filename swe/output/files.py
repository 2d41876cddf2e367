"""The files of a run directory: the mesh, snapshots, diagnostics and the record of the run (DESIGN, section 5).

Files that grow use the classic format with 64-bit offsets: rows follow one another, so that a file stays readable
whatever happens to the program, and rows can be written again. Identical runs write identical files, byte for byte.
"""

import json
import time as clock
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from mesh.arrays import Array
from mesh.conventions import BY_NAME, MeshOutline, coordinates_on
from mesh.files.io import define_mesh_variables, fill_variables, mesh_attributes
from mesh.safe_files import dataset, definitions, netcdf_lock, opened_dataset, written_aside
from swe.diagnostics.budgets import rate_series
from swe.diagnostics.outputs import FIELDS, PLACES, SERIES, TOPOGRAPHY, Evaluation, Field, Series, diagnostics_row
from swe.equations.model import ShallowWaterModel
from swe.errors import InputError, RunError
from swe.output.description import RunDescription
from swe.parallel.processes import Processes

HISTORY_FILE = "history.nc"
DIAGNOSTICS_FILE = "diagnostics.nc"
MESH_FILE = "mesh.nc"
RECORD_FILE = "run.json"
FIGURES_FOLDER = "figures"

SECONDS_BETWEEN_WRITES = 1.0
"""Rows of diagnostics are written in batches, as each write takes as long as many rows."""

GEOMETRY = frozenset(BY_NAME) - {
    *("n_edges_on_edge", "edges_on_edge", "weights_on_edge", "kite_areas_on_vertex"),
    *("angle_edge", "mesh_density", "boundary_vertex"),
}
"""Mesh arrays repeated in the history file, so that it can be plotted and integrated on its own."""

TIME_COORDINATE = "Time"

PACKAGES = ("trisk", "numpy", "scipy", "numba", "netCDF4")


def create_history(path: Path, run: RunDescription, description: Mapping[str, Any]) -> None:
    """Create a history file without snapshots; raise `RunError` if it cannot be written.

    Its attributes come from what `described` says of the run.
    """
    model, processes = run.model, run.processes
    topography = processes.gathered("cells", model.topography)
    processes.on_first(lambda: _create_history(path, run, description, topography))


def _create_history(path: Path, run: RunDescription, description: Mapping[str, Any], topography: Array) -> None:
    with run.mesh.opened() as (mesh, slabs), _new_file(path) as file:
        identity = mesh_attributes(mesh, "snapshots of a shallow-water run", description["mesh_hash"])
        with definitions(file):
            file.setncatts({**identity, **_attributes(run.model, description)})
            define_mesh_variables(file, mesh, GEOMETRY)
            _define_time(file)
            _define_field(file, "topography", (TOPOGRAPHY.place,), TOPOGRAPHY, mesh)
            for name in run.fields:
                _define_field(file, name, ("Time", FIELDS[name].place), FIELDS[name], mesh)
                file[name].cell_methods = FIELDS[name].cell_methods(TIME_COORDINATE)
        fill_variables(file, mesh, slabs, GEOMETRY)
        file["topography"][:] = topography


def create_diagnostics(
    path: Path, run: RunDescription, series: Mapping[str, Series], description: Mapping[str, Any]
) -> None:
    """Create a diagnostics file without rows, for `series`; raise `RunError` if it cannot be written."""
    run.processes.on_first(lambda: _create_diagnostics(path, run.model, series, description))


def _create_diagnostics(
    path: Path, model: ShallowWaterModel, series: Mapping[str, Series], description: Mapping[str, Any]
) -> None:
    with _new_file(path) as file, definitions(file):
        file.setncatts({"Conventions": "CF-1.8", "source": "trisk", **_attributes(model, description)})
        _define_time(file)
        for name, each in series.items():
            _define(file, name, ("Time",), each.units, each.meaning)


def _attributes(model: ShallowWaterModel, description: Mapping[str, Any]) -> dict[str, object]:
    """Global attributes that identify the run of a file; nothing that differs between identical runs.

    The slip along walls is told where there is some, so that files of runs without coasts stay as they were.
    """
    configuration = description["configuration"]
    told = {name: value for name, value in configuration.items() if name != "scheme"}
    if told["wall_slip"] == 0.0:
        del told["wall_slip"]
    return {
        "title": f"{description['case']}, a run of the shallow-water model of trisk",
        "case": description["case"],
        "parameters": json.dumps(description["parameters"]),
        "mesh_hash": description["mesh_hash"],
        "scheme": f"{model.scheme.name}: {model.scheme.source}",
        **told,
        "trisk_version": package_versions()["trisk"],
    }


@contextmanager
def _new_file(path: Path) -> Iterator[netCDF4.Dataset]:
    """A file to define and fill. One that cannot be written is left open: the library does not survive closing it."""
    with netcdf_lock:
        try:
            file = opened_dataset(path, "w", format="NETCDF3_64BIT_OFFSET")
            file.set_fill_off()
            yield file
            file.sync()
        except (OSError, RuntimeError) as error:
            raise RunError(f"{path} cannot be written ({error}); is the disk full?") from error
        file.close()


class _TimeFile:
    """A file that grows along time; the first `rows` stay, all by default, and what follows them is cut off.

    The first of the `processes` has it open, and alone knows of what is written since.

    Raises `InputError` if the file cannot be continued: it cannot be read, lacks a variable, is shorter than `size`
    bytes, or the times of its first `rows` do not increase.
    """

    def __init__(
        self, path: Path, names: Iterable[str], processes: Processes, rows: int | None = None, size: int = 0
    ) -> None:
        self._path = path
        self._failed = False
        self.processes = processes
        self._file: netCDF4.Dataset | None = None
        self.rows = processes.on_first(lambda: self._open(names, rows, size))

    def _open(self, names: Iterable[str], kept: int | None, size: int) -> int:
        """Open the file; return the number of its rows."""
        path = self._path
        with netcdf_lock:
            try:
                file = _opened(path)
                present = len(file.dimensions["Time"])
                missing = {"time", *names} - set(file.variables)
            except (OSError, RuntimeError, KeyError) as error:
                raise InputError(f"{path} cannot be opened to go on ({error}); start anew (--force)") from error
            rows = present if kept is None else kept
            times = np.asarray(file["time"][:rows]) if not missing else np.empty(0)
            if missing or rows > present or path.stat().st_size < size or np.any(np.diff(times, prepend=-1.0) <= 0.0):
                file.close()
                raise InputError(f"{path} is not what its run had written, {rows} rows; start anew (--force)")
            if rows < present:
                file.close()
                _cut_off(path, rows, size)
                file = _opened(path)
            file.set_fill_off()
        self._file = file
        return rows

    @property
    def size(self) -> int:
        """Bytes of the file."""
        return self._path.stat().st_size

    def _put(self, values: Mapping[str, Array]) -> None:
        """Write rows (n, ...) of some variables after those that are counted."""
        assert self._file is not None
        with self._writing():
            for name, value in values.items():
                self._file[name][self.rows : self.rows + len(value)] = value

    def _finish(self, times: Array) -> None:
        """Write the times (n,), s, of the rows of which everything else is written, so that they count."""
        assert self._file is not None
        known = [name for name in ("time", TIME_COORDINATE) if name in self._file.variables]  # earlier versions: one
        self._put(dict.fromkeys(known, times))
        with self._writing():
            self._file.sync()
        self.rows += len(times)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            with netcdf_lock:
                yield
        except (OSError, RuntimeError) as error:
            self._failed = True
            raise RunError(f"{self._path} cannot be written ({error}); is the disk full?") from error

    def close(self) -> None:
        """Close the file; one that could not be written is left alone, as the library does not survive closing it."""
        if self._file is not None and not self._failed:
            with netcdf_lock:
                self._file.close()


def _opened(path: Path) -> netCDF4.Dataset:
    """The file, open for reading and writing."""
    file = opened_dataset(path, "r+")
    # Values are written as they are; looking for masks and scales takes as long as writing them.
    file.set_auto_maskandscale(False)
    return file


def _cut_off(path: Path, rows: int, size: int) -> None:
    """Keep only the first `rows` rows of a file in the classic format, which then has `size` bytes."""
    with path.open("r+b") as file:
        file.seek(4)  # the number of rows follows the letters that name the format
        file.write(rows.to_bytes(4, "big"))
        file.truncate(size)


class HistoryFile(_TimeFile):
    """Snapshots of some `fields`, written one by one."""

    def __init__(
        self, path: Path, fields: tuple[str, ...], processes: Processes, rows: int | None = None, size: int = 0
    ) -> None:
        super().__init__(path, fields, processes, rows, size)
        self._fields = fields

    def append(self, now: Evaluation) -> None:
        """Write the snapshot of a state, one whole field after another."""
        for name in self._fields:
            field = FIELDS[name]
            whole = self.processes.gathered(PLACES[field.place], field.value(now))
            self.processes.on_first(partial(self._put, {name: whole[None]}))
        self.processes.on_first(lambda: self._finish(np.array([now.time])))


class DiagnosticsFile(_TimeFile):
    """The given `series` by name; rows wait up to a second and are written together."""

    def __init__(
        self, path: Path, series: Mapping[str, Series], processes: Processes, rows: int | None = None, size: int = 0
    ) -> None:
        super().__init__(path, series, processes, rows, size)
        self._series = series
        self._waiting: list[dict[str, float]] = []
        self._written = clock.monotonic()
        self._last = processes.on_first(self._last_row)

    def _last_row(self) -> dict[str, float] | None:
        if self.rows == 0:
            return None
        assert self._file is not None
        with netcdf_lock:
            return {name: float(self._file[name][self.rows - 1]) for name in ("time", *self._series)}

    def append(self, now: Evaluation) -> None:
        """Add the row for a state."""
        row = self._last = diagnostics_row(now, self._series, self._last)
        self.processes.on_first(lambda: self._add(row))

    def _add(self, row: dict[str, float]) -> None:
        self._waiting.append(row)
        if self.rows == 0 or clock.monotonic() - self._written > SECONDS_BETWEEN_WRITES:
            self.flush()

    def flush(self) -> None:
        """Write the waiting rows; the first process does it alone."""
        waiting, self._waiting = self._waiting, []
        if waiting:
            rows = {name: np.array([row[name] for row in waiting]) for name in waiting[0]}
            times = rows.pop("time")
            self._put(rows)
            self._finish(times)
        self._written = clock.monotonic()

    def close(self) -> None:
        """Write the waiting rows and close the file; writing may raise `RunError`."""
        try:
            self.flush()
        finally:
            super().close()


def read_record(directory: Path) -> dict[str, object] | None:
    """The contents of `run.json`, None if there is none; raise `InputError` if it is not the record of a run."""
    path = directory / RECORD_FILE
    try:
        return load_record(directory)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except TypeError as error:
        raise InputError(f"{path} is not the record of a run; remove it or choose another directory") from error
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(
            f"{path} is not the record of a run ({error}); remove it or choose another directory"
        ) from error


def load_record(directory: Path) -> dict[str, Any]:
    """The contents of `run.json`; raises any error of reading it, or `TypeError` if it is not the record of a run."""
    record = json.loads((directory / RECORD_FILE).read_text())
    if not isinstance(record, dict):
        raise TypeError(f"{RECORD_FILE} is not the record of a run")
    return record


def write_record(directory: Path, record: dict[str, object]) -> None:
    """Write `run.json`, replacing an earlier one as a whole."""
    with written_aside(directory / RECORD_FILE) as aside:
        aside.write_text(json.dumps(record, indent=2) + "\n")


def package_versions() -> dict[str, str]:
    """Versions of this package and of the packages that results depend on."""
    versions = {}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return versions


def _define_field(
    file: netCDF4.Dataset, name: str, dimensions: tuple[str, ...], field: Field, mesh: MeshOutline
) -> None:
    _define(file, name, dimensions, field.units, field.meaning)
    file[name].coordinates = coordinates_on(mesh)[dimensions[-1]]
    if field.standard_name:
        file[name].standard_name = field.standard_name


def _define(file: netCDF4.Dataset, name: str, dimensions: tuple[str, ...], units: str, long_name: str) -> None:
    variable = file.createVariable(name, "f8", dimensions)
    variable.setncatts({"units": units, "long_name": long_name})


def _define_time(file: netCDF4.Dataset) -> None:
    """Define `time`, and a copy named like the dimension, which makes it a coordinate to select by."""
    file.createDimension("Time", None)
    attributes = {
        "units": "seconds since 2000-01-01 00:00:00",
        "long_name": "time since the start of the run",
        "calendar": "proleptic_gregorian",
    }
    file.createVariable("time", "f8", ("Time",)).setncatts(attributes)
    file.createVariable(TIME_COORDINATE, "f8", ("Time",)).setncatts(
        {**attributes, "standard_name": "time", "axis": "T"}
    )


def read_series(path: Path) -> dict[str, Array]:
    """All series of a diagnostics file by name, including `time`; runs of earlier versions have no rates."""
    with dataset(path) as file:
        optional = set(rate_series()) - set(file.variables)
        names = ["time", *(name for name in SERIES if name not in optional)]
        of_terms = [name for name in file.variables if name not in (*names, TIME_COORDINATE)]
        return {name: np.asarray(file[name][:]) for name in (*names, *of_terms)}

"""Fields by name, as maps show them: values on a mesh, their label and their title."""

import re
from dataclasses import dataclass

import netCDF4
import numpy as np

from mesh.arrays import Array
from mesh.conventions import MESH_VARIABLES, MeshVariable
from mesh.safe_files import dataset
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.patches import require_place
from postprocess.runs.reading import Run
from swe.errors import InputError
from swe.output.files import HISTORY_FILE

DIMENSIONS = ("nCells", "nEdges", "nVertices")
"""Of fields in history files that a map shows."""

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

MESH_FIELDS = {
    variable.name: variable
    for variable in MESH_VARIABLES
    if variable.dimensions in (("n_cells",), ("n_edges",), ("n_vertices",))
}
"""Arrays of a mesh that a map shows."""


@dataclass(frozen=True, eq=False)
class ShownField:
    """Values (n,) for each cell, edge or vertex of a mesh, their label on a colour bar and the title of their map.

    Colours are those of the field called `name`, see `postprocess.figures.palettes`.
    """

    mesh: VoronoiMesh
    values: Array
    label: str
    title: str = ""
    name: str = ""


def snapshot_field(run: Run, name: str, time: int) -> ShownField:
    """A field of the snapshot of number `time`, from the end where that is negative, or of the run's mesh.

    Raises `InputError` where there is no such field or snapshot.
    """
    path = run.directory / HISTORY_FILE
    _require_number(run, time)
    try:
        with dataset(path) as file:
            file.set_auto_mask(False)
            names = [each for each, variable in file.variables.items() if _is_field(variable)]
            if name not in names:
                # What most people look for comes first.
                names.sort(key=lambda each: file[each].dimensions[0] != "Time")
                return mesh_field(run.mesh, name, names)
            variable = file[name]
            values = np.asarray(variable[time] if variable.dimensions[0] == "Time" else variable[:], dtype=float)
            label = _label(str(getattr(variable, "long_name", name)), str(getattr(variable, "units", "")))
    except (OSError, RuntimeError) as error:
        raise InputError(f"{path} cannot be read ({error}); name a directory that a run wrote") from error
    return ShownField(run.mesh, values, label, f"{run.case}, {run.cells} cells, day {run.days[time]:g}", name)


def given_to_run(run: Run, values: Array, time: int) -> ShownField:
    """Values from the caller on the mesh of a run: of one time, or a row for each snapshot, of which `time` is taken.

    Raises `InputError` where they do not fit the mesh, or where there is no such snapshot.
    """
    if np.ndim(values) == 2 and len(values) == len(run.days):
        _require_number(run, time)
        values = values[time]
    return given_field(run.mesh, values)


def _require_number(run: Run, time: int) -> None:
    """Raise `InputError` where a run has no snapshot of the number `time`."""
    if not -len(run.days) <= time < len(run.days):
        raise InputError(
            f"{run.directory / HISTORY_FILE} has {len(run.days)} snapshots, and none of number {time}; count from 0"
        )


def mesh_field(mesh: VoronoiMesh, name: str, others: list[str] | None = None) -> ShownField:
    """An array of a mesh; raise `InputError`, which names the `others` too, where there is none of this name."""
    if name not in MESH_FIELDS:
        known = ", ".join([*(others or ()), *MESH_FIELDS])
        raise InputError(f"there is no field named '{name}'; choose among {known}")
    variable = MESH_FIELDS[name]
    units = "" if _is_length(variable) and mesh.sphere_radius == 1.0 else variable.units
    return ShownField(mesh, np.asarray(getattr(mesh, name), dtype=float), _label(variable.long_name, units), name=name)


def given_field(mesh: VoronoiMesh, values: object) -> ShownField:
    """Values from the caller, labelled by their attributes where they have any, as arrays of xarray do.

    Raises `InputError` unless there is one for each cell, edge or vertex.
    """
    array = np.asarray(values, dtype=float)
    require_place(mesh, array)
    attributes = getattr(values, "attrs", {})
    name = str(getattr(values, "name", None) or "")
    meaning = str(attributes.get("long_name") or name)
    return ShownField(mesh, array, _label(meaning, str(attributes.get("units", ""))), name=name)


def _is_field(variable: netCDF4.Variable) -> bool:
    of_place = variable.dimensions[-1:] in [(dimension,) for dimension in DIMENSIONS]
    return of_place and variable.dimensions[:-1] in ((), ("Time",)) and variable.dtype.kind == "f"


def changing_fields(file: netCDF4.Dataset) -> dict[str, str]:
    """Fields that each snapshot of an open history holds, and the dimension of their place."""
    return {
        name: variable.dimensions[1]
        for name, variable in file.variables.items()
        if variable.dimensions in [("Time", place) for place in DIMENSIONS]
    }


def _is_length(variable: MeshVariable) -> bool:
    """Whether values are lengths or areas, which have no units on the unit sphere."""
    return variable.units in ("m", "m2")


def _label(name: str, units: str) -> str:
    """What the name says before its first comma, and units in print, as in "kinetic energy (m² s⁻²)"."""
    name, *_ = name.split(",")
    printed = printed_units(units)
    return f"{name} ({printed})".strip() if printed else name


def printed_units(units: str) -> str:
    """Units in print, as in "m² s⁻²"; empty where there are none."""
    if units in ("", "1"):
        return ""
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda power: power.group().translate(SUPERSCRIPTS), units)

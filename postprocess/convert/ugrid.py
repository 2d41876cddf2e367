"""A run as one NetCDF file in the conventions UGRID-1.0 and CF-1.11."""

import json
from pathlib import Path

import netCDF4
import numpy as np

from mesh.safe_files import dataset, written_aside
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.convert.contents import Contents
from postprocess.convert.ugrid_mesh import (
    FACE_AREA,
    LOCATIONS,
    define_mesh,
    fill_mesh,
    place_attributes,
    surface_attributes,
)
from postprocess.runs.reading import Progress, Run
from swe.diagnostics.outputs import Field
from swe.errors import RunError

TIME = "time"


def write_ugrid(contents: Contents, path: Path, history: str, progress: Progress) -> list[Path]:
    """Write the mesh and all snapshots to `path`, which appears when it is whole; return it in a list.

    `history` says how the file was made. Raises `RunError` where it cannot be written.
    """
    run = contents.run
    try:
        with written_aside(path) as aside, dataset(aside, "w", format="NETCDF4") as file:
            file.set_fill_off()
            file.setncatts(_attributes(run, history))
            define_mesh(file, run.mesh)
            _define_time(file, len(run.days))
            for name, (field, _) in contents.fixed.items():
                _define_field(file, run.mesh, name, field, (LOCATIONS[field.place],))
            for name, field in contents.fields.items():
                _define_field(file, run.mesh, name, field, (TIME, LOCATIONS[field.place]))
                file[name].cell_methods = field.cell_methods(TIME)
            fill_mesh(file, run.mesh)
            _fill_fields(file, contents, progress)
    except (OSError, RuntimeError) as error:
        raise RunError(f"{path} cannot be written ({error}); is the disk full?") from error
    return [path]


def _fill_fields(file: netCDF4.Dataset, contents: Contents, progress: Progress) -> None:
    for name, (_, values) in contents.fixed.items():
        file[name][:] = values
    file[TIME][:] = contents.times
    for number, snapshot in contents.snapshots(progress):
        for name in contents.fields:
            file[name][number] = snapshot.fields[name]


def _attributes(run: Run, history: str) -> dict[str, object]:
    """Global attributes."""
    return {
        "Conventions": "CF-1.11 UGRID-1.0",
        "title": f"{run.case}, a run of the shallow-water model of trisk",
        "source": f"trisk {run.record.get('versions', {}).get('trisk', 'of an unknown version')}",
        "history": history,
        "case": run.case,
        "parameters": json.dumps(run.parameters),
        **surface_attributes(run.mesh),
        "mesh_hash": str(run.record.get("mesh_hash", "")),
    }


def _define_time(file: netCDF4.Dataset, count: int) -> None:
    file.createDimension(TIME, count)
    file.createVariable(TIME, "f8", (TIME,), fill_value=False).setncatts(
        {
            "standard_name": "time",
            "long_name": "time since the start of the run",
            "units": "seconds since 2000-01-01 00:00:00",
            "calendar": "proleptic_gregorian",
            "units_metadata": "leap_seconds: none",
            "axis": "T",
        }
    )


def _define_field(
    file: netCDF4.Dataset, mesh: VoronoiMesh, name: str, field: Field, dimensions: tuple[str, ...]
) -> None:
    location = dimensions[-1]
    variable = file.createVariable(name, np.float64, dimensions, fill_value=False)
    variable.setncatts({"units": field.units, "long_name": field.meaning, **place_attributes(mesh, location)})
    if field.standard_name:
        variable.standard_name = field.standard_name
    if location == "face":
        variable.cell_measures = f"area: {FACE_AREA}"

"""The density of a mesh that follows the kinetic energy of a run, after Ju, Ringler and Gunzburger (2011), section 4.2.

rho = max(FLOOR, KE / KEmax)^POWER, KE being smoothed before by passes over neighbouring cells. Spacings go like
rho^(-1/4), so that they vary by 1 / FLOOR; with the milder floor and power by 2.4 (docs/adaptation.md says what each
gives).
"""

from pathlib import Path

import numpy as np

from mesh.arrays import Array
from mesh.conventions import BY_NAME
from mesh.mesh_request import MeshRequest
from mesh.safe_files import dataset, written_aside
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.runs.reading import Run
from swe.errors import InputError

VARIABLE = "kinetic_energy"
FLOOR, POWER, SMOOTHING = 0.1, 4.0, 20
MILD_FLOOR, MILD_POWER = 0.001, 0.5
"""Those of rounds of adaptation: the smallest cell sets the time step for all, here by half instead of by ten."""

AVERAGED_SHARE = 0.5
"""Means in time go over the snapshots of this last part of a run, which has then forgotten how it began."""


def time_mean(run: Run, field: str, first: float | None = None, last: float | None = None) -> Array:
    """The mean of a field over the snapshots of the second half of a run, or from day `first` to day `last` of it."""
    last = run.days[-1] if last is None else last
    first = last - AVERAGED_SHARE * (last - run.days[0]) if first is None else first
    rows = run.numbers_between(first, last)
    if not len(rows):
        raise InputError(f"{run.directory} has no snapshot from day {first:g} to day {last:g}; run it again")
    snapshots = (run.field(field, int(row)) for row in rows)
    total = 0.0 + next(snapshots)
    for values in snapshots:
        total += values
    return total / len(rows)


def smoothed(mesh: VoronoiMesh, values: Array, passes: int) -> Array:
    """Values (n_cells,) after so many passes of the mean over each cell and its neighbours."""
    there = mesh.on_ring & (mesh.cells_on_cell >= 0)
    neighbours, count = np.where(there, mesh.cells_on_cell, 0), 1 + there.sum(axis=1)
    for _ in range(passes):
        values = (values + np.where(there, values[neighbours], 0.0).sum(axis=1)) / count
    return values


def write_energy(run: Run, path: Path) -> None:
    """Write the smoothed mean kinetic energy of a run, over its largest value, for a mesh to take as its density.

    Raises `InputError` where nothing moves.
    """
    energy = smoothed(run.mesh, time_mean(run, VARIABLE), SMOOTHING)
    if not energy.max() > 0.0:
        raise InputError(f"{run.directory} has no kinetic energy that a mesh could follow; run it for longer")
    with written_aside(path) as aside, dataset(aside, "w") as file:
        file.createDimension("nCells", run.cells)
        for name in ("x_cell", "y_cell", "z_cell"):
            coordinate = file.createVariable(BY_NAME[name].file_name, "f8", ("nCells",))
            coordinate[:] = getattr(run.mesh, name)
        variable = file.createVariable(VARIABLE, "f8", ("nCells",))
        variable.setncatts({"units": "1", "long_name": "smoothed mean kinetic energy over its largest value"})
        variable[:] = energy / energy.max()


def request_for(cells: int, path: Path, tolerance: float, floor: float = FLOOR, power: float = POWER) -> MeshRequest:
    """A mesh of so many cells, of a residual of `tolerance`, for what `write_energy` has written to `path`."""
    return MeshRequest(
        cells,
        path,
        tolerance=tolerance,
        density_variable=VARIABLE,
        density_floor=floor,
        density_power=power,
    )


def asked_spacing(density: Array, area: Array) -> Array:
    """Spacings (n_cells,) that go like density^(-1/4), of so many cells that together they have the `area`, squared.

    The hexagon of spacing h has the area sqrt(3)/2 h^2.
    """
    shape = density**-0.25
    return shape * np.sqrt(area.sum() / (np.sqrt(3.0) / 2.0 * (shape**2).sum()))

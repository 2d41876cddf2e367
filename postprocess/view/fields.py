"""Fields that a page shows: those of the snapshots, the topography, and the measures of the mesh."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.density.record import density_of
from mesh.discrete.quality import centroid_offsets, neighbour_distance_ratio
from mesh.safe_files import dataset
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.shown_fields import changing_fields, printed_units
from postprocess.runs.reading import Run
from swe.constants import SQUARE_METRES_PER_SQUARE_KILOMETRE
from swe.diagnostics.outputs import CELLS
from swe.errors import InputError
from swe.output.files import HISTORY_FILE

ROUNDING = 1e-9
"""Measures that differ by less, relative to the largest, are those of regular cells, and the same."""

SMALL = 0.01
"""Square kilometres: areas of smaller cells are told in square metres."""


@dataclass(frozen=True, eq=False)
class PageField:
    """A field by `name`: what it is, its units in print, the dimension of its place, and its values (n_rows, n).

    There is one row for each snapshot, or a single one for what stays the same.
    """

    name: str
    meaning: str
    units: str
    place: str
    values: Array


def history_names(run: Run) -> dict[str, str]:
    """Places of the fields in the history of a run, by name: those of snapshots first, then what stays the same."""
    with dataset(run.directory / HISTORY_FILE) as file:
        fixed = {"topography": file["topography"].dimensions[-1]} if "topography" in file.variables else {}
        return changing_fields(file) | fixed


def history_fields(run: Run, names: Sequence[str]) -> Iterator[PageField]:
    """The fields of these `names`, one after another, as whole histories take much memory.

    Raises `InputError` where there is no such field, or the file is damaged.
    """
    known = history_names(run)
    path = run.directory / HISTORY_FILE
    for name in names:
        if name not in known:
            raise InputError(f"{path} has no field named '{name}'; choose among {', '.join(known)}")
        try:
            with dataset(path) as file:
                file.set_auto_mask(False)
                variable = file[name]
                values = np.atleast_2d(np.asarray(variable[:], dtype=float))
                meaning, units = str(getattr(variable, "long_name", name)), str(getattr(variable, "units", ""))
        except (OSError, RuntimeError) as error:
            raise InputError(f"{path} cannot be read ({error}); run it again") from error
        if not np.isfinite(values).all():
            raise InputError(f"{path} has values of {name} that are not finite; it is damaged, run it again")
        yield PageField(name, meaning.split(",")[0], printed_units(units), known[name], values)


def mesh_measures(mesh: VoronoiMesh) -> Iterator[PageField]:
    """Area, regularity and distance from the centroid of each cell; the last one where the density is known."""
    area, unit = _areas(mesh)
    yield PageField("cell area", "area of the cell", unit, CELLS, _without_rounding(area)[None, :])
    sigma = _without_rounding(neighbour_distance_ratio(mesh))
    yield PageField("sigma", "shortest over longest distance to a neighbour", "", CELLS, sigma[None, :])
    density, _ = density_of(mesh)
    if density is not None:
        offsets = centroid_offsets(mesh, density)
        meaning = "distance from the generator to the centroid of its cell, in mean spacings"
        yield PageField("distance to centroid", meaning, "", CELLS, offsets[None, :])


def _areas(mesh: VoronoiMesh) -> tuple[Array, str]:
    """Areas of cells (n_cells,), and their unit."""
    if mesh.sphere_radius == 1.0:
        return mesh.area_cell, "sr"
    if mesh.area_cell.max() < SMALL * SQUARE_METRES_PER_SQUARE_KILOMETRE:
        return mesh.area_cell, "m²"
    return mesh.area_cell / SQUARE_METRES_PER_SQUARE_KILOMETRE, "km²"


def _without_rounding(values: Array) -> Array:
    """Values (n,), all at their mean where only round-off tells them apart: colours would show nothing else."""
    if np.ptp(values) < ROUNDING * np.abs(values).max():
        return np.full_like(values, values.mean())
    return values

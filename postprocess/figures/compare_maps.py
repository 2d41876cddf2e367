"""Maps of compared runs: each field of all runs, and their differences from the reference, on one equal-area view.

Runs on different meshes are sampled at the same pixels, of a Mollweide map or of a plane, with one colour scale.
Differences are taken where the run has the field, as the norms do, and then sampled: interpolation blurs them slightly,
but adds no error of its own to them.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from mesh.arrays import Array
from mesh.safe_files import AnyPath
from postprocess.compare.comparison import Comparison, fields_of, fields_on
from postprocess.compare.solutions import RunSolution, Solution
from postprocess.figures.palettes import Colours, colours_for, deviation_colours
from postprocess.figures.paper import Raster, globe_raster, paper_of
from postprocess.figures.plots import DOTS_PER_INCH
from postprocess.runs.folders import prepared_folder

WIDTH, WIDTH_OF_ONE = 9.6, 6.6
"""Inches of figures with two maps beside each other, and with one: letters are then legible on a page of the former."""


@dataclass(frozen=True)
class MapField:
    """A field on maps: its title, its unit in SI units, and what the colour bars of it and of its difference show.

    `colours` is its name in `postprocess.figures.palettes`, and so is `error_colours` where differences are magnitudes.
    """

    title: str
    unit: float
    label: str
    colours: str
    difference_label: str
    error_colours: str = ""


MAP_FIELDS = {
    "thickness": MapField("Thickness", 1.0, "thickness (m)", "thickness", "difference in thickness (m)"),
    "velocity": MapField(
        "Velocity", 1.0, "speed (m s⁻¹)", "speed", "length of the difference in velocity (m s⁻¹)", "velocity_error"
    ),
    "vorticity": MapField(
        "Relative vorticity",
        1e-5,
        "relative vorticity (10⁻⁵ s⁻¹)",
        "relative_vorticity",
        "difference in relative vorticity (10⁻⁵ s⁻¹)",
    ),
}

Values = dict[str, Array]
"""Values (rows * columns,) of each field."""


def write_maps(comparison: Comparison, folder: AnyPath) -> list[Path]:
    """Write maps of all fields and differences on the last day that was compared to `folder`; return their paths."""
    folder = prepared_folder(folder)
    day = comparison.days[-1]
    raster = paper_of(comparison.compared[0].mesh).raster
    longitude, latitude = raster.places
    reference, compared = comparison.solution, [RunSolution(run) for run in comparison.compared]
    values = [_values(solution, longitude, latitude, day) for solution in (reference, *compared)]
    differences = [_differences(solution, reference, longitude, latitude, day) for solution in compared]
    names = [solution.name for solution in (reference, *compared)]
    paths = []
    for name, field in MAP_FIELDS.items():
        heading = f"{field.title}: {comparison.case}, day {day:g}"
        panels = [each[name] / field.unit for each in values]
        figure = map_figure(panels, names, heading, field.label, colours_for(field.colours, panels), raster)
        paths.append(_save(figure, folder, name_of_map(name, day)))
        panels = [each[name] / field.unit for each in differences]
        heading += f"\ndifference from the reference, {reference.name}"
        colours = _colours_of_errors(field, panels)
        figure = map_figure(panels, names[1:], heading, field.difference_label, colours, raster)
        paths.append(_save(figure, folder, name_of_map(name, day, difference=True)))
    return paths


def name_of_map(field: str, day: float, difference: bool = False) -> str:
    """Name of the file, without its ending, of the maps of a field of `MAP_FIELDS` or of its difference."""
    return f"compare_{field}{'_difference' if difference else ''}_day{day:g}"


def _save(figure: Figure, folder: Path, name: str) -> Path:
    path = folder / f"{name}.png"
    figure.savefig(path, dpi=DOTS_PER_INCH)
    return path


def _values(solution: Solution, longitude: Array, latitude: Array, day: float) -> Values:
    return {
        "thickness": solution.thickness(longitude, latitude, day),
        "velocity": np.hypot(*solution.velocity(longitude, latitude, day)),
        "vorticity": solution.vorticity(longitude, latitude, day),
    }


def _differences(ours: RunSolution, solution: Solution, longitude: Array, latitude: Array, day: float) -> Values:
    """Differences of a run from a solution at the cells and vertices of the run, sampled at points."""
    run, reference = fields_of(ours.run, day), fields_on(ours.run, solution, day)
    zonal, meridional = (mine - its for mine, its in zip(run.velocity, reference.velocity, strict=True))
    from_cells, from_vertices = ours.from_cells(longitude, latitude), ours.from_vertices(longitude, latitude)
    return {
        "thickness": from_cells.scalar(run.thickness - reference.thickness),
        "velocity": np.hypot(*from_cells.vector(zonal, meridional)),
        "vorticity": from_vertices.scalar(run.vorticity - reference.vorticity),
    }


def map_figure(
    panels: list[Array], titles: list[str], heading: str, label: str, colours: Colours, raster: Raster | None = None
) -> Figure:
    """One map for each of `panels` with one colour scale, by default of the globe; up to two maps beside each other."""
    raster = raster or globe_raster()
    columns = min(len(panels), 2)
    rows = -(-len(panels) // columns)
    width = WIDTH if columns > 1 else WIDTH_OF_ONE
    figure = Figure(figsize=(width, raster.aspect * width / columns * rows + 1.0), layout="constrained")
    grid = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for axes, title, values in zip(grid, titles, panels, strict=False):
        shown = np.where(raster.covered, values, np.nan).reshape(raster.shape)
        drawn = raster.draw(axes, shown, colours.options).images[-1]
        axes.set_title(title, fontsize=9)
    for axes in grid[len(panels) :]:
        axes.axis("off")
    figure.colorbar(drawn, ax=list(grid), location="bottom", shrink=0.7, aspect=40, label=label)
    figure.suptitle(heading, fontsize=11)
    return figure


def _colours_of_errors(field: MapField, panels: list[Array]) -> Colours:
    return colours_for(field.error_colours, panels) if field.error_colours else deviation_colours(panels)

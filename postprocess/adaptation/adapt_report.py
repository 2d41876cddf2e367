"""The page that shows what rounds of adaptation gave."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from mesh.arrays import Array
from mesh.discrete.walls import has_walls
from mesh.geometry.sphere import arc_length, normalize, to_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.adaptation.energy_density import FLOOR, POWER, SMOOTHING, asked_spacing
from postprocess.adaptation.errors import Window, rows_of, windows
from postprocess.adaptation.rounds import Adaptation, Plan
from postprocess.figures.field_map import plot_field
from postprocess.studies.page import table_of, write_page
from postprocess.studies.study_folder import StudyRow, write_table

TABLE_FILE = "adapt.csv"

COLOUR_RANGE = 1000.0
"""Colours span no more than this ratio."""

MESH_COLUMNS = {
    "name": "run",
    "cells": "cells",
    "smallest_km": "smallest spacing (km)",
    "largest_km": "largest (km)",
    "off_the_law": "mean distance from the spacing asked for, of it",
}
ERROR_COLUMNS = {
    "name": "run",
    "time_step_s": "time step (s)",
    "cell_steps": "cells times steps",
    "surface_end_m": "surface at the end, rms (m)",
    "surface_mean_m": "mean surface, rms (m)",
    "energy_mean_l2": "mean kinetic energy, l2",
}
MEASURES = {
    "surface_end_m": "the surface at the end",
    "surface_mean_m": "the mean surface",
    "energy_mean_l2": "the mean kinetic energy",
}


def write_adaptation(plan: Plan, made: Adaptation, arguments: Sequence[str]) -> Path:
    """Write the page and the table of an adaptation; return the path of the page."""
    rows = rows_of(plan, made)
    write_table(rows, plan.folder / TABLE_FILE)
    compared = windows(plan, made)
    figures = {
        "spacing": _maps(compared, "spacing (km)", lambda each: each.spacing / 1000.0),
        "kinetic_energy": _maps(compared, "mean kinetic energy (m² s⁻²)", lambda each: each.mean("kinetic_energy")),
        "law": _law_figure(compared),
    }
    sections = {"Meshes": table_of(rows, MESH_COLUMNS), "Errors and costs": table_of(rows, ERROR_COLUMNS)}
    return write_page(
        plan.folder, f"A mesh that follows {plan.case.name}", _text(plan, rows), arguments, sections, figures
    )


def _text(plan: Plan, rows: Sequence[StudyRow]) -> str:
    start = "from the start of the case" if plan.begin_again else "from the state carried over from the round before"
    text = (
        f"Each round runs for {plan.days:g} days on {plan.cells} cells, {start}. The density of its mesh is "
        f"max({FLOOR:g}, KE / KEmax)^{POWER:g} of the mean kinetic energy KE over the second half of the round before, "
        f"after {SMOOTHING} passes of smoothing. Errors are differences from a uniform mesh of {plan.fine} cells, of "
        "which the means over each cell are taken; the cost is the number of cells times that of steps."
    )
    return " ".join([text, verdict(rows, plan.begin_again)])


def verdict(rows: Sequence[StudyRow], begin_again: bool) -> str:
    """What the last adapted mesh gains over the uniform one of as many cells, in a sentence for each measure."""
    last, uniform = (rows[-1], rows[0]) if begin_again else (rows[-2], rows[-1])
    cost = last["cell_steps"] / uniform["cell_steps"]
    found = [f"The last adapted mesh costs {cost:.2f} times as much as the uniform one of as many cells."]
    for column, meaning in MEASURES.items():
        ratio = last[column] / uniform[column]
        better = "smaller" if ratio < 1.0 else "not smaller"
        found.append(
            f"Its error in {meaning} is {better}: {last[column]:.3g} for {uniform[column]:.3g}, {ratio:.2f} times; "
            f"times the cost, {ratio * cost:.2f}."
        )
    return " ".join(found)


def _maps(compared: Sequence[Window], label: str, values: Callable[[Window], Array]) -> Figure:
    """A map for each run, all with the same colours, which go by the logarithm."""
    shown = [values(each) for each in compared]
    most = max(each.max() for each in shown)
    norm = LogNorm(max(min(each.min() for each in shown), most / COLOUR_RANGE), most)
    figure = Figure(figsize=(6.4 * min(2, len(shown)), 3.9 * ((len(shown) + 1) // 2)), layout="constrained")
    for place, (window, field) in enumerate(zip(compared, shown, strict=True), 1):
        axes = figure.add_subplot((len(shown) + 1) // 2, min(2, len(shown)), place)
        plot_field(window.run.mesh, field, axes, norm=norm, label=label, **_view(window.run.mesh))
        axes.set_title(f"{window.name}, days {window.first:g} to {window.first + window.days:g}")
    return figure


def _view(mesh: VoronoiMesh) -> dict[str, Any]:
    """Centre and extent, degrees, of a map that shows a sea; the globe where there is no coast."""
    if not has_walls(mesh):
        return {}
    points = normalize(mesh.cell_points)
    middle = normalize(points.sum(axis=0))
    longitude, latitude = to_lonlat(middle)
    reach = float(np.degrees(arc_length(points, middle).max()))
    return {"centre": (float(np.degrees(longitude)), float(np.degrees(latitude))), "extent": min(2.1 * reach, 180.0)}


def _law_figure(compared: Sequence[Window]) -> Figure:
    """Spacing of each cell against the one that its density asks for."""
    figure = Figure(figsize=(6.4, 5.0), layout="constrained")
    axes: Axes = figure.add_subplot()
    for window in compared:
        mesh = window.run.mesh
        asked = asked_spacing(mesh.mesh_density, mesh.area_cell) / 1000.0
        axes.loglog(asked, window.spacing / 1000.0, ".", markersize=2, label=window.name)
    low, high = axes.get_xlim()
    axes.loglog([low, high], [low, high], color="black", linewidth=0.8, label="as asked")
    axes.set(xlabel="spacing that the density asks for (km)", ylabel="spacing of the cell (km)")
    axes.legend(markerscale=5)
    return figure

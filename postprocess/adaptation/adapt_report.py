"""The page that shows what rounds of adaptation gave."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from mesh.arrays import Array
from mesh.discrete.walls import has_walls
from mesh.geometry.sphere import arc_length, normalize, to_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.adaptation.energy_density import SMOOTHING, asked_spacing
from postprocess.adaptation.errors import EQUAL_COST, UNIFORM, Comparison, comparisons, sampling_row
from postprocess.adaptation.rounds import Adaptation, Plan
from postprocess.figures.field_map import plot_field
from postprocess.studies.page import table_of, write_page
from postprocess.studies.study_folder import StudyRow, write_table

TABLE_FILE = "adapt.csv"

COLOUR_RANGE = 1000.0
"""Colours span no more than this ratio."""

SHOWN_PERCENT = 99.0
"""Percent of the cells of the maps of differences whose values lie within their colours."""

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
    compared, sampling = comparisons(plan, made), sampling_row(plan, made)
    rows = [each.row for each in compared]
    write_table([*rows, sampling], plan.folder / TABLE_FILE)
    spacing = [each.window.spacing / 1000.0 for each in compared]
    energy = [each.window.mean("kinetic_energy") for each in compared]
    differences = [each.surface for each in compared]
    figures = {
        "spacing": _maps(compared, spacing, "spacing (km)", _positive(spacing)),
        "kinetic_energy": _maps(compared, energy, "mean kinetic energy (m² s⁻²)", _positive(energy)),
        "error": _maps(compared, differences, "mean surface minus that of the fine run (m)", _both_signs(differences)),
        "law": _law_figure(compared),
    }
    sections = {
        "Meshes": table_of(rows, MESH_COLUMNS),
        "Errors and costs": table_of([*rows, sampling], ERROR_COLUMNS),
    }
    text = " ".join([_text(plan), verdict(rows, sampling, plan.begin_again)])
    return write_page(plan.folder, f"A mesh that follows {plan.case.name}", text, arguments, sections, figures)


def _text(plan: Plan) -> str:
    start = "from the start of the case" if plan.begin_again else "from the state carried over from the round before"
    return (
        f"Each round runs for {plan.days:g} days on {plan.cells} cells, {start}. The density of its mesh is "
        f"max({plan.density_floor:g}, KE / KEmax)^{plan.density_power:g} of the mean kinetic energy KE over the second "
        f"half of the round before, after {SMOOTHING} passes of smoothing. Errors are differences from a uniform mesh "
        f"of {plan.fine} cells, of which the means over each cell are taken; the cost is the number of cells times "
        "that of steps. The last row of the errors is what a mesh as good as the fine one would have in a turbulent "
        "flow, from how much the fine run itself varies over those days."
    )


def verdict(rows: Sequence[StudyRow], sampling: StudyRow, begin_again: bool) -> str:
    """How the last adapted mesh does beside the uniform ones of as many cells and of equal cost, for each measure.

    Differences no larger than those of the `sampling` are called so.
    """
    by_name = {row["name"]: row for row in rows}
    last = [row for row in rows if row["name"] not in (UNIFORM, EQUAL_COST)][-1]
    uniform, equal = rows[0] if begin_again else by_name[UNIFORM], by_name[EQUAL_COST]
    cost = last["cell_steps"] / uniform["cell_steps"]
    found = [
        f"The last adapted mesh costs {cost:.2f} times as much as the uniform one of as many cells, and "
        f"{last['cell_steps'] / equal['cell_steps']:.2f} times as much as the uniform one of {equal['cells']} cells."
    ]
    for column, meaning in MEASURES.items():
        error, noise = last[column], sampling[column]
        ratio = error / uniform[column]
        found.append(
            f"Its error in {meaning} is {error:.3g}, {ratio:.2f} times that of as many uniform cells "
            f"({_compared(error, uniform[column], noise)}; times the cost, {ratio * cost:.2f}) and "
            f"{error / equal[column]:.2f} times that of equal cost ({_compared(error, equal[column], noise)})."
        )
    better = sum(_compared(last[column], equal[column], sampling[column]) == "smaller" for column in MEASURES)
    return " ".join([*found, f"At equal cost it is better in {better} of {len(MEASURES)} measures."])


def _compared(error: float, other: float, noise: float) -> str:
    """How an error compares with another, in a word or two."""
    if abs(error - other) <= noise:
        return "no more than sampling apart"
    return "smaller" if error < other else "larger"


def _positive(fields: Sequence[Array]) -> Normalize:
    """Colours of positive values, by their logarithm where they span a power of ten: else the bar lacks numbers."""
    least, most = min(each.min() for each in fields), max(each.max() for each in fields)
    return Normalize(least, most) if most < 10.0 * least else LogNorm(max(least, most / COLOUR_RANGE), most)


def _both_signs(fields: Sequence[Array]) -> Normalize:
    """Colours that are symmetric about zero; few cells are beyond them."""
    most = float(np.percentile(np.abs(np.concatenate(fields)), SHOWN_PERCENT))
    return Normalize(-most, most)


def _maps(compared: Sequence[Comparison], fields: Sequence[Array], label: str, norm: Normalize) -> Figure:
    """A map of a field (n_cells,) for each run, all with the same colours and view."""
    view = _view(compared[-1].window.run.mesh)
    # Maps of a sea are square, those of the globe twice as wide as high.
    across, width = (3, 3.9) if view else (2, 6.4)
    down = -(-len(fields) // across)
    colours = "RdBu_r" if min(each.min() for each in fields) < 0.0 else "viridis"
    figure = Figure(figsize=(width * across, 3.9 * down), layout="constrained")
    for place, (each, field) in enumerate(zip(compared, fields, strict=True), 1):
        window, axes = each.window, figure.add_subplot(down, across, place)
        plot_field(window.run.mesh, field, axes, norm=norm, cmap=colours, colour_bar=False, **view)
        axes.set_title(f"{window.name}, days {window.first:g} to {window.first + window.days:g}")
    figure.colorbar(axes.collections[-1], ax=figure.axes, shrink=0.8, label=label)
    return figure


def _view(mesh: VoronoiMesh) -> dict[str, Any]:
    """Centre and extent, degrees, of a map that shows a sea; the globe where there is no coast."""
    if not has_walls(mesh):
        return {}
    points = normalize(mesh.cell_points)
    middle = normalize(mesh.area_cell @ points)
    longitude, latitude = to_lonlat(middle)
    reach = float(np.degrees(arc_length(points, middle).max()))
    return {"centre": (float(np.degrees(longitude)), float(np.degrees(latitude))), "extent": min(2.1 * reach, 180.0)}


def _law_figure(compared: Sequence[Comparison]) -> Figure:
    """Spacing of each cell against the one that its density asks for."""
    figure = Figure(figsize=(6.4, 5.0), layout="constrained")
    axes: Axes = figure.add_subplot()
    for each in compared:
        window, mesh = each.window, each.window.run.mesh
        asked = asked_spacing(mesh.mesh_density, mesh.area_cell) / 1000.0
        axes.loglog(asked, window.spacing / 1000.0, ".", markersize=2, label=window.name)
    low, high = axes.get_xlim()
    axes.loglog([low, high], [low, high], color="black", linewidth=0.8, label="as asked")
    axes.set(xlabel="spacing that the density asks for (km)", ylabel="spacing of the cell (km)")
    axes.legend(markerscale=5)
    return figure

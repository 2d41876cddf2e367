"""Figures of a run: fields on maps, the mesh and its quality, and what was conserved."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mesh.arrays import Array
from mesh.discrete.operators import vertex_to_cell
from mesh.discrete.quality import mesh_quality, neighbour_distance_ratio, triangle_quality
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.palettes import colours_for
from postprocess.figures.paper import paper_of
from postprocess.runs.folders import prepared_folder
from postprocess.runs.reading import Run
from swe.constants import SECONDS_PER_DAY

DOTS_PER_INCH = 150
ALIKE, BAR = 1e-9, 0.01
"""Relative differences up to the former are none; of measures without differences a range of the latter is shown."""

ROUND_OFF_FLOOR = 1e-20
"""Smaller changes are drawn at this value, since zero has no logarithm."""


def plot_run(run: Run, folder: AnyPath) -> list[Path]:
    """Write all figures of `run` to `folder`; return their paths."""
    folder = prepared_folder(folder)
    last = run.last_snapshot()
    heading = f"{run.case}, {run.mesh.n_cells} cells, day {last.day:g}"
    figures = {
        "potential_vorticity": field_figure(
            run.mesh,
            1e8 * vertex_to_cell(run.mesh, last.fields["potential_vorticity"]),
            f"Potential vorticity: {heading}",
            "potential vorticity (10⁻⁸ m⁻¹ s⁻¹)",
            "potential_vorticity",
        ),
        "kinetic_energy": field_figure(
            run.mesh,
            last.fields["kinetic_energy"],
            f"Kinetic energy: {heading}",
            "kinetic energy (m² s⁻²)",
            "kinetic_energy",
        ),
        "surface_height": field_figure(
            run.mesh,
            last.fields["surface_height"],
            f"Surface height: {heading}",
            "height of the surface (m)",
            "surface_height",
        ),
        "mesh": mesh_figure(run.mesh),
        "conservation": _conservation_figure(run.series, f"{run.case}, {run.mesh.n_cells} cells"),
    }
    paths = []
    for name, figure in figures.items():
        paths.append(folder / f"{name}.png")
        figure.savefig(paths[-1], dpi=DOTS_PER_INCH)
    return paths


def field_figure(mesh: VoronoiMesh, values: Array, title: str, label: str, name: str = "") -> Figure:
    """Cell values on the views of `postprocess.figures.paper`, with one colour bar.

    Colours are those of the field called `name`, see `postprocess.figures.palettes.colours_for`.
    """
    options = colours_for(name, values).options
    views = paper_of(mesh).views
    figure = Figure(figsize=views.size, layout="constrained")
    grid = list(np.atleast_1d(figure.subplots(1, len(views.draw), width_ratios=views.widths)))
    for axes, draw in zip(grid, views.draw, strict=True):
        drawn = draw(axes, values, options).collections[-1]
    figure.colorbar(drawn, ax=grid, location="bottom", shrink=views.bar, aspect=40, label=label)
    figure.suptitle(title)
    return figure


def mesh_figure(mesh: VoronoiMesh) -> Figure:
    """The mesh coloured by cell area, and the distributions of sigma over cells and of q over triangles."""
    quality = mesh_quality(mesh)
    figure = Figure(figsize=(12.0, 4.6), layout="constrained")
    left, right = np.asarray(figure.subfigures(1, 2, width_ratios=[1.6, 1.0]))
    map_axes = left.subplots()
    paper = paper_of(mesh)
    unit, symbol = paper.unit
    area = mesh.area_cell / unit**2
    if np.ptp(area) <= ALIKE * area.max():
        area = np.full(mesh.n_cells, area.mean())  # colours would show round-off
    drawn = paper.draw(map_axes, area, colours_for("area_cell", area).options).collections[-1]
    left.colorbar(drawn, ax=map_axes, location="bottom", shrink=0.8, label=f"area of cells ({symbol}²)")
    distributions = (
        (neighbour_distance_ratio(mesh), "σ, shortest over longest neighbour distance", "cells"),
        (triangle_quality(mesh), "q of Delaunay triangles, 1 if equilateral", "triangles"),
    )
    for axes, (values, label, count) in zip(right.subplots(2, 1), distributions, strict=True):
        values = values[np.isfinite(values)]  # those beside walls are none
        if not len(values):
            continue
        axes.hist(values, bins=60, range=_range(values), color="tab:blue")
        axes.set_yscale("log")
        axes.set_xlabel(label)
        axes.set_ylabel(f"number of {count}")
        axes.set_title(f"mean {values.mean():.4f}, smallest {values.min():.4f}", fontsize=9)
    figure.suptitle(f"Mesh of {mesh.n_cells} cells: μ = {quality.mu:.4f}, area ratio {quality.area_ratio:.3f}")
    return figure


def _range(values: Array) -> tuple[float, float]:
    """Ends of a histogram: of regular hexagons all values are one, but for round-off."""
    least, most = float(values.min()), float(values.max())
    middle = 0.5 * (least + most)
    return (least, most) if most - least > ALIKE else (middle - 0.5 * BAR, middle + 0.5 * BAR)


def _conservation_figure(series: dict[str, Array], title: str) -> Figure:
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    draw_conservation(figure.subplots(), series, title)
    return figure


def draw_conservation(axes: Axes, series: dict[str, Array], title: str) -> Axes:
    """Draw magnitudes of all relative changes since the start against time, on a logarithmic axis."""
    days = series["time"] / SECONDS_PER_DAY
    for name, label, style in (
        ("potential_enstrophy_change", "potential enstrophy", "-"),
        ("total_energy_change", "total energy, of the available energy", "-"),
        ("total_energy_change_of_total", "total energy, of the total energy", "--"),
        ("mass_change", "mass", "-"),
        ("absolute_vorticity_change", "absolute vorticity, of the integral of |f|", ":"),
    ):
        axes.semilogy(days[1:], np.maximum(np.abs(series[name][1:]), ROUND_OFF_FLOOR), style, label=label)
    axes.set_xlabel("time (days)")
    axes.set_ylabel("|relative change since the start|")
    axes.set_title(f"Conservation: {title} (values below {ROUND_OFF_FLOOR:g} drawn there)")
    axes.grid(alpha=0.3)
    axes.set_xlim(0.0, days[-1])
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    return axes

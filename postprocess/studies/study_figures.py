"""Charts of a study of meshes: errors against resolution and quality, truncation errors, conservation."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from postprocess.figures.plots import ROUND_OFF_FLOOR
from postprocess.studies.lines import STYLES, families_of, heading_with, lines_of, named, schemes_of
from postprocess.studies.mesh_study import Member
from postprocess.studies.study_folder import CONSERVATION, StudyRow
from swe.constants import SECONDS_PER_DAY

ERRORS = {
    "thickness_l2": "thickness, l2",
    "thickness_linf": "thickness, l∞",
    "normal_velocity_l2": "normal velocity, l2",
    "vorticity_l2": "vorticity, l2",
}
"""Errors that are drawn, and their titles."""

UNCERTAINTIES = {
    "thickness_l2": "uncertainty_thickness",
    "normal_velocity_l2": "uncertainty_velocity",
    "vorticity_l2": "uncertainty_vorticity",
}
"""Uncertainty of the reference that goes with an error."""

QUALITIES = {
    "sigma_avg": "σ avg: shortest / longest distance",
    "q_min": "q min: worst triangle",
    "residual": "distance to centroids (mean spacings)",
    "truncation_divergence_l2": "truncation error of divergence, l2",
    "truncation_perp_linf": "truncation error of perp, l∞",
    "truncation_kinetic_energy_linf": "truncation error of kinetic energy, l∞",
}
"""Measures of a mesh that errors are drawn against, and their labels."""

OPERATORS = ("gradient", "divergence", "curl", "perp", "kinetic_energy")
PANEL_WIDTH, PANEL_HEIGHT = 4.8, 3.8
"""Inches of a panel: two beside each other are as wide as a page."""

MARKERS = "osD^vP*X"
SHORT_AXIS = 30.0
"""Logarithmic axes that span less than this ratio have labels at 1, 2 and 5 times powers of ten."""

LONG_LABEL = 34
"""Four labels of this many letters do not fit side by side below the narrowest figure."""


def error_figure(rows: Sequence[StudyRow], heading: str) -> Figure:
    """Solution errors against the distance of cells, a line a family and scheme, with slopes of orders 1 and 2."""
    names = [name for name in ERRORS if any(name in row for row in rows)]
    figure, grid = _panels(len(names), 2)
    for axes, name in zip(grid, names, strict=True):
        _draw_families(axes, rows, name)
        uncertainties = [row[UNCERTAINTIES[name]] for row in rows if UNCERTAINTIES.get(name) in row]
        if uncertainties and uncertainties[0] > 0.0:
            axes.axhline(uncertainties[0], color="grey", linestyle=":", label="uncertainty of the reference")
        axes.set_title(f"relative error of {ERRORS[name]}", fontsize=10)
    _finish(figure, grid, heading_with(heading, schemes_of(rows)))
    return figure


def truncation_figure(rows: Sequence[StudyRow], heading: str) -> Figure:
    """Truncation errors of the operators against the distance of cells: l2 on the left, l∞ on the right."""
    figure, grid = _panels(2 * len(OPERATORS), 2)
    grid = grid[::2] + grid[1::2]
    for axes, (norm, operator) in zip(grid, [(n, o) for n in ("l2", "linf") for o in OPERATORS], strict=True):
        _draw_families(axes, rows, f"truncation_{operator}_{norm}")
        axes.set_title(f"{operator.replace('_', ' ')}, {norm.replace('linf', 'l∞')}", fontsize=10)
    _finish(figure, grid, heading_with(heading, schemes_of(rows)))
    return figure


def quality_figure(rows: Sequence[StudyRow], heading: str) -> Figure:
    """The l2 error of thickness against measures of the mesh; one colour a family, larger markers for finer meshes.

    Markers of the second scheme are hollow.
    """
    figure, grid = _panels(len(QUALITIES), 2)
    families, schemes = families_of(rows), schemes_of(rows)
    sizes = sorted({row["requested_cells"] for row in rows})
    for axes, (name, label) in zip(grid, QUALITIES.items(), strict=True):
        for (family, scheme), line in lines_of(rows).items():
            number, ours = families.index(family), [row for row in line if "thickness_l2" in row]
            axes.scatter(
                [row[name] for row in ours],
                [row["thickness_l2"] for row in ours],
                s=[20.0 + 40.0 * sizes.index(row["requested_cells"]) for row in ours],
                marker=MARKERS[number % len(MARKERS)],
                label=named(family, scheme, schemes),
                alpha=0.8,
                **_scatter_colours(f"C{number}", hollow=scheme != schemes[0]),
            )
        _logarithmic_ordinate(axes)
        if name not in ("sigma_avg", "q_min"):
            _logarithmic_abscissa(axes, [row[name] for row in rows])
        axes.set_xlabel(label, fontsize=9)
        axes.set_ylabel("relative l2 error of thickness", fontsize=9)
        axes.grid(alpha=0.3, which="both")
    _finish(figure, grid, heading_with(heading, schemes))
    return figure


def conservation_figure(members: Sequence[Member], heading: str) -> Figure:
    """Magnitudes of the relative changes of the invariants against time, one line per mesh and scheme."""
    figure, grid = _panels(len(CONSERVATION), 2)
    schemes = list(dict.fromkeys(member.scheme for member in members))
    for axes, name in zip(grid, CONSERVATION, strict=True):
        finished = [(member, member.run.series) for member in members if member.run is not None]
        meshes = list(dict.fromkeys(member.family for member, _ in finished))
        for member, series in finished:
            axes.semilogy(
                series["time"][1:] / SECONDS_PER_DAY,
                np.maximum(np.abs(series[name][1:]), ROUND_OFF_FLOOR),
                color=f"C{meshes.index(member.family)}",
                linestyle=_style(member.scheme, schemes)["linestyle"],
                label=f"{named(member.family, member.scheme, schemes)}, {member.mesh.n_cells} cells",
                linewidth=1.0,
                marker="o" if len(series["time"]) == 2 else None,
            )
        axes.set_title(f"|{name.replace('_', ' ')}|", fontsize=10)
        axes.set_xlabel("day", fontsize=9)
        axes.set_ylabel("relative change", fontsize=9)
        axes.grid(alpha=0.3)
    _finish(figure, grid, heading)
    return figure


def _panels(count: int, columns: int) -> tuple[Figure, list[Axes]]:
    columns = min(columns, count)
    rows = -(-count // columns)
    figure = Figure(figsize=(PANEL_WIDTH * columns, PANEL_HEIGHT * rows + 0.8), layout="constrained")
    return figure, list(np.atleast_1d(figure.subplots(rows, columns)).ravel())


def _style(scheme: str, schemes: Sequence[str]) -> Mapping[str, Any]:
    return STYLES[schemes.index(scheme) % len(STYLES)]


def _scatter_colours(colour: str, hollow: bool) -> dict[str, Any]:
    return {"facecolors": "none", "edgecolors": colour} if hollow else {"color": colour}


def _draw_families(axes: Axes, rows: Sequence[StudyRow], name: str) -> None:
    """One line for each family and scheme on logarithmic axes, and the slopes of first and second order."""
    families, schemes = families_of(rows), schemes_of(rows)
    for (family, scheme), line in lines_of(rows).items():
        number, ours = families.index(family), [row for row in line if row.get(name, 0.0)]
        axes.plot(
            [row["spacing_km"] for row in ours],
            [row[name] for row in ours],
            marker=MARKERS[number % len(MARKERS)],
            color=f"C{number}",
            label=family if scheme == schemes[0] else None,
            linewidth=1.0,
            markersize=5,
            **_style(scheme, schemes),
        )
    if len(schemes) > 1:
        for scheme in schemes:
            look = {"marker": "o", "markersize": 5, "linewidth": 1.0, **_style(scheme, schemes)}
            axes.plot([], [], color="black", label=scheme, **look)
    _slope_guides(axes, rows, name)
    _logarithmic_ordinate(axes)
    _logarithmic_abscissa(axes, [row["spacing_km"] for row in rows])
    axes.set_xlabel("mean distance between cells (km)", fontsize=9)
    axes.grid(alpha=0.3, which="both")


def _slope_guides(axes: Axes, rows: Sequence[StudyRow], name: str) -> None:
    points = [(row["spacing_km"], row[name]) for row in rows if row.get(name, 0.0)]
    if len({x for x, _ in points}) < 2:
        return
    x = np.array([min(x for x, _ in points), max(x for x, _ in points)])
    anchor = min(y for spacing, y in points if spacing == x[1])
    for order, style in ((1, "--"), (2, "-.")):
        axes.plot(x, 0.7 * anchor * (x / x[1]) ** order, color="grey", linestyle=style, label=f"order {order}")


def _logarithmic_abscissa(axes: Axes, values: Sequence[float]) -> None:
    """Make the horizontal axis logarithmic, with enough labels over a decade and none overlapping."""
    if not min(values) > 0.0:
        return
    axes.set_xscale("log")
    if max(values) < SHORT_AXIS * min(values):
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())


def _logarithmic_ordinate(axes: Axes) -> None:
    """Make the vertical axis logarithmic, unless all errors are zero."""
    if axes.dataLim.y1 > 0.0:
        axes.set_yscale("log")


def _finish(figure: Figure, grid: Sequence[Axes], heading: str) -> None:
    _legend_below(figure, grid[0])
    figure.suptitle(heading)


def _legend_below(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    columns = 4 if max(map(len, labels), default=0) < LONG_LABEL else 2
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize=8)

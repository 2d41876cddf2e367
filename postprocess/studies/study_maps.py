"""Maps of a study of meshes: where the error lives, on the whole mesh and round the worst cell."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mesh.arrays import Array
from postprocess.figures.maps import add_polygons
from postprocess.figures.palettes import deviation_colours
from postprocess.figures.paper import Paper, paper_of
from postprocess.studies.lines import named
from postprocess.studies.mesh_study import Member, thickness_error

IRREGULAR_COLOURS = {5: "black", 7: "magenta"}
"""Colours of the dots that mark cells with this many sides."""

COLOUR_RANGE = 4.0
"""Colours of error maps span this many times the root mean square."""

CLOSEUP_CELLS = 6.0
"""Close-ups reach this many cells from the worst one."""

LETTERS_PER_INCH = 11.0
"""Letters of a heading that fit in an inch."""

LINE_HEIGHT = 0.25
"""Inches of a line of a heading."""

MOST_DOTS = 400
"""Dots are left out if more cells than this are irregular: they would hide the map."""


def map_figure(members: Sequence[Member], day: float, heading: str) -> Figure:
    """Where the error of thickness lives: one map for each mesh, cell by cell, each with its own colours.

    Dots mark pentagons (black) and heptagons (magenta), unless there are too many; a ring marks the worst cell.
    """
    figure, panels = _panel_for_each(members, 2, (4.8, 3.3))
    for axes, member in panels:
        _colour_bar(figure, draw_error_map(axes, member, day, _name(member, members)))
    _write_heading(figure, heading)
    return figure


def draw_error_map(axes: Axes, member: Member, day: float, name: str) -> Axes:
    """Draw one map of `map_figure`, of the member of this name."""
    error = thickness_error(member, day)
    paper = paper_of(member.mesh)
    paper.draw(axes, error, _colours(error))
    _mark_irregular_cells(axes, paper, member)
    worst = int(np.argmax(np.abs(error)))
    axes.plot(*paper.spots(np.array([worst])), "o", color="lime", markersize=9, fillstyle="none", markeredgewidth=1.5)
    axes.set_title(f"{name}, {member.mesh.n_cells} cells, at most {np.abs(error[worst]):.2g} m", fontsize=10)
    return axes


def closeup_figure(members: Sequence[Member], day: float, heading: str) -> Figure:
    """The error of thickness round the worst cell of each mesh, with the number of sides of irregular cells."""
    figure, panels = _panel_for_each(members, 3, (3.2, 4.2))
    for axes, member in panels:
        _colour_bar(figure, draw_closeup(axes, member, day, _name(member, members)))
    _write_heading(figure, heading)
    return figure


def draw_closeup(axes: Axes, member: Member, day: float, name: str) -> Axes:
    """Draw one panel of `closeup_figure`, of the member of this name."""
    mesh, error = member.mesh, thickness_error(member, day)
    worst = int(np.argmax(np.abs(error)))
    paper = paper_of(mesh)
    reach = CLOSEUP_CELLS * np.sqrt(mesh.area_cell[worst]) / mesh.length_unit
    closeup = paper.around(worst, 1.5 * reach)
    options = {"edgecolors": "grey", "linewidths": 0.4, **_colours(error)}
    add_polygons(axes, closeup.polygons, error[closeup.cells], options)
    for cell, (x, y) in zip(closeup.cells, closeup.centers, strict=True):
        if mesh.n_edges_on_cell[cell] != 6:
            axes.text(x, y, str(mesh.n_edges_on_cell[cell]), ha="center", va="center", fontsize=9, clip_on=True)
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
    axes.set_title(f"{name}\n{paper.place_in_words(worst)}", fontsize=10)
    return axes


def _name(member: Member, members: Sequence[Member]) -> str:
    return named(member.family, member.scheme, [each.scheme for each in members])


def _panel_for_each(
    members: Sequence[Member], columns: int, size: tuple[float, float]
) -> tuple[Figure, list[tuple[Axes, Member]]]:
    """A panel of this size, inches, for each member that is compared with a solution."""
    compared = [member for member in members if member.comparison is not None]
    columns = min(columns, len(compared))
    rows = -(-len(compared) // columns)
    figure = Figure(figsize=(size[0] * columns, size[1] * rows + 0.5), layout="constrained")
    grid = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for axes in grid[len(compared) :]:
        axes.axis("off")
    return figure, list(zip(grid, compared, strict=False))


def _write_heading(figure: Figure, heading: str) -> None:
    """Write a heading in lines that are not wider than the figure, which has room for two and grows for more."""
    lines = textwrap.wrap(heading, int(LETTERS_PER_INCH * figure.get_figwidth()))
    figure.set_figheight(figure.get_figheight() + LINE_HEIGHT * max(0, len(lines) - 2))
    figure.suptitle("\n".join(lines))


def _colours(error: Array) -> dict:
    """Those of deviations; a few very bad cells do not wash out the rest."""
    root_mean_square = float(np.sqrt(np.mean(error**2)))
    return deviation_colours(error, COLOUR_RANGE * root_mean_square).options


def _colour_bar(figure: Figure, axes: Axes) -> None:
    bar = figure.colorbar(axes.collections[-1], ax=axes, location="bottom", shrink=0.9, aspect=30, extend="both")
    bar.set_label("error of thickness (m)", fontsize=9)
    bar.ax.tick_params(labelsize=9)


def _mark_irregular_cells(axes: Axes, paper: Paper, member: Member) -> None:
    sides = member.mesh.n_edges_on_cell
    if np.count_nonzero(sides != 6) > MOST_DOTS:
        return
    for count, colour in IRREGULAR_COLOURS.items():
        cells = np.flatnonzero(sides == count)
        axes.plot(*paper.spots(cells), ".", color=colour, markersize=3)

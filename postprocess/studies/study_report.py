"""Reports of studies: figures as PNG, and one HTML page that holds tables and figures and needs no other file."""

import base64
import html
import io
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from mesh.discrete.quality import Quality
from mesh.safe_files import written_aside
from postprocess.studies.lines import lines_of, named, schemes_of, to_be_named
from postprocess.studies.mesh_study import Member, Plan
from postprocess.studies.study_figures import (
    ERRORS,
    OPERATORS,
    conservation_figure,
    error_figure,
    quality_figure,
    truncation_figure,
)
from postprocess.studies.study_folder import CONSERVATION, StudyRow, fitted_order
from postprocess.studies.study_maps import closeup_figure, map_figure, place_in_words
from postprocess.studies.time_study import DRAWN, TimePlan, by_scheme, orders, time_figure

REPORT_FILE = "report.html"
FIGURES_FOLDER = "figures"
REPORT_DOTS_PER_INCH = 100

STALLING = 1.0
"""The largest error stalls where its order is less than that of the l2 norm by this much."""

STYLE = """
body { font-family: sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; font-size: 85%; }
th, td { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
.wide { overflow-x: auto; }
img { max-width: 100%; }
"""

Columns = Mapping[str, str]
"""Column of the rows and what stands above it, in order."""

ERROR_COLUMNS = {
    "family": "family",
    "cells": "cells",
    "spacing_km": "distance (km)",
    **ERRORS,
    "uncertainty_thickness": "uncertainty of thickness",
    "worst_longitude": "worst cell: longitude (°)",
    "worst_latitude": "latitude (°)",
    "worst_to_irregular": "cells away from the nearest that is no hexagon",
}
QUALITY_COLUMNS = {"family": "family", **{name: name.replace("_", " ") for name in Quality.__dataclass_fields__}}
TRUNCATION_COLUMNS = {
    "family": "family",
    "cells": "cells",
    **{
        f"truncation_{operator}_{norm}": f"{operator.replace('_', ' ')} {norm.replace('linf', 'l∞')}"
        for operator in OPERATORS
        for norm in ("l2", "linf")
    },
}
CONSERVATION_COLUMNS = {
    "family": "family",
    "cells": "cells",
    "time_step_s": "time step (s)",
    "steps": "steps",
    **{name: f"|{name.replace('_', ' ')}|" for name in CONSERVATION},
    "failure": "failure",
}
TIME_COLUMNS = {
    "time_step_s": "time step (s)",
    "steps": "steps",
    "courant_number": "Courant number",
    **{name: name.replace("_", " ") for name in CONSERVATION},
    "thickness_difference_l2": "thickness, l2",
    "velocity_difference_l2": "velocity, l2",
    "failure": "failure",
}


def write_mesh_report(plan: Plan, finest: Sequence[Member], rows: Sequence[StudyRow], arguments: Sequence[str]) -> Path:
    """Draw all figures of a study of meshes and write its report; return the path of the report."""
    heading = f"{plan.case.title}, day {plan.error_day:g}"
    compared = [row for row in rows if "thickness_l2" in row]
    figures = {"truncation": truncation_figure(rows, "Truncation errors of the operators")}
    if compared:
        figures |= {
            "errors": error_figure(compared, heading),
            "quality": quality_figure(compared, f"Error and quality of the mesh: {heading}"),
        }
    if any(member.comparison is not None for member in finest):
        figures["maps"] = map_figure(finest, plan.error_day, f"Where the error lives: {heading}")
        figures["closeups"] = closeup_figure(finest, plan.error_day, f"Round the worst cell: {heading}")
    if any(member.run is not None for member in finest):
        figures["conservation"] = conservation_figure(finest, f"Conservation: {plan.case.title}")
    sections = {
        "Solution errors": _table(rows, ERROR_COLUMNS),
        "Fitted orders": _table(_order_rows(compared), {"family": "family", **ERRORS}),
        "Quality of the meshes": _table(rows, QUALITY_COLUMNS),
        "Truncation errors of the operators": _table(rows, TRUNCATION_COLUMNS),
        "Conservation, largest change on the way": _table(rows, CONSERVATION_COLUMNS),
    }
    reference = next((str(row["reference"]) for row in compared), "none")
    text = (
        f"{plan.case.title} ({plan.case.reference}), run to day {plan.days:g}; errors on day {plan.error_day:g} "
        f"against: {reference}. Norms are those of Williamson et al. (1992)."
    )
    text = " ".join([text, *_stalling(compared)])
    return _write_page(plan.folder, f"Study of meshes: {plan.case.title}", text, arguments, sections, figures)


def write_time_report(plan: TimePlan, rows: Sequence[StudyRow], arguments: Sequence[str]) -> Path:
    """Draw the figure of a study of time steps and write its report; return the path of the report."""
    heading = f"{plan.case.title}, {plan.mesh.n_cells} cells, day {plan.days:g}"
    fitted = [{"scheme": scheme, **orders(line)} for scheme, line in by_scheme(rows).items()]
    sections = {
        "Time steps": _table(rows, TIME_COLUMNS),
        "Fitted orders": _table(fitted, DRAWN),
    }
    text = f"{heading}. Differences are those from the run with the shortest step."
    figures = {"time_steps": time_figure(rows, heading)}
    return _write_page(plan.folder, f"Study of time steps: {plan.case.title}", text, arguments, sections, figures)


def _order_rows(rows: Sequence[StudyRow]) -> list[StudyRow]:
    """Fitted order of each error by family and scheme, where there are two sizes or more."""
    fitted: list[StudyRow] = []
    for (family, scheme), ours in lines_of(rows).items():
        spacing = [float(row["spacing_km"]) for row in ours]
        if len(ours) > 1:
            orders_of = {name: fitted_order(spacing, [float(row.get(name, 0.0)) for row in ours]) for name in ERRORS}
            fitted.append({"family": family, "scheme": scheme, **orders_of})
    return fitted


def _stalling(rows: Sequence[StudyRow]) -> list[str]:
    """A sentence for each family and scheme whose largest error of thickness no longer falls with its l2 norm."""
    sentences = []
    for (family, scheme), line in lines_of(rows).items():
        last = line[-2:]
        spacing = [row["spacing_km"] for row in last]
        l2, linf = (fitted_order(spacing, [row[f"thickness_{norm}"] for row in last]) for norm in ("l2", "linf"))
        if l2 - linf > STALLING:
            worst = last[-1]
            sentences.append(
                f"On {named(family, scheme, schemes_of(rows))}, l∞ of thickness stalls between {last[0]['cells']} and "
                f"{worst['cells']} cells at "
                f"{worst['thickness_linf']:.2g} (order {linf:.2f}, of l2 {l2:.2f}): the worst cell, at "
                f"{place_in_words(worst['worst_longitude'], worst['worst_latitude'])}, is "
                f"{worst['worst_to_irregular']:.1f} mean distances from the nearest cell that is no hexagon."
            )
    return sentences


def _table(rows: Sequence[StudyRow], columns: Columns) -> str:
    """An HTML table of those columns that any row has; schemes where they are to be named, beside the first column."""
    if to_be_named(schemes_of(rows)):
        first, *others = columns.items()
        columns = dict([first, ("scheme", "scheme"), *others])
    shown = {name: title for name, title in columns.items() if any(row.get(name, "") != "" for row in rows)}
    head = "".join(f"<th>{html.escape(title)}</th>" for title in shown.values())
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(_in_words(row.get(name, '')))}</td>" for name in shown) + "</tr>\n"
        for row in rows
    )
    return f'<div class="wide"><table>\n<tr>{head}</tr>\n{body}</table></div>'


def _in_words(value: float | str) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _write_page(
    folder: Path,
    title: str,
    text: str,
    arguments: Sequence[str],
    sections: Mapping[str, str],
    figures: Mapping[str, Figure],
) -> Path:
    (folder / FIGURES_FOLDER).mkdir(exist_ok=True)
    parts = [f"<h1>{html.escape(title)}</h1>\n<p>{html.escape(text)}</p>"]
    parts.append(f"<p>Made by <code>{html.escape(shlex.join(arguments))}</code></p>")
    parts += [f"<h2>{html.escape(name)}</h2>\n{table}" for name, table in sections.items()]
    for name, figure in figures.items():
        image = _png(figure)
        with written_aside(folder / FIGURES_FOLDER / f"{name}.png") as aside:
            aside.write_bytes(image)
        source = f"data:image/png;base64,{base64.b64encode(image).decode()}"
        parts.append(f'<p><img src="{source}" alt="{html.escape(name)}"></p>')
    path = folder / REPORT_FILE
    start = f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>'
    with written_aside(path) as aside:
        aside.write_text(
            f"{start}\n<style>{STYLE}</style>\n" + "\n".join(parts) + "\n</html>\n", "utf-8", "backslashreplace"
        )
    return path


def _png(figure: Figure) -> bytes:
    """The figure as PNG with a palette, a third of the size of one in true colour."""
    full, small = io.BytesIO(), io.BytesIO()
    figure.savefig(full, dpi=REPORT_DOTS_PER_INCH, format="png")
    Image.open(full).convert("RGB").quantize(256).save(small, format="PNG", optimize=True)
    return small.getvalue()

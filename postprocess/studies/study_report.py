"""Reports of studies: what stands on their pages."""

from collections.abc import Sequence
from pathlib import Path

from mesh.discrete.quality import Quality
from postprocess.studies.lines import lines_of, named, schemes_of
from postprocess.studies.mesh_study import Member, Plan
from postprocess.studies.page import table_of, write_page
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

STALLING = 1.0
"""The largest error stalls where its order is less than that of the l2 norm by this much."""

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
        "Solution errors": table_of(rows, ERROR_COLUMNS),
        "Fitted orders": table_of(_order_rows(compared), {"family": "family", **ERRORS}),
        "Quality of the meshes": table_of(rows, QUALITY_COLUMNS),
        "Truncation errors of the operators": table_of(rows, TRUNCATION_COLUMNS),
        "Conservation, largest change on the way": table_of(rows, CONSERVATION_COLUMNS),
    }
    reference = next((str(row["reference"]) for row in compared), "none")
    text = (
        f"{plan.case.title} ({plan.case.reference}), run to day {plan.days:g}; errors on day {plan.error_day:g} "
        f"against: {reference}. Norms are those of Williamson et al. (1992)."
    )
    text = " ".join([text, *_stalling(compared)])
    return write_page(plan.folder, f"Study of meshes: {plan.case.title}", text, arguments, sections, figures)


def write_time_report(plan: TimePlan, rows: Sequence[StudyRow], arguments: Sequence[str]) -> Path:
    """Draw the figure of a study of time steps and write its report; return the path of the report."""
    heading = f"{plan.case.title}, {plan.mesh.n_cells} cells, day {plan.days:g}"
    fitted = [{"scheme": scheme, **orders(line)} for scheme, line in by_scheme(rows).items()]
    sections = {
        "Time steps": table_of(rows, TIME_COLUMNS),
        "Fitted orders": table_of(fitted, DRAWN),
    }
    text = f"{heading}. Differences are those from the run with the shortest step."
    figures = {"time_steps": time_figure(rows, heading)}
    return write_page(plan.folder, f"Study of time steps: {plan.case.title}", text, arguments, sections, figures)


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

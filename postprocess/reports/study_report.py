"""Reports of studies: what stands on their pages."""

from collections.abc import Sequence
from pathlib import Path

from mesh.discrete.quality import Quality
from postprocess.reports.captions import mesh_captions, time_captions
from postprocess.reports.mesh_verdict import mesh_verdict
from postprocess.reports.sentences import has_shares
from postprocess.reports.share_columns import share_columns
from postprocess.reports.time_verdict import time_verdict
from postprocess.studies.lines import lines_of
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
from postprocess.studies.study_maps import closeup_figure, map_figure
from postprocess.studies.time_study import DRAWN, TimePlan, by_scheme, orders, time_figure

ERROR_COLUMNS = {
    "family": "family",
    "cells": "cells",
    "spacing_km": "distance (km)",
    **ERRORS,
    "uncertainty_thickness": "uncertainty of thickness",
    "worst_longitude": "worst cell: longitude (°)",
    "worst_latitude": "latitude (°)",
    "worst_x_km": "worst cell: x (km)",
    "worst_y_km": "y (km)",
    "worst_to_irregular": "worst cell: cells away from one that is no hexagon",
}
SHARES = "Where the error lives: shares of its square and of the area"
SHARE_COLUMNS = {"family": "family", "cells": "cells", **share_columns("error")}
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
    figures = {"errors": error_figure(compared, heading)} if compared else {}
    if any(member.comparison is not None for member in finest):
        figures["maps"] = map_figure(finest, plan.error_day, f"Where the error lives: {heading}")
        figures["closeups"] = closeup_figure(finest, plan.error_day, f"Round the worst cell: {heading}")
    if compared:
        figures["quality"] = quality_figure(compared, f"Error and quality of the mesh: {heading}")
    figures["truncation"] = truncation_figure(rows, "Truncation errors of the operators")
    if any(member.run is not None for member in finest):
        figures["conservation"] = conservation_figure(finest, f"Conservation: {plan.case.title}")
    sections = {
        "Solution errors": table_of(rows, ERROR_COLUMNS),
        "Fitted orders": table_of(_order_rows(compared), {"family": "family", **ERRORS}),
        SHARES: table_of(rows, SHARE_COLUMNS),
        "Quality of the meshes": table_of(rows, QUALITY_COLUMNS),
        "Truncation errors of the operators": table_of(rows, TRUNCATION_COLUMNS),
        "Conservation, largest change on the way": table_of(rows, CONSERVATION_COLUMNS),
    }
    if not any(has_shares(row) for row in rows):
        del sections[SHARES]
    reference = next((str(row["reference"]) for row in compared), "none")
    text = (
        f"{plan.case.title} ({plan.case.reference}), run to day {plan.days:g}; errors on day {plan.error_day:g} "
        f"against: {reference}. Norms are those of Williamson et al. (1992)."
    )
    return write_page(
        plan.folder,
        f"Study of meshes: {plan.case.title}",
        text,
        arguments,
        sections,
        figures,
        mesh_verdict(rows, plan.case.convergence_order),
        mesh_captions(plan.error_day, sum(member.comparison is not None for member in finest)),
    )


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
    return write_page(
        plan.folder,
        f"Study of time steps: {plan.case.title}",
        text,
        arguments,
        sections,
        figures,
        time_verdict(rows),
        time_captions(min(plan.time_steps)),
    )


def _order_rows(rows: Sequence[StudyRow]) -> list[StudyRow]:
    """Fitted order of each error by family and scheme, where there are two sizes or more."""
    fitted: list[StudyRow] = []
    for (family, scheme), ours in lines_of(rows).items():
        spacing = [float(row["spacing_km"]) for row in ours]
        if len(ours) > 1:
            orders_of = {name: fitted_order(spacing, [float(row.get(name, 0.0)) for row in ours]) for name in ERRORS}
            fitted.append({"family": family, "scheme": scheme, **orders_of})
    return fitted

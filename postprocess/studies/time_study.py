"""The same run with several time steps: drift of the invariants and error of the time stepping against its length."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from cases.base import Case
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.comparison import fields_of
from postprocess.compare.norms import scalar_norms, vector_norms
from postprocess.runs.folders import prepared_folder
from postprocess.runs.reading import Run
from postprocess.studies.lines import STYLES, heading_with, run_name, schemes_of
from postprocess.studies.study_folder import (
    CONSERVATION,
    TABLE_FILE,
    StudyRow,
    Task,
    Tell,
    fitted_order,
    require_days,
    write_table,
)
from swe.configuration import Options, SchemeName
from swe.errors import InputError

ORDER_OF_ENERGY_DRIFT = 5
"""Classical RK4 dissipates the energy of oscillations at this order in the time step."""

DRAWN = {
    "total_energy_change_of_total": "relative change of total energy",
    "thickness_difference_l2": "thickness, against the shortest step",
    "velocity_difference_l2": "velocity, against the shortest step",
}


LEAST_TIME_STEP, LARGEST_TIME_STEP = 1e-3, 1e6
"""Shortest and longest steps of a study, s."""


@dataclass(frozen=True)
class TimePlan:
    """Runs of `case` on `mesh` for `days` with each of `time_steps`, s, and of `schemes`.

    Raises `InputError` for fewer than two steps.
    """

    folder: Path
    case: Case
    mesh: VoronoiMesh
    days: float
    time_steps: tuple[float, ...]
    schemes: tuple[SchemeName, ...] = (Options.scheme,)

    def __post_init__(self) -> None:
        require_days(self.days)
        for time_step in self.time_steps:
            if not LEAST_TIME_STEP <= time_step <= LARGEST_TIME_STEP:
                raise InputError(
                    f"a time step is {time_step:g} s; give ones from {LEAST_TIME_STEP:g} to {LARGEST_TIME_STEP:g} s"
                )
        if len(set(self.time_steps)) < 2:
            raise InputError("a study of time steps needs at least two of them; give --dt more than once")


def carry_out(plan: TimePlan, progress: bool, tell: Tell) -> list[StudyRow]:
    """Make the runs that are missing, the shortest step first, and write the table; return its rows."""
    prepared_folder(plan.folder)
    rows: list[StudyRow] = []
    finest: dict[str, Run] = {}
    for time_step in sorted(set(plan.time_steps)):
        for scheme in dict.fromkeys(plan.schemes):
            directory = plan.folder / "runs" / run_name(f"dt-{time_step!r}", scheme)
            task = Task(directory, plan.case, plan.mesh, plan.days, plan.days, time_step, scheme)
            run, failure = task.carry_out(progress, tell)
            rows.append({"time_step_s": time_step, "scheme": scheme, "failure": failure})
            if run is not None:
                rows[-1] |= _measured(run, finest.setdefault(scheme, run), plan.days)
            write_table(rows, plan.folder / TABLE_FILE)
    return rows


def _measured(run: Run, finest: Run, day: float) -> StudyRow:
    """Conservation at the end, and the difference from the scheme's run with the shortest step (which has none)."""
    row: StudyRow = {"steps": run.steps, "courant_number": float(run.series["courant_number"].max())}
    row |= {name: float(run.series[name][-1]) for name in CONSERVATION}
    if run is finest:
        return row
    ours, theirs, mesh = fields_of(run, day), fields_of(finest, day), run.mesh
    row["thickness_difference_l2"] = scalar_norms(ours.thickness, theirs.thickness, mesh.area_cell).l2
    row["velocity_difference_l2"] = vector_norms(ours.velocity, theirs.velocity, mesh.area_cell).l2
    return row


def by_scheme(rows: Sequence[StudyRow]) -> dict[str, list[StudyRow]]:
    """Rows of each scheme."""
    return {scheme: [row for row in rows if row["scheme"] == scheme] for scheme in schemes_of(rows)}


def orders(rows: Sequence[StudyRow]) -> dict[str, float]:
    """Fitted order of every drawn quantity in the time step, for the rows of one scheme."""
    fitted = {}
    for name in DRAWN:
        present = [(float(row["time_step_s"]), abs(float(row[name]))) for row in rows if name in row]
        fitted[name] = fitted_order(*zip(*present, strict=True)) if present else float("nan")
    return fitted


def time_figure(rows: Sequence[StudyRow], heading: str) -> Figure:
    """Energy drift and time stepping error against the time step, with the slopes of fourth and fifth order."""
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.subplots()
    schemes = schemes_of(rows)
    for number, scheme in enumerate(schemes):
        ours = by_scheme(rows)[scheme]
        fitted = orders(ours)
        for colour, (name, label) in enumerate(DRAWN.items()):
            present = [row for row in ours if row.get(name)]
            steps, values = [row["time_step_s"] for row in present], [abs(float(row[name])) for row in present]
            label = f"{label}, {scheme}" if len(schemes) > 1 else label
            look = {"marker": "o", "color": f"C{colour}", **STYLES[number % len(STYLES)]}
            axes.loglog(steps, values, label=f"{label}: order {fitted[name]:.2f}", **look)
            if number == 0 and len(steps) > 1:
                _slope_guide(axes, steps, values, name, f"C{colour}")
    every = sorted({float(row["time_step_s"]) for row in rows})
    axes.set_xticks(every, [f"{step:g}" for step in every])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("time step (s)")
    axes.set_ylabel("relative change or error")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.suptitle(heading_with(heading, schemes))
    return figure


def _slope_guide(axes: Axes, steps: Sequence[float], values: Sequence[float], name: str, colour: str) -> None:
    """The slope that the order of Runge-Kutta has, a little below the line."""
    order = ORDER_OF_ENERGY_DRIFT if "energy" in name else ORDER_OF_ENERGY_DRIFT - 1
    x = np.array([min(steps), max(steps)], float)
    axes.loglog(x, 0.6 * values[-1] * (x / x[1]) ** order, "--", color=colour, alpha=0.5, label=f"slope {order}")

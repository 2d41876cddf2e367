"""Errors of the rounds of an adaptation against the fine run, and what they cost."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import hexagon_spacing
from mesh.overlap.overlaps import overlaps_of
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.adaptation.energy_density import AVERAGED_SHARE, asked_spacing, time_mean
from postprocess.adaptation.rounds import Adaptation, Plan, cost_per_day
from postprocess.compare.norms import scalar_norms
from postprocess.runs.reading import Run
from postprocess.studies.study_folder import StudyRow
from swe.run.case import Case

UNIFORM, EQUAL_COST, FINE = "uniform", "uniform, equal cost", "fine, against itself"
"""Names of rows beside those of the rounds."""


@dataclass(frozen=True, eq=False)
class Window:
    """What is compared of a run that began on the day `began` of its case: `days` days, from its day `first` on."""

    name: str
    run: Run
    began: float
    first: float
    days: float

    @property
    def last(self) -> float:
        """The day of the run at the end."""
        return self.first + self.days - self.began

    @property
    def averaged_days(self) -> float:
        """Days before the end over which means go."""
        return AVERAGED_SHARE * self.days

    def end(self, field: str) -> Array:
        """The field at the end."""
        return self.run.snapshot(self.last).fields[field]

    def mean(self, field: str) -> Array:
        """The mean of the field over the second half."""
        return time_mean(self.run, field, self.last - self.averaged_days, self.last)

    def halves(self, field: str) -> tuple[Array, Array]:
        """The means of the field over the first and the second half of those days."""
        first, middle = self.last - self.averaged_days, self.last - 0.5 * self.averaged_days
        return time_mean(self.run, field, first, middle), time_mean(self.run, field, middle, self.last)

    @property
    def cell_steps(self) -> float:
        """Cells times steps that the run took for so many days: its cost, whatever the machine."""
        return cost_per_day(self.run) * self.days

    @cached_property
    def spacing(self) -> Array:
        """Spacing of each cell (n_cells,), m: that of a hexagon of its area."""
        return hexagon_spacing(self.run.mesh.area_cell)


@dataclass(frozen=True, eq=False)
class Comparison:
    """A window beside the fine run over the same days.

    `surface` (n_cells,) is how much higher, m, its mean surface is than that of the fine run; `row` holds its mesh, its
    cost, and its errors.
    """

    window: Window
    surface: Array
    row: StudyRow


def windows(plan: Plan, made: Adaptation) -> list[Window]:
    """What is compared, in the order of the report: each round, and uniform meshes over the days of the last one."""
    compared = [
        Window(f"round {each.number}", each.run, each.first_day, each.first_day, plan.days) for each in made.rounds
    ]
    first = made.rounds[-1].first_day
    if not plan.begin_again:
        compared.append(Window(UNIFORM, made.uniform, 0.0, first, plan.days))
    compared.append(Window(EQUAL_COST, made.equal_cost, 0.0, first, plan.days))
    return compared


def comparisons(plan: Plan, made: Adaptation) -> list[Comparison]:
    """Each of the `windows` beside the fine run over the same days."""
    return [_comparison(plan, window, made.fine) for window in windows(plan, made)]


def sampling_row(plan: Plan, made: Adaptation) -> StudyRow:
    """What the errors of a mesh as good as the fine one would be, where the flow is turbulent.

    States then have nothing in common but their statistics. Two means of independent halves of the averaged days differ
    by sqrt(2) times as much as two means over all of them do; for the surface at the end, that in the middle of these
    days is another state.
    """
    fine = Window(FINE, made.fine, 0.0, made.rounds[-1].first_day, plan.days)
    area = fine.run.mesh.area_cell
    middle = fine.run.snapshot(fine.last - 0.5 * fine.averaged_days).fields["thickness"]
    surface, energy = fine.halves("thickness"), fine.halves("kinetic_energy")
    return {
        "name": FINE,
        "scheme": plan.scheme,
        "cells": made.fine.cells,
        "time_step_s": made.fine.time_step,
        "cell_steps": fine.cell_steps,
        "surface_end_m": _root_mean_square(fine.end("thickness") - middle, area),
        "surface_mean_m": _root_mean_square(surface[1] - surface[0], area) / np.sqrt(2.0),
        "energy_mean_l2": _root_mean_square(energy[1] - energy[0], area)
        / (np.sqrt(2.0) * _root_mean_square(fine.mean("kinetic_energy"), area)),
    }


def _comparison(plan: Plan, window: Window, fine: Run) -> Comparison:
    mesh = window.run.mesh
    reference = Window(FINE, fine, 0.0, window.first, window.days)
    from_fine = overlaps_of(fine.mesh, mesh)
    surface, surface_there = _surface(plan.case, window), _surface(plan.case, reference)
    difference = surface[1] - from_fine.means(surface_there[1])
    energy = scalar_norms(
        window.mean("kinetic_energy"), from_fine.means(reference.mean("kinetic_energy")), mesh.area_cell
    )
    row: StudyRow = {
        "name": window.name,
        "scheme": plan.scheme,
        "cells": mesh.n_cells,
        "smallest_km": window.spacing.min() / 1000.0,
        "largest_km": window.spacing.max() / 1000.0,
        "off_the_law": _off_the_law(window, mesh),
        "time_step_s": window.run.time_step,
        "cell_steps": window.cell_steps,
        "surface_end_m": _root_mean_square(surface[0] - from_fine.means(surface_there[0]), mesh.area_cell),
        "surface_mean_m": _root_mean_square(difference, mesh.area_cell),
        "energy_mean_l2": energy.l2,
    }
    return Comparison(window, difference, row)


def _surface(case: Case, window: Window) -> tuple[Array, Array]:
    """Height of the surface (n_cells,), m, at the end and in the mean."""
    bottom = case.topography_on(window.run.mesh, window.run.sampling)
    return window.end("thickness") + bottom, window.mean("thickness") + bottom


def _off_the_law(window: Window, mesh: VoronoiMesh) -> float:
    """Mean of |h / asked - 1| over the cells, h being their spacing and asked that which the density asks for."""
    return float(np.abs(window.spacing / asked_spacing(mesh.mesh_density, mesh.area_cell) - 1.0).mean())


def _root_mean_square(values: Array, area: Array) -> float:
    return float(np.sqrt(np.sum(area * values**2) / area.sum()))

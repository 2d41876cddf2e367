"""Errors of the rounds of an adaptation against the fine run, and what they cost."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import hexagon_spacing
from mesh.overlap.overlaps import overlaps_of
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.adaptation.energy_density import AVERAGED_SHARE, asked_spacing, time_mean
from postprocess.adaptation.rounds import Adaptation, Plan
from postprocess.compare.norms import scalar_norms
from postprocess.runs.reading import Run
from postprocess.studies.study_folder import StudyRow
from swe.run.case import Case


@dataclass(frozen=True, eq=False)
class Window:
    """What is compared of a run that began on the day `began` of its case: `days` days, from its day `first` on."""

    name: str
    run: Run
    began: float
    first: float
    days: float

    def end(self, field: str) -> Array:
        """The field at the end."""
        return self.run.snapshot(self.first + self.days - self.began).fields[field]

    def mean(self, field: str) -> Array:
        """The mean of the field over the second half."""
        last = self.first + self.days - self.began
        return time_mean(self.run, field, last - AVERAGED_SHARE * self.days, last)

    @property
    def cell_steps(self) -> float:
        """Cells times steps that the run took for so many days: its cost, whatever the machine."""
        return self.run.steps * self.run.cells * self.days / float(self.run.days[-1])

    @cached_property
    def spacing(self) -> Array:
        """Spacing of each cell (n_cells,), m: that of a hexagon of its area."""
        return hexagon_spacing(self.run.mesh.area_cell)


def windows(plan: Plan, made: Adaptation) -> list[Window]:
    """What is compared, in the order of the report: each round, and the uniform mesh over the days of the last one."""
    compared = [
        Window(f"round {each.number}", each.run, each.first_day, each.first_day, plan.days) for each in made.rounds
    ]
    if not plan.begin_again:
        compared.append(Window("uniform", made.uniform, 0.0, made.rounds[-1].first_day, plan.days))
    return compared


def rows_of(plan: Plan, made: Adaptation) -> list[StudyRow]:
    """A row for each of the `windows`: its mesh, its cost, and its errors against the fine run over the same days."""
    return [_row(plan, window, made.fine) for window in windows(plan, made)]


def _row(plan: Plan, window: Window, fine: Run) -> StudyRow:
    mesh = window.run.mesh
    reference = Window("fine", fine, 0.0, window.first, window.days)
    from_fine = overlaps_of(fine.mesh, mesh)
    surface, surface_there = _surface(plan.case, window), _surface(plan.case, reference)
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
        "surface_mean_m": _root_mean_square(surface[1] - from_fine.means(surface_there[1]), mesh.area_cell),
        "energy_mean_l2": energy.l2,
    }
    return row


def _surface(case: Case, window: Window) -> tuple[Array, Array]:
    """Height of the surface (n_cells,), m, at the end and in the mean."""
    bottom = case.topography_on(window.run.mesh, window.run.sampling)
    return window.end("thickness") + bottom, window.mean("thickness") + bottom


def _off_the_law(window: Window, mesh: VoronoiMesh) -> float:
    """Mean of |h / asked - 1| over the cells, h being their spacing and asked that which the density asks for."""
    return float(np.abs(window.spacing / asked_spacing(mesh.mesh_density, mesh.area_cell) - 1.0).mean())


def _root_mean_square(values: Array, area: Array) -> float:
    return float(np.sqrt(np.sum(area * values**2) / area.sum()))

"""Compare runs of one case, on the same or on different meshes, with each other or with a solution of the case.

Fields are compared where the run has them, so that its errors are not blurred by interpolation: thickness at cell
centres (less the constant `background_depth` of the case), vorticity at vertices under the areas of the triangles, and
velocity twice. `velocity` is the vector of Williamson et al. (1992) at cell centres, reconstructed from the normal
velocities of a cell's edges: this averages the noise from edge to edge and adds an error of second order of its own.
`normal_velocity`, at edges, is what the model predicts, without either; it is given where the reference has a velocity
at the edges, that is, where it is not a run.
"""

import math
import os
import warnings
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass
from functools import partial

import numpy as np

from mesh.arrays import Array
from mesh.integrals.quadrature import sample_cells
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import surface_in_words
from postprocess.compare.norms import Norms, scalar_norms, vector_norms
from postprocess.compare.solutions import RunSolution, Solution, case_of, choose_solution, require_same_problem
from postprocess.runs.reading import DAY_TOLERANCE, Run, checked, days_in_words, days_of_both, read_run
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError

PERIOD_TOLERANCE = 1e-6
"""Relative difference up to which two planes repeat themselves after the same lengths, which people round."""

SHOWN_DIAGNOSTICS = (
    "mass_change",
    "total_energy_change",
    "potential_enstrophy_change",
    "absolute_vorticity_change",
    "max_speed",
)
"""Diagnostics shown beside the norms; see `swe.output.files.SERIES`."""


@dataclass(frozen=True)
class Fields:
    """What is compared on one mesh: thickness and velocity at cells, vorticity at vertices, in SI units.

    `normal_velocity`, at edges, is None where only a reconstruction of it is known.
    """

    thickness: Array
    velocity: tuple[Array, Array]
    vorticity: Array
    normal_velocity: Array | None


@dataclass(frozen=True)
class Entry:
    """One run on one day: norms by field, empty for the run that is the reference, and diagnostics by name."""

    run: Run
    day: float
    norms: dict[str, Norms]
    conservation: dict[str, float]


@dataclass(frozen=True, repr=False)
class Comparison:
    """Entries of all runs, day by day, and the solution that they are compared with.

    Its `repr` is a table of the norms.
    """

    solution: Solution
    days: tuple[float, ...]
    entries: tuple[Entry, ...]

    def __repr__(self) -> str:
        rows: list[tuple[str, ...]] = [("day", "run", "cells", "field", "l1", "l2", "linf")]
        for entry in self.entries:
            run = (f"{entry.day:g}", str(entry.run.directory), str(entry.run.mesh.n_cells))
            for field, norms in entry.norms.items():
                rows.append((*run, field, *(in_scientific_notation(value) for value in astuple(norms))))
        return f"{self.case}: error norms, reference: {self.solution.name}\n" + _aligned(rows)

    @property
    def compared(self) -> list[Run]:
        """The runs that have norms."""
        return [entry.run for entry in self.entries if entry.norms and entry.day == self.days[-1]]

    @property
    def case(self) -> str:
        """Name of the case."""
        return self.entries[0].run.case


def compare_runs(*runs: Run | AnyPath, reference: Run | AnyPath = "auto", days: Sequence[float] = ()) -> Comparison:
    """Compare runs, open or named by their directories, on `days`; by default on the last day that all of them have.

    `reference` is a run, its directory, "auto", "exact" or a reference file: see
    `postprocess.compare.solutions.choose_solution`. Raises `InputError` if the runs differ in case, surface
    or parameters, if a snapshot is missing, or if there is nothing to compare with.
    """
    if not runs:
        raise InputError("there is nothing to compare; name a run")
    wanted = os.fspath(reference.directory if isinstance(reference, Run) else reference)
    return _comparison([checked(run) if isinstance(run, Run) else read_run(run) for run in runs], wanted, days)


def _comparison(runs: Sequence[Run], reference: str, days: Sequence[float]) -> Comparison:
    for run in runs[1:]:
        _require_same_surface(run, runs[0])
        require_same_problem(run.directory, run.case, run.parameters, runs[0])
    for run in runs:
        for day in days:
            run.require_snapshot(day)
    candidates = list(days) if days else _common_days(runs)
    solution = choose_solution(reference, runs, candidates, every=bool(days))
    if isinstance(solution, RunSolution):
        _require_same_surface(solution.run, runs[0])
    chosen = tuple(sorted(set(days))) if days else (_last_known_day(solution, candidates),)
    background = _background_depth(runs[0])
    entries = [_entry(run, solution, day, background) for day in chosen for run in runs]
    if not any(entry.norms for entry in entries):
        raise InputError(f"{runs[0].directory} is compared with nothing but itself; name another run or reference")
    return Comparison(solution, chosen, tuple(entries))


def fields_of(run: Run, day: float) -> Fields:
    """Fields that a run wrote."""
    fields = run.snapshot(day).fields
    velocity = fields["velocity_zonal"], fields["velocity_meridional"]
    return Fields(fields["thickness"], velocity, fields["relative_vorticity"], fields["normal_velocity"])


def fields_on(run: Run, solution: Solution, day: float) -> Fields:
    """Fields of a solution at the cells, edges and vertices of the mesh of `run`.

    Thickness is the mean over each cell where the run started from means, and the solution is not a run itself.
    """
    mesh = run.mesh
    if isinstance(solution, RunSolution):
        thickness, normal_velocity = solution.thickness(*mesh.coordinates("cell"), day), None
    else:
        thickness = sample_cells(mesh, partial(solution.thickness, day=day), run.sampling)
        zonal, meridional = solution.velocity(*mesh.coordinates("edge"), day)
        normal_velocity = np.cos(mesh.angle_edge) * zonal + np.sin(mesh.angle_edge) * meridional
    return Fields(
        thickness,
        solution.velocity(*mesh.coordinates("cell"), day),
        solution.vorticity(*mesh.coordinates("vertex"), day),
        normal_velocity,
    )


def is_reference(run: Run, solution: Solution) -> bool:
    """Whether the solution is this very run."""
    return isinstance(solution, RunSolution) and solution.run.directory.resolve() == run.directory.resolve()


def _background_depth(run: Run) -> float:
    """Constant depth subtracted from the thickness of `run`; zero, with a warning, if its case cannot be found."""
    case = case_of(run)
    if case is not None:
        return case.background_depth
    warnings.warn(
        f"{run.case}, the case of {run.directory}, cannot be made again from its name and parameters, so norms "
        "of thickness are taken without subtracting a background depth; put its file back if it has one",
        stacklevel=1,
    )
    return 0.0


def _entry(run: Run, solution: Solution, day: float, background: float) -> Entry:
    norms = {} if is_reference(run, solution) else _norms(run, solution, day, background)
    return Entry(run, day, norms, _conservation(run, day))


def _norms(run: Run, solution: Solution, day: float, background: float) -> dict[str, Norms]:
    """Norms of the difference between `run` and `solution` by field, those of thickness less `background`."""
    mesh = run.mesh
    ours, theirs = fields_of(run, day), fields_on(run, solution, day)
    norms = {
        "thickness": scalar_norms(ours.thickness - background, theirs.thickness - background, mesh.area_cell),
        "velocity": vector_norms(ours.velocity, theirs.velocity, mesh.area_cell),
    }
    if ours.normal_velocity is not None and theirs.normal_velocity is not None:
        area_edge = mesh.dc_edge * mesh.dv_edge  # twice that of the quadrilateral round the edge
        norms["normal_velocity"] = scalar_norms(ours.normal_velocity, theirs.normal_velocity, area_edge)
    norms["vorticity"] = scalar_norms(ours.vorticity, theirs.vorticity, mesh.area_triangle)
    return norms


def _conservation(run: Run, day: float) -> dict[str, float]:
    """The last diagnostics written until `day`."""
    until = run.series["time"] <= (day + DAY_TOLERANCE) * SECONDS_PER_DAY
    row = np.count_nonzero(until) - 1
    return {name: float(run.series[name][row]) for name in SHOWN_DIAGNOSTICS}


def _require_same_surface(run: Run, first: Run) -> None:
    if not np.isclose(run.mesh.sphere_radius, first.mesh.sphere_radius, rtol=1e-12, atol=0.0):
        raise InputError(
            f"{run.directory} is on a sphere of radius {run.mesh.sphere_radius:g} m, but {first.directory} on one of "
            f"{first.mesh.sphere_radius:g} m; compare runs on one sphere"
        )
    periods, of_first = ((each.mesh.x_period, each.mesh.y_period) for each in (run, first))
    if not np.allclose(periods, of_first, rtol=PERIOD_TOLERANCE, atol=0.0):
        raise InputError(
            f"{run.directory} is on {surface_in_words(run.mesh)}, but {first.directory} on "
            f"{surface_in_words(first.mesh)}; compare runs on one plane"
        )


def _common_days(runs: Sequence[Run]) -> list[float]:
    """Days after the start on which all runs have a snapshot."""
    days = [float(day) for day in runs[0].days if day > 0.0]
    for run in runs[1:]:
        days = days_of_both(days, run.days)
    if not days:
        of_each = "; ".join(f"{run.directory}: {days_in_words(run.days)}" for run in runs)
        raise InputError(f"the runs have no snapshot in common after the start ({of_each}); run them for longer")
    return days


def _last_known_day(solution: Solution, days: Sequence[float]) -> float:
    """The last of `days`, which ascend, that the solution has."""
    if solution.days is None:
        return days[-1]
    known = days_of_both(sorted(solution.days), days)
    if not known:
        raise InputError(
            f"{solution.name} is known on day {days_in_words(solution.days)}, but the snapshots that all runs have are "
            f"of day {days_in_words(days)}; run again with a snapshot on one of the former days"
        )
    return known[-1]


def in_scientific_notation(value: float) -> str:
    """A norm in print; a dash where it does not exist."""
    return "-" if math.isnan(value) else f"{value:.2e}"


def _aligned(rows: Sequence[Sequence[str]]) -> str:
    """Rows as lines with aligned columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(line.rstrip() for line in lines)


def comparison_record(comparison: Comparison) -> dict[str, object]:
    """The comparison as one JSON object; a norm that does not exist is null."""
    return {
        "case": comparison.case,
        "reference": comparison.solution.name,
        "uncertainty": {f"{day:g}": comparison.solution.uncertainty(day) for day in comparison.days},
        "entries": [
            {
                "run": str(entry.run.directory),
                "cells": entry.run.mesh.n_cells,
                "day": entry.day,
                "norms": {name: _finite(asdict(norms)) for name, norms in entry.norms.items()},
                "conservation": entry.conservation,
            }
            for entry in comparison.entries
        ],
    }


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    return {name: value if np.isfinite(value) else None for name, value in values.items()}

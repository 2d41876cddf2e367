"""The one table of what a run writes: names, places, units, meanings, and how each follows from the state.

History and diagnostics files, their readers and the plots all follow it.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import velocity_at_cells
from swe.diagnostics.budgets import measure_rates, rate_series, rates_of_time
from swe.diagnostics.invariants import Changes, Invariants, measure_invariants, relative_changes
from swe.equations.model import Diagnosis, ShallowWaterModel
from swe.equations.terms import Term
from swe.errors import InputError
from swe.parallel.processes import Place
from swe.state import State

CELLS, EDGES, VERTICES = "nCells", "nEdges", "nVertices"
"""Places of fields, by the names of the dimensions in files."""

PLACES: dict[str, Place] = {CELLS: "cells", EDGES: "edges", VERTICES: "vertices"}
"""The same, as processes call them."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A state and everything that outputs are made of, each computed on first use.

    `tendency(state, result, time)` is the one with which the run takes its steps; `initial` are its initial invariants.
    """

    model: ShallowWaterModel
    state: State
    time: float
    courant_number: float
    tendency: Callable[[State, State, float], None]
    initial: Invariants

    @cached_property
    def diagnosis(self) -> Diagnosis:
        """Vorticities and kinetic energy."""
        return self.model.diagnose(self.state)

    @cached_property
    def velocity(self) -> tuple[Array, Array]:
        """Eastward and northward velocity at cells, m/s."""
        return velocity_at_cells(self.model.mesh, self.state.normal_velocity)

    @cached_property
    def invariants(self) -> Invariants:
        """Global integrals."""
        return measure_invariants(self.model, self.state, self.diagnosis)

    @cached_property
    def changes(self) -> Changes:
        """Their relative changes since the start."""
        return relative_changes(self.initial, self.invariants)

    @cached_property
    def rates(self) -> dict[str, float]:
        """Rates of the global integrals, except those of the time step."""
        tendency = self.state.empty_like()
        self.tendency(self.state, tendency, self.time)
        self.model.processes.exchange(tendency)
        return measure_rates(self.model, self.state, self.diagnosis, tendency, self.time)

    @property
    def largest_speed(self) -> float:
        """Largest speed sqrt(2 K) over all cells, m/s."""
        processes = self.model.processes
        largest = processes.largest(np.array([self.diagnosis.kinetic_energy[processes.own.cells].max()]))
        return float(np.sqrt(2.0 * largest[0]))


@dataclass(frozen=True)
class Field:
    """A field that snapshots hold: where it lives, its units, meaning and CF standard name, if there is one.

    `cell_mean` tells that the values are means over cells, by which the scheme conserves the field.
    """

    place: str
    units: str
    meaning: str
    value: Callable[[Evaluation], Array]
    standard_name: str = ""
    cell_mean: bool = False

    def cell_methods(self, time: str) -> str:
        """How values stand for their cells and moments, as CF says it; `time` is the name of the time coordinate."""
        return f"{'area: mean ' if self.cell_mean else ''}{time}: point"


FIELDS = {
    "thickness": Field(
        CELLS, "m", "thickness of the fluid", lambda now: now.state.thickness, "cell_thickness", cell_mean=True
    ),
    "surface_height": Field(
        CELLS,
        "m",
        "height of the free surface, thickness plus topography",
        lambda now: now.state.thickness + now.model.topography,
    ),
    "kinetic_energy": Field(
        CELLS,
        "m2 s-2",
        "kinetic energy per unit mass",
        lambda now: now.diagnosis.kinetic_energy,
        "specific_kinetic_energy_of_air",
    ),
    "velocity_zonal": Field(
        CELLS,
        "m s-1",
        "eastward velocity, least squares over the edges of the cell",
        lambda now: now.velocity[0],
        "eastward_wind",
    ),
    "velocity_meridional": Field(
        CELLS,
        "m s-1",
        "northward velocity, least squares over the edges of the cell",
        lambda now: now.velocity[1],
        "northward_wind",
    ),
    "normal_velocity": Field(
        EDGES, "m s-1", "velocity along the normal, from cellsOnEdge 1 to 2", lambda now: now.state.normal_velocity
    ),
    "relative_vorticity": Field(
        VERTICES,
        "s-1",
        "relative vorticity",
        lambda now: now.diagnosis.relative_vorticity,
        "atmosphere_relative_vorticity",
    ),
    "potential_vorticity": Field(
        VERTICES, "m-1 s-1", "potential vorticity (f + zeta)/h", lambda now: now.diagnosis.potential_vorticity
    ),
}
"""Fields of the snapshots by name; a run writes all of them, or those chosen by the user."""

TOPOGRAPHY = Field(CELLS, "m", "height of the bottom", lambda now: now.model.topography, "surface_altitude")
"""The field that stays fixed, and is written to the history once."""


@dataclass(frozen=True)
class Series:
    """A number that each row of the diagnostics holds; no `value` if it follows from two rows."""

    units: str
    meaning: str
    value: Callable[[Evaluation], float] | None = None


def _rate(name: str) -> Callable[[Evaluation], float]:
    return lambda now: now.rates[name]


def series_of(terms: Iterable[Term] = ()) -> dict[str, Series]:
    """Series by name of a run with these terms."""
    return {
        "mass": Series("m3", "integral of thickness", lambda now: now.invariants.mass),
        "mass_change": Series("1", "change of mass relative to the initial mass", lambda now: now.changes.mass),
        "total_energy": Series("m5 s-2", "kinetic plus potential energy", lambda now: now.invariants.total_energy),
        "total_energy_change": Series(
            "1",
            "change of total energy relative to the initial available energy",
            lambda now: now.changes.total_energy,
        ),
        "total_energy_change_of_total": Series(
            "1",
            "change of total energy relative to the initial total energy",
            lambda now: now.changes.total_energy_of_total,
        ),
        "kinetic_energy": Series("m5 s-2", "kinetic energy", lambda now: now.invariants.kinetic_energy),
        "available_potential_energy": Series(
            "m5 s-2",
            "potential energy above that of a level surface",
            lambda now: now.invariants.available_potential_energy,
        ),
        "potential_enstrophy": Series("m s-2", "integral of h q2 / 2", lambda now: now.invariants.potential_enstrophy),
        "potential_enstrophy_change": Series(
            "1",
            "change of potential enstrophy relative to its initial value",
            lambda now: now.changes.potential_enstrophy,
        ),
        "absolute_vorticity": Series("m2 s-1", "integral of f + zeta", lambda now: now.invariants.absolute_vorticity),
        "absolute_vorticity_change": Series(
            "1",
            "change of absolute vorticity relative to the integral of |f|",
            lambda now: now.changes.absolute_vorticity,
        ),
        "courant_number": Series(
            "1",
            "largest (sqrt(g h) + |u|) dt / d over all edges, |u| dt / d if the wind is prescribed",
            lambda now: now.courant_number,
        ),
        "max_speed": Series("m s-1", "largest speed sqrt(2 K) over all cells", lambda now: now.largest_speed),
        **{
            name: Series(units, meaning, None if name.endswith("_time") else _rate(name))
            for name, (units, meaning) in rate_series(terms).items()
        },
    }


SERIES = series_of()
"""Series of every run; the user's own terms add theirs."""


def diagnostics_row(
    now: Evaluation, series: Mapping[str, Series], before: Mapping[str, float] | None
) -> dict[str, float]:
    """The row of these `series` that follows the row `before`, with `time`, seconds since the start."""
    row = {"time": now.time, **{name: each.value(now) for name, each in series.items() if each.value is not None}}
    return {**row, **rates_of_time(row, before, now.model.terms)}


def chosen_fields(names: Iterable[str] | None) -> tuple[str, ...]:
    """The requested names of `FIELDS`, in the order of the table; all of them if `names` is None.

    Raises `InputError` if a name is unknown, or none is requested.
    """
    if names is None:
        return tuple(FIELDS)
    asked = [names] if isinstance(names, str) else list(names)
    for name in asked:
        if name not in FIELDS:
            raise InputError(f"there is no output field {name!r}; choose among {', '.join(FIELDS)}")
    if not asked:
        raise InputError(f"no output fields are asked for; choose among {', '.join(FIELDS)}")
    return tuple(name for name in FIELDS if name in asked)

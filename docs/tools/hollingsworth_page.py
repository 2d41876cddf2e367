"""Hollingsworth instability, for docs/verification.md: python docs/tools/hollingsworth_page.py FOLDER.

Two things are measured for both schemes, without and with biharmonic dissipation. The departure of a run from the exact
steady state is what the instability makes of the truncation error. Small disturbances of the steady state itself, held
by adding what the tendency lacks, show how fast the instability grows, whatever the truncation error.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from matplotlib.figure import Figure

from cases import Hollingsworth
from mesh import VoronoiMesh, scvt_mesh
from mesh.arrays import Array
from postprocess.compare.norms import scalar_norms
from postprocess.runs.folders import prepared_folder
from postprocess.studies.lines import STYLES
from postprocess.studies.table1_page import save
from swe import RunError, Simulation, State
from swe.configuration import SchemeName
from swe.constants import SECONDS_PER_DAY
from swe.equations.dissipation import BiharmonicDissipation
from swe.stepping.time_stepping import RungeKutta

CELLS = 2562
SCHEMES: tuple[SchemeName, ...] = get_args(SchemeName)
TABLE_DAYS = {50.0: 10.0, 5.0: 16.0}
"""Depths, m, and the day on which the table has the departure."""

DISSIPATIONS = (0.0, 1e16)
"""Coefficients, m4/s; the second damps the shortest waves, of two cells, within 15 hours."""

DAYS = 40.0
ROWS_PER_DAY = 2

DISTURBANCE = 1e-6
"""Root mean square of the velocity of a disturbance, m/s, small enough for its growth to be linear."""

SETTLING_DAYS, MEASURED_DAYS = 160, 40
"""Growth is that of the last days, when the fastest growing disturbance has outgrown all others."""


@dataclass(frozen=True)
class Setting:
    """One run: depth, m, scheme, and coefficient of dissipation, m4/s."""

    depth: float
    scheme: SchemeName
    dissipation: float

    def simulation(self, mesh: VoronoiMesh) -> Simulation:
        """The run at its start."""
        return Simulation(mesh, Hollingsworth(depth=self.depth), scheme=self.scheme, dissipation=self.dissipation)


@dataclass(frozen=True)
class Growth:
    """What came of a run: days, departures of velocity from the start, and the day on which it failed, or None."""

    days: list[float]
    departures: list[float]
    failed_on: float | None

    def on(self, day: float) -> float | None:
        """The departure on a day, None if the run had failed."""
        return self.departures[self.days.index(day)] if day in self.days else None


def departures(mesh: VoronoiMesh, setting: Setting, days: float = DAYS) -> Growth:
    """Run for `days` or until the run fails; departures are relative l2 norms of the normal velocity."""
    simulation = setting.simulation(mesh)
    start, area = simulation.state.normal_velocity.copy(), _area_edge(simulation.mesh)
    growth = Growth([], [], None)
    for row in range(1, round(days * ROWS_PER_DAY) + 1):
        try:
            simulation.run(until=row / ROWS_PER_DAY, progress=False)
        except RunError:
            return Growth(growth.days, growth.departures, simulation.time / SECONDS_PER_DAY)
        growth.days.append(row / ROWS_PER_DAY)
        growth.departures.append(scalar_norms(simulation.state.normal_velocity, start, area).l2)
    return growth


def growth_rate(
    mesh: VoronoiMesh, setting: Setting, settling: int = SETTLING_DAYS, measured: int = MEASURED_DAYS
) -> float:
    """Growth rate of the fastest growing small disturbance of the steady state, 1/day; negative where all decay."""
    simulation = setting.simulation(mesh)
    base, area = simulation.state.copy(), _area_edge(simulation.mesh)
    missing = base.empty_like()
    simulation.model.tendency(base, missing)
    dissipation = BiharmonicDissipation(simulation.mesh, setting.dissipation)

    def tendency(state: State, slope: State, time: float) -> None:
        simulation.model.tendency(state, slope, time)
        slope.thickness[:] -= missing.thickness
        slope.normal_velocity[:] -= missing.normal_velocity
        slope.normal_velocity[:] += dissipation.acceleration(state.normal_velocity - base.normal_velocity)

    time_step = simulation.configuration.time_step
    steps, state = round(SECONDS_PER_DAY / time_step), base.copy()
    method, grown = RungeKutta(tendency, state), []
    state.normal_velocity[:] += np.random.default_rng(1).normal(size=len(area))
    for _ in range(settling + measured):
        size = _size(state.normal_velocity - base.normal_velocity, area) / DISTURBANCE
        for now, then in ((state.thickness, base.thickness), (state.normal_velocity, base.normal_velocity)):
            now[:] = then + (now - then) / size
        method.advance(state, time_step, steps)
        grown.append(np.log(_size(state.normal_velocity - base.normal_velocity, area) / DISTURBANCE))
    return float(np.mean(grown[-measured:])) * SECONDS_PER_DAY / (steps * time_step)


def _area_edge(mesh: VoronoiMesh) -> Array:
    return mesh.dc_edge * mesh.dv_edge


def _size(velocity: Array, area: Array) -> float:
    return float(np.sqrt(np.sum(area * velocity**2) / area.sum()))


def table_lines(found: dict[Setting, tuple[Growth, float]]) -> list[str]:
    """The table in Markdown: a line for each depth and dissipation, the schemes side by side."""
    names = [f"departure, {scheme}" for scheme in SCHEMES] + [f"fails on day, {scheme}" for scheme in SCHEMES]
    names += [f"growth of disturbances (1/day), {scheme}" for scheme in SCHEMES]
    lines = ["| depth (m) | dissipation (m4/s) | day | " + " | ".join(names) + " |", "|---" * (3 + len(names)) + "|"]
    for depth, dissipation in dict.fromkeys((each.depth, each.dissipation) for each in found):
        ours = [found[Setting(depth, scheme, dissipation)] for scheme in SCHEMES]
        day = TABLE_DAYS[depth]
        cells = [_in_words(growth.on(day), ".2e") for growth, _ in ours]
        cells += [_in_words(growth.failed_on, ".1f") for growth, _ in ours] + [f"{rate:.3f}" for _, rate in ours]
        lines.append(f"| {depth:g} | {dissipation:.0e} | {day:g} | " + " | ".join(cells) + " |")
    return lines


def _in_words(value: float | None, digits: str) -> str:
    return "" if value is None else format(value, digits)


def growth_figure(found: dict[Setting, tuple[Growth, float]]) -> Figure:
    """Departures against time, one panel for each depth; schemes by line style, dissipation by colour."""
    depths = list(dict.fromkeys(setting.depth for setting in found))
    figure = Figure(figsize=(4.6 * len(depths) + 0.4, 4.2), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(depths), sharey=True))
    for axes, depth in zip(panels, depths, strict=True):
        for setting, (growth, _) in found.items():
            if setting.depth == depth:
                damped = f", dissipation {setting.dissipation:.0e} m⁴/s" if setting.dissipation else ""
                look: dict[str, str] = {"label": setting.scheme + damped}
                look["linestyle"] = STYLES[SCHEMES.index(setting.scheme)]["linestyle"]
                look["color"] = colour = f"C{DISSIPATIONS.index(setting.dissipation)}"
                axes.semilogy(growth.days, growth.departures, **look)
                if growth.failed_on is not None:
                    axes.plot(growth.days[-1], growth.departures[-1], "x", color=colour, markersize=8)
        axes.set_title(f"{depth:g} m", fontsize=10)
        axes.set_xlabel("day")
        axes.grid(alpha=0.3, which="both")
    panels[0].set_ylabel("relative departure of velocity, l2")
    panels[0].legend(fontsize=8)
    figure.suptitle(f"Departure from the steady state, {CELLS} cells (x: the run fails)")
    return figure


def measure(mesh: VoronoiMesh) -> dict[Setting, tuple[Growth, float]]:
    """Departures and growth rates in all settings."""
    settings = [
        Setting(depth, scheme, dissipation)
        for depth in TABLE_DAYS
        for dissipation in DISSIPATIONS
        for scheme in SCHEMES
    ]
    return {setting: (departures(mesh, setting), growth_rate(mesh, setting)) for setting in settings}


def main() -> None:
    """Write the figure to the folder, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where hollingsworth.png goes")
    folder = parser.parse_args().folder
    prepared_folder(folder)
    found = measure(scvt_mesh(CELLS))
    print("\n".join([*table_lines(found), "", save(growth_figure(found), folder, "hollingsworth")]))


if __name__ == "__main__":
    main()

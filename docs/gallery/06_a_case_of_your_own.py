"""
A case of your own, with its own term
=====================================

A case is a small class: its fields are functions of longitude and latitude, and ``terms`` adds what the equations lack.
"""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import ClassVar

import matplotlib.pyplot as plt
import numpy as np

import trisk

# %%
# An ocean at rest, 4000 m deep, under a storm that moves westwards along 20° N. The storm is a term: a function of the
# mesh, the state and the time, s, that gives an acceleration along the normals of the edges, m/s².


def storm(mesh, state, time):
    """Winds round a low that crosses 10 degrees of longitude a day."""
    centre = np.deg2rad(-10.0) * time / 86400.0
    east, north = mesh.lon_edge - centre, mesh.lat_edge - np.deg2rad(20.0)
    east = (east + np.pi) % (2.0 * np.pi) - np.pi
    strength = 1e-3 / 0.1 * np.exp(-(east**2 + north**2) / 0.1**2)
    depth = state.thickness[mesh.cells_on_edge].mean(axis=1)
    return trisk.normal_component(mesh, -strength * north, strength * east) / depth


@dataclass(frozen=True)
class Storm(trisk.Case):
    """A storm over an ocean at rest."""

    name: ClassVar[str] = "storm"
    title: ClassVar[str] = "Storm"
    recommended_days: ClassVar[float] = 3.0

    depth: float = trisk.parameter(4000.0, "m", "Depth of the ocean")
    drag: float = trisk.parameter(1e-6, "1/s", "Rate of the linear drag")

    def thickness(self, longitude, latitude, time=0.0):
        """Give the depth."""
        return self.depth

    def streamfunction(self, longitude, latitude, time=0.0):
        """Give zero, that of an ocean at rest."""
        return 0.0

    def terms(self):
        """Give the storm, and a drag that comes with the package."""
        return trisk.Forcing("storm", acceleration=storm), trisk.LinearDrag(self.drag)


# %%
# It runs as any other case.

folder = TemporaryDirectory()
simulation = trisk.Simulation(trisk.scvt_mesh(2562), Storm(), Path(folder.name) / "storm")
simulation.run(days=3)
run = trisk.open_run(Path(folder.name) / "storm")

figure, axes = plt.subplots(1, 3, figsize=(14, 4.6), layout="constrained")
for ax, day in zip(axes, (1, 2, 3), strict=True):
    values = run.snapshot(day).fields["thickness"] - 4000.0
    trisk.plot_field(run, values, ax, centre=(-10.0 * day, 20), extent=60, label="height of the surface (m)")
    ax.set_title(f"day {day}")

# %%
# The diagnostics of the run have the work of each term under its name.

figure, ax = plt.subplots(layout="constrained")
for term in ("storm", "linear_drag"):
    ax.plot(run.series["time"] / 86400.0, run.series[f"total_energy_rate_{term}"], label=term)
ax.set_xlabel("time (days)")
ax.set_ylabel("rate of total energy (m⁵ s⁻³)")
ax.legend()

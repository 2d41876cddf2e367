"""A closed sea with islands: rest stays rest, and free turbulence keeps mass and energy.

`python -m tests.reliability.closed_sea CELLS` prints the table of docs/reliability.md for a random sea, in some
minutes, and `python -m tests.reliability.closed_sea CELLS REGION` that for CELLS cells that fill a real sea up to its
coast.
"""

import sys
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases import LakeAtRest
from cases.base import Case
from mesh import VoronoiMesh, scvt_mesh
from mesh.arrays import Array
from mesh.coast.generation import region_mesh
from mesh.discrete.walls import wall_edges
from mesh.mesh_request import MeshRequest
from mesh.regions.find import find_region
from swe import Simulation
from swe.constants import GRAVITY, ROTATION_RATE
from swe.diagnostics.invariants import Invariants
from tests.cut_mesh import random_sea

OPTIONS: dict[str, dict[str, object]] = {
    "ringler2010, no slip": {},
    "ringler2010, free slip": {"wall_slip": 1.0},
    "ringler2010, no slip, APVM 0.5": {"anticipation": 0.5},
    "consistent, no slip": {"scheme": "consistent"},
    "consistent, free slip": {"scheme": "consistent", "wall_slip": 1.0},
    "consistent, slip 0.5, upwinding 0.2": {"scheme": "consistent", "wall_slip": 0.5, "upwinding": 0.2},
}

IN_REAL_SEAS = ("ringler2010, no slip", "consistent, no slip")
"""Options with which real seas are tried."""

LONG_EDDIES = 7.0
"""Radians of phase for each radian of the sphere: eddies some 6000 km long."""

REAL_SEA_EDDIES = 30.0
"""The same for real seas: eddies some 1300 km long, of which the North Atlantic has room for dozens."""


@dataclass(frozen=True)
class RoughLake(LakeAtRest):
    """Water at rest over a bottom that is random from cell to cell, from 100 m to 6000 m deep."""

    surface_height: float = 6000.0

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Independent of the neighbours."""
        return np.random.default_rng(5).uniform(0.0, 5900.0, longitude.shape)


@dataclass(frozen=True)
class FreeTurbulence(Case):
    """Eddies from a random streamfunction of waves, in balance with the surface away from coasts.

    `wavenumber` is radians of phase for each radian of the sphere.
    """

    name: ClassVar[str] = "free-turbulence"
    title: ClassVar[str] = "Free turbulence"
    recommended_days: ClassVar[float] = 50.0
    depth: ClassVar[float] = 2000.0
    speed: ClassVar[float] = 5.0

    wavenumber: float = LONG_EDDIES

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """From the bottom to the surface."""
        surface = 2.0 * ROTATION_RATE * np.sin(latitude) * self.streamfunction(longitude, latitude) / GRAVITY
        return self.depth + surface - self.topography(longitude, latitude)

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Ridges of some hundred metres."""
        return 100.0 * _waves(longitude, latitude, self.wavenumber, seed=2)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """About as much as gives the flow its speed, m/s."""
        return self.speed * self.radius / self.wavenumber * _waves(longitude, latitude, self.wavenumber, seed=1)


def _waves(longitude: Array, latitude: Array, wavenumber: float, seed: int) -> Array:
    """The sum of thirty plane waves in space with random directions and phases, of unit variance."""
    random = np.random.default_rng(seed)
    towards = random.normal(size=(30, 3))
    towards *= wavenumber / np.linalg.norm(towards, axis=1, keepdims=True)
    x, y, z = np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)
    values: Array = sum(
        np.cos(k[0] * x + k[1] * y + k[2] * z + phase)
        for k, phase in zip(towards, random.uniform(0.0, 2.0 * np.pi, 30), strict=True)
    ) / np.sqrt(15.0)
    return values


def speed_at_rest(sea: VoronoiMesh, days: float, **options: object) -> float:
    """Largest speed, m/s, of the lake after so many days."""
    simulation = Simulation(sea, RoughLake(), **options)  # type: ignore[arg-type]
    simulation.run(days=days, progress=False)
    return float(np.abs(simulation.state.normal_velocity).max())


def turbulence(
    sea: VoronoiMesh, days: float, wavenumber: float = LONG_EDDIES, **options: object
) -> tuple[Simulation, dict[str, float]]:
    """A run of free turbulence with rrk4, and the largest relative changes of mass and energy at its quarters."""
    simulation = Simulation(sea, FreeTurbulence(wavenumber=wavenumber), **{"integrator": "rrk4", **options})  # type: ignore[arg-type]
    start, worst = simulation.initial_invariants, {"mass": 0.0, "total_energy": 0.0, "available_energy": 0.0}
    for quarter in range(1, 5):
        simulation.run(until=0.25 * days * quarter, progress=False)
        for name, change in _changes(start, simulation.invariants).items():
            worst[name] = max(worst[name], change)
    return simulation, worst


def _changes(start: Invariants, now: Invariants) -> dict[str, float]:
    """Of mass, and of energy as a part of the total and of the available energy."""
    energy = abs(now.total_energy - start.total_energy)
    return {
        "mass": abs(now.mass / start.mass - 1.0),
        "total_energy": energy / start.total_energy,
        "available_energy": energy / start.available_energy,
    }


def main(cells: int, region: str | None = None) -> None:
    """Print the table of a random sea, or of a real one."""
    if region is None:
        sea, schemes, wavenumber = random_sea(scvt_mesh(cells)), tuple(OPTIONS), LONG_EDDIES
        print(f"{sea.n_cells} of {cells} cells are sea\n")
    else:
        sea, schemes = region_mesh(find_region(region), MeshRequest(cells=cells)), IN_REAL_SEAS
        wavenumber = REAL_SEA_EDDIES
        print(f"{sea.n_cells} cells fill {region}, {len(wall_edges(sea))} edges are walls\n")
    print("| scheme | speed of the lake, m/s | mass | energy | of available | enstrophy | kinetic energy |")
    print("|---|---|---|---|---|---|---|")
    for name in schemes:
        still = speed_at_rest(sea, 10.0, **OPTIONS[name])
        run, worst = turbulence(sea, FreeTurbulence.recommended_days, wavenumber, **OPTIONS[name])
        start, now = run.initial_invariants, run.invariants
        numbers = " | ".join(f"{value:.1e}" for value in (still, *worst.values()))
        enstrophy = now.potential_enstrophy / start.potential_enstrophy - 1.0
        kinetic = now.kinetic_energy / start.kinetic_energy - 1.0
        print(f"| {name} | {numbers} | {enstrophy:+.2f} | {kinetic:+.2f} |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])

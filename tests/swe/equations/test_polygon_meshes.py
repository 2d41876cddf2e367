"""The model on a polygon in the plane: water at rest stays so, and mass and energy are kept."""

from dataclasses import dataclass

import numpy as np
import pytest

from cases import PlaneCase
from mesh import VoronoiMesh, polygon_mesh
from mesh.arrays import Array
from swe import Simulation
from tests.mesh.polygon.rooms import ROOMS, asked_for

pytest.importorskip("shapely")


@dataclass(frozen=True)
class Hump(PlaneCase):
    """Water that is higher in a corner, at rest."""

    height: float = 100.0
    name = "hump"
    title = "a hump in a corner"
    recommended_days = 1.0

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        return 1000.0 + self.height * np.exp(-(x**2 + y**2) / 2e5**2)

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        return np.zeros_like(x), np.zeros_like(x)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        return np.zeros_like(x)


@pytest.fixture(scope="module")
def room() -> VoronoiMesh:
    return polygon_mesh(ROOMS["angled"], asked_for(200))


def test_water_at_rest_stays_at_rest(room: VoronoiMesh) -> None:
    simulation = Simulation(room, Hump(height=0.0))
    simulation.run(days=0.5, progress=False)
    assert np.abs(simulation.state.normal_velocity).max() == 0.0


@pytest.mark.parametrize("scheme", ["ringler2010", "consistent"])
def test_mass_and_energy_are_kept(room: VoronoiMesh, scheme: str) -> None:
    simulation = Simulation(room, Hump(), scheme=scheme, integrator="rrk4")  # type: ignore[arg-type]
    before = simulation.invariants
    simulation.run(days=1.0, progress=False)
    after = simulation.invariants
    assert np.abs(simulation.state.normal_velocity).max() > 0.5
    assert abs(after.mass / before.mass - 1.0) < 1e-13
    assert abs(after.total_energy / before.total_energy - 1.0) < 1e-13

from dataclasses import dataclass

import numpy as np
import pytest

from cases import LakeAtRest, Williamson2
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe import Simulation
from swe.diagnostics.invariants import relative_changes


def test_integrals_of_solid_rotation(larger_mesh: VoronoiMesh) -> None:
    """Closed forms for the steady flow: h = h0 - c sin^2, u = u0 cos."""
    case = Williamson2()
    found = Simulation(larger_mesh, case).initial_invariants
    a, g, u0, omega, h0 = case.radius, case.gravity, case.wind_speed, case.rotation_rate, case.reference_depth
    c = (a * omega * u0 + u0**2 / 2) / g
    sphere = 4 * np.pi * a**2
    assert found.mass == pytest.approx(sphere * (h0 - c / 3), rel=1e-5)
    kinetic = sphere * 0.5 * u0**2 * (h0 * 2 / 3 - c * 2 / 15)
    assert found.kinetic_energy == pytest.approx(kinetic, rel=2e-3)
    assert found.potential_energy == pytest.approx(sphere * g / 2 * (h0**2 - 2 * h0 * c / 3 + c**2 / 5), rel=1e-4)
    assert found.available_potential_energy == pytest.approx(sphere * g / 2 * c**2 * 4 / 45, rel=2e-3)
    assert found.planetary_vorticity_magnitude == pytest.approx(sphere * omega, rel=1e-3)
    assert abs(found.absolute_vorticity) < 1e-10 * found.planetary_vorticity_magnitude
    sine = np.linspace(-1, 1, 200001)
    enstrophy = 0.5 * (2 * omega * sine + 2 * u0 / a * sine) ** 2 / (h0 - c * sine**2)
    assert found.potential_enstrophy == pytest.approx(sphere * enstrophy.mean(), rel=2e-3)


def test_available_energy_differs_from_total_by_a_constant_of_the_mass(icosahedral_mesh: VoronoiMesh) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson2())
    start = simulation.initial_invariants
    simulation.run(days=0.5, progress=False)
    now = simulation.invariants
    total = now.total_energy - start.total_energy
    assert now.available_energy - start.available_energy == pytest.approx(total, abs=1e-9 * start.available_energy)
    changes = relative_changes(start, now)
    assert changes.total_energy / changes.total_energy_of_total == pytest.approx(
        start.total_energy / start.available_energy, rel=1e-9
    )


@dataclass(frozen=True)
class Basin(LakeAtRest):
    """Fluid at rest, 1000 m deep, over a flat bottom."""

    bottom: float = 0.0

    def topography(self, longitude: Array, latitude: Array) -> Array:
        return np.full(longitude.shape, self.bottom)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        return np.full(longitude.shape, 1000.0)


@pytest.mark.parametrize("bottom", [-1000.0, -500.0, 0.0, 500.0])
def test_yardsticks_of_energy_do_not_depend_on_where_heights_count_from(
    icosahedral_mesh: VoronoiMesh, bottom: float
) -> None:
    """The total energy of fluid at rest is negative over a bottom at -depth, and zero over one at -depth/2."""
    simulation = Simulation(icosahedral_mesh, Basin(bottom=bottom))
    start = simulation.initial_invariants
    assert np.sign(start.total_energy) == np.sign(bottom + 500.0)
    simulation.state.normal_velocity[:] = 1.0
    now = simulation.invariants
    changes = relative_changes(start, now)
    gained = now.kinetic_energy / (0.5 * simulation.case.gravity * 1000.0 * start.mass)
    assert changes.total_energy == pytest.approx(gained, rel=1e-9, abs=0.0)
    assert changes.total_energy_of_total == pytest.approx(gained / abs(1.0 + bottom / 500.0 or 1.0), rel=1e-9, abs=0.0)

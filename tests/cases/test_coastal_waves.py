"""The seiche and the Kelvin wave: their solutions obey the equations, and the model carries them at the right speed."""

import numpy as np
import pytest

from basins_page import LATTICES, basin_of, channel, filled, filled_channel, kelvin_error, seiche_error, tilted
from cases import KelvinWave, Seiche
from cases.basins import Wave
from cases.differences import gradient
from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.discrete.operators import normal_component
from mesh.discrete.walls import wall_edges
from swe import InputError, Simulation

pytestmark = pytest.mark.slow

WAVES = [Seiche(), Seiche(degree=1, order=1), Seiche(degree=3, order=1, depth=500.0), KelvinWave(wave_number=2)]


@pytest.mark.parametrize("case", WAVES, ids=lambda case: f"{case.name} {case.parameters()}"[:40])
def test_waves_obey_the_linear_equations(case: Wave) -> None:
    random = np.random.default_rng(5)
    longitude, latitude = random.uniform(0.0, 6.2, 100), random.uniform(0.1, 0.9, 100)
    time, step, a = 40000.0, 10.0, case.radius

    def height(longitude: Array, latitude: Array) -> Array:
        return case.thickness(longitude, latitude, time) + case.topography(longitude, latitude)

    eastward, northward = case.velocity(longitude, latitude, time)
    rates = [
        (case.velocity(longitude, latitude, time + step)[i] - case.velocity(longitude, latitude, time - step)[i])
        / (2.0 * step)
        for i in range(2)
    ]
    f, slope = case.coriolis(longitude, latitude), gradient(height, longitude, latitude)
    size = case.gravity * np.abs(slope).max() / a
    np.testing.assert_allclose(rates[0] - f * northward, -case.gravity * slope[0] / a, atol=1e-5 * size)
    np.testing.assert_allclose(rates[1] + f * eastward, -case.gravity * slope[1] / a, atol=1e-5 * size)

    rest = case.depth - case.topography(longitude, latitude)
    moved = 1e-4

    def flux(turn: float, lift: float) -> tuple[Array, Array]:
        there = longitude + turn, latitude + lift
        bottom = case.depth - case.topography(*there)
        u, v = case.velocity(*there, time)
        return bottom * u, bottom * v * np.cos(there[1])

    divergence = (flux(moved, 0.0)[0] - flux(-moved, 0.0)[0] + flux(0.0, moved)[1] - flux(0.0, -moved)[1]) / (
        2.0 * moved * a * np.cos(latitude)
    )
    risen = case.thickness(longitude, latitude, time + step) - case.thickness(longitude, latitude, time - step)
    np.testing.assert_allclose(risen / (2.0 * step), -divergence, atol=1e-5 * np.abs(divergence).max())
    assert rest.min() > 0.0
    assert np.abs(divergence).max() > 1e-8


@pytest.mark.parametrize("case", WAVES, ids=lambda case: f"{case.name} {case.parameters()}"[:40])
def test_nothing_crosses_the_coast_and_the_height_is_the_amplitude(case: Wave) -> None:
    longitude = np.linspace(0.0, 2.0 * np.pi, 721)
    speed = np.abs(case.velocity(longitude, np.full(721, 0.3), 30000.0)).max()
    np.testing.assert_allclose(case.velocity(longitude, np.zeros(721), 30000.0)[1], 0.0, atol=1e-9 * speed)
    grid, latitude = np.meshgrid(longitude, np.linspace(0.0, 0.5 * np.pi, 501))
    height = case.thickness(grid, latitude) + case.topography(grid, latitude) - case.depth
    assert np.abs(height).max() == pytest.approx(case.amplitude, rel=1e-4)


@pytest.mark.parametrize("case", [KelvinWave(wave_number=2)])
def test_vorticity_is_that_of_the_velocity(case: Wave) -> None:
    longitude, latitude, step = np.linspace(0.0, 6.0, 30), np.linspace(0.1, 0.9, 30), 1e-5

    def along(latitude: Array) -> Array:
        return case.velocity(longitude, latitude, 1000.0)[0] * np.cos(latitude)

    expected = -(along(latitude + step) - along(latitude - step)) / (2.0 * step * case.radius * np.cos(latitude))
    found = case.vorticity(longitude, latitude, 1000.0)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_the_start_is_the_velocity_at_edges(larger_mesh: VoronoiMesh) -> None:
    case = KelvinWave()
    simulation = Simulation(basin_of(larger_mesh, case), case)
    mesh, u = simulation.mesh, simulation.state.normal_velocity
    expected = normal_component(mesh, *case.velocity(mesh.lon_edge, mesh.lat_edge))
    expected[wall_edges(mesh)] = 0.0
    np.testing.assert_array_equal(u, expected)
    assert np.abs(u).max() > 1e-3


def test_the_frequency_of_the_seiche(larger_mesh: VoronoiMesh) -> None:
    """On half of a sphere of 2562 cells, within half a percent."""
    mesh = basin_of(tilted(larger_mesh, 0.7), Seiche())
    assert abs(seiche_error(mesh, Seiche())) < 0.005


@pytest.mark.parametrize("angle", LATTICES)
def test_the_speed_of_the_kelvin_wave_along_staircases(angle: int) -> None:
    """Staircases slow it down, by 6 to 10 percent with two cells across the radius of deformation."""
    mesh = channel(angle, 0.5)
    assert (mesh.n_edges_on_cell == 6).all()
    error, left = kelvin_error(mesh, KelvinWave())
    assert -0.12 < error < -0.04
    assert 0.98 < left < 1.01


@pytest.mark.parametrize("angle", LATTICES)
def test_cells_that_the_coast_clips_hardly_slow_the_kelvin_wave(angle: int) -> None:
    """By 1 percent where staircases slow it by 6 to 10."""
    mesh = filled_channel(angle, 0.5)
    assert mesh.n_cells == channel(angle, 0.5).n_cells
    error, left = kelvin_error(mesh, KelvinWave())
    assert -0.013 < error < -0.008
    assert 0.998 < left < 1.003


@pytest.mark.slow
@pytest.mark.parametrize("angle", LATTICES)
def test_the_speed_of_the_kelvin_wave_converges_with_order_two(angle: int) -> None:
    """Nearly: 1.75 at least from two to four cells across the radius of deformation."""
    coarse, fine = (kelvin_error(filled_channel(angle, refinement), KelvinWave())[0] for refinement in (0.5, 1.0))
    assert 3.3 < coarse / fine < 4.5


@pytest.mark.slow
def test_the_frequency_of_any_seiche_on_cells_that_the_coast_clips() -> None:
    """Within half a percent, also where the flow along the coast is strongest: 2562 cells are in the sea."""
    mesh = filled(Seiche(), 2562)
    for degree, order in ((2, 0), (1, 1)):
        assert abs(seiche_error(mesh, Seiche(degree=degree, order=order))) < 0.001


def test_waves_want_half_a_sphere(larger_mesh: VoronoiMesh) -> None:
    with pytest.raises(InputError, match=r"^seiche needs a mesh of the northern half of the sphere \(the box -180,180"):
        Simulation(larger_mesh, Seiche())


@pytest.mark.parametrize(("degree", "order"), [(0, 0), (2, 1), (2, 4), (31, 1), (2, -2)])
def test_harmonics_that_do_not_fit_are_refused(degree: int, order: int) -> None:
    with pytest.raises(InputError, match=f"^degree and order are {degree} and {order}; give a degree from 1 to 30"):
        Seiche(degree=degree, order=order)


def test_a_rotating_seiche_is_not_known() -> None:
    assert not Seiche(rotation_rate=1e-5).has_exact_solution

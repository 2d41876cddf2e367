"""Geostrophic adjustment: Gill's final state and energies, the linear equations, and how the model follows them."""

import numpy as np
import pytest

from cases import GeostrophicAdjustment
from mesh import VoronoiMesh, hexagon_mesh
from mesh.arrays import Array
from swe import InputError, Simulation
from tests.cases.plane.slopes import Slopes, component, relative_error

ROW = 0.5 * np.sqrt(3.0)


def strip(case: GeostrophicAdjustment, columns: int) -> VoronoiMesh:
    """Four rows of hexagons, as nothing depends on y."""
    return hexagon_mesh((case.x_length, 4.0 * ROW * case.x_length / columns), (columns, 4))


@pytest.mark.parametrize(
    "case", [GeostrophicAdjustment(), GeostrophicAdjustment(coriolis_parameter=-2e-4, depth=50.0, step_width=3e5)]
)
def test_the_waves_obey_the_linear_equations_from_rest(case: GeostrophicAdjustment) -> None:
    x = np.random.default_rng(5).uniform(0.0, case.x_length, 200)
    y, time = np.zeros(200), 2e4
    slopes = Slopes(x, y, time, metres=1e3, seconds=10.0)
    along, across = component(case.velocity, 0), component(case.velocity, 1)
    (u, v), f = case.velocity(x, y, time), case.coriolis_parameter
    pressure = -case.gravity * slopes.in_x(case.thickness)
    size, rate = np.abs(pressure).max(), slopes.in_time(case.thickness)
    np.testing.assert_allclose(slopes.in_time(along) - f * v, pressure, atol=1e-5 * size)
    np.testing.assert_allclose(slopes.in_time(across), -f * u, atol=1e-5 * size)
    np.testing.assert_allclose(rate, -case.depth * slopes.in_x(along), atol=1e-5 * np.abs(rate).max())
    vorticity = slopes.in_x(across)
    np.testing.assert_allclose(case.vorticity(x, y, time), vorticity, atol=1e-5 * np.abs(vorticity).max())
    speed = np.abs(np.concatenate([u, v])).max()
    np.testing.assert_allclose(case.velocity(x, y), 0.0, atol=1e-12 * speed)
    assert np.abs(u).max() > 0.1 * speed


def test_steps_are_where_they_are_said_to_be() -> None:
    case = GeostrophicAdjustment(step_width=2e4)
    x = np.array([0.0, 0.2, 0.25, 0.3, 0.5, 0.7, 0.75, 0.8]) * case.x_length
    height = (case.thickness(x, np.zeros(8)) - case.depth) / case.amplitude
    np.testing.assert_allclose(height, [-1, -1, 0, 1, 1, 1, 0, -1], atol=1e-9)


def test_sharp_steps_far_apart_adjust_as_gill_has_it() -> None:
    """Exponential profiles, and a third of the potential energy released stays in the currents."""
    case = GeostrophicAdjustment(x_length=2e7, step_width=1e4)
    distance = np.linspace(-4.0, 4.0, 81) * case.deformation_radius
    x, y = 0.25 * case.x_length + distance, np.zeros(81)
    surface = (case.adjusted_thickness(x, y) - case.depth) / case.amplitude
    expected = np.sign(distance) * (1.0 - np.exp(-np.abs(distance) / case.deformation_radius))
    np.testing.assert_allclose(surface, expected, atol=1e-3)
    speed = case.gravity * case.amplitude / (case.coriolis_parameter * case.deformation_radius)
    away = np.abs(distance) > 0.5 * case.deformation_radius
    current = case.adjusted_velocity(x, y)[1] / speed
    np.testing.assert_allclose(current[away], np.exp(-np.abs(distance[away]) / case.deformation_radius), atol=1e-3)
    energies = [GeostrophicAdjustment(x_length=2e7, step_width=width).kept_energy for width in (4e4, 2e4, 1e4)]
    # The width of the step adds to a third in proportion.
    assert 2.0 * energies[2] - energies[1] == pytest.approx(1.0 / 3.0, rel=2e-3)
    assert energies[0] > energies[1] > energies[2] > 1.0 / 3.0


def test_the_adjusted_state_is_balanced_and_keeps_potential_vorticity() -> None:
    case = GeostrophicAdjustment()
    x = np.random.default_rng(1).uniform(0.0, case.x_length, 100)
    slopes = Slopes(x, np.zeros(100), 0.0, metres=1e3)
    slope = slopes.in_x(lambda x, y, _: case.adjusted_thickness(x, y))
    current = case.adjusted_velocity(x, slopes.y)[1]
    np.testing.assert_allclose(case.coriolis_parameter * current, case.gravity * slope, atol=1e-12)
    vorticity = slopes.in_x(lambda x, y, _: case.adjusted_velocity(x, y)[1])
    fallen = case.adjusted_thickness(x, slopes.y) - case.thickness(x, slopes.y)
    expected = case.coriolis_parameter * fallen / case.depth
    np.testing.assert_allclose(vorticity, expected, atol=1e-5 * np.abs(expected).max())


def test_the_model_follows_the_waves_with_second_order() -> None:
    case, errors = GeostrophicAdjustment(), []
    for columns in (256, 512):
        simulation = Simulation(strip(case, columns), case)
        simulation.run(days=1.0, progress=False)
        mesh, exact = simulation.mesh, case.state_on(simulation.mesh, simulation.time)
        found = simulation.state
        height = relative_error(found.thickness - case.depth, exact.thickness - case.depth, mesh.area_cell)
        weights = mesh.dc_edge * mesh.dv_edge
        errors.append([height, relative_error(found.normal_velocity, exact.normal_velocity, weights)])
    assert (np.log2(np.array(errors[0]) / errors[1]) > 1.95).all()
    assert max(errors[1]) < 0.006


def mean_over(case: GeostrophicAdjustment, simulation: Simulation, days: float, samples: int) -> tuple[Array, Array]:
    """Mean height of the surface and normal velocity, under a window that leaves next to nothing of the waves."""
    window = np.sin(np.pi * (np.arange(samples) + 0.5) / samples) ** 2
    height, velocity = np.zeros(simulation.mesh.n_cells), np.zeros(simulation.mesh.n_edges)
    for sample, weight in enumerate(window / window.sum()):
        simulation.run(until=(sample + 0.5) * days / samples, progress=False)
        height += weight * (simulation.state.thickness - case.depth)
        velocity += weight * simulation.state.normal_velocity
    return height, velocity


def test_the_model_adjusts_to_the_balanced_state_and_keeps_the_energy_of_its_currents() -> None:
    """The mean over ten days, about fourteen inertial periods."""
    case = GeostrophicAdjustment(step_width=2e4)
    simulation = Simulation(strip(case, 256), case)
    mesh, start = simulation.mesh, simulation.state.thickness - case.depth
    height, velocity = mean_over(case, simulation, 10.0, 200)
    expected = case.adjusted_thickness(mesh.x_cell, mesh.y_cell) - case.depth
    np.testing.assert_allclose(height, expected, atol=2e-3 * case.amplitude)
    released = 0.5 * case.gravity * (mesh.area_cell @ (start**2 - height**2))
    kinetic = 0.5 * case.depth * ((mesh.dc_edge * mesh.dv_edge) @ velocity**2)
    assert kinetic / released == pytest.approx(case.kept_energy, rel=3e-3)
    assert kinetic / released == pytest.approx(1.0 / 3.0, abs=0.017)


def test_what_does_not_fit_is_refused() -> None:
    case = GeostrophicAdjustment()
    with pytest.raises(InputError, match="needs a mesh on a plane with --periodic xy, and this one has --periodic x;"):
        case.state_on(hexagon_mesh((8e6, 8e6 * ROW), (8, 8), "x"))
    with pytest.raises(InputError, match="x_length = 8000000 m, but the mesh after 9000000 m"):
        case.state_on(hexagon_mesh((9e6, 9e6 * ROW), (8, 8)))
    with pytest.raises(InputError, match="step_width is 1000; it must be at least 4000, x_length / 2000"):
        GeostrophicAdjustment(step_width=1e3)
    with pytest.raises(InputError, match="coriolis_parameter is 0; nothing adjusts without rotation"):
        GeostrophicAdjustment(coriolis_parameter=0.0)

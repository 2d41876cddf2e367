"""The Kelvin wave of a channel: the linear equations, and its speed and height in the model."""

import numpy as np
import pytest

from cases import KelvinChannel
from mesh import VoronoiMesh, hexagon_mesh
from mesh.discrete.walls import wall_edges
from swe import InputError, Simulation
from tests.cases.plane.slopes import Slopes, component

ROW = 0.5 * np.sqrt(3.0)


def channel(columns: int) -> VoronoiMesh:
    return hexagon_mesh((1e6, 1e6 * ROW), (columns, columns), "x")


@pytest.mark.parametrize("case", [KelvinChannel(), KelvinChannel(wave_number=3, depth=90.0, coriolis_parameter=2e-4)])
def test_the_wave_obeys_the_linear_equations(case: KelvinChannel) -> None:
    x, y = np.random.default_rng(5).uniform(0.0, 6e5, (2, 200))
    slopes, time = Slopes(x, y, 3e4), 3e4
    along = component(case.velocity, 0)
    pressures = [-case.gravity * slope for slope in (slopes.in_x(case.thickness), slopes.in_y(case.thickness))]
    size, rate = np.abs(pressures).max(), slopes.in_time(case.thickness)
    u, v = case.velocity(x, y, time)
    np.testing.assert_array_equal(v, 0.0)
    np.testing.assert_allclose(slopes.in_time(along), pressures[0], atol=1e-5 * size)
    np.testing.assert_allclose(case.coriolis_parameter * u, pressures[1], atol=1e-5 * size)
    np.testing.assert_allclose(rate, -case.depth * slopes.in_x(along), atol=1e-5 * np.abs(rate).max())
    vorticity = -slopes.in_y(along)
    np.testing.assert_allclose(case.vorticity(x, y, time), vorticity, atol=1e-5 * np.abs(vorticity).max())
    assert np.abs(rate).max() > 1e-9


def speed_error_and_height(columns: int, days: float = 2.0) -> tuple[float, float]:
    """Relative error of the speed, and the part of the height that is left, seen through the shape of the wave."""
    case = KelvinChannel()
    simulation = Simulation(channel(columns), case)
    mesh, k = simulation.mesh, 2.0 * np.pi / case.x_length
    shape = mesh.area_cell * np.exp(-mesh.y_cell / case.decay_length - 1j * k * mesh.x_cell)
    values, times = [], []
    for until in np.linspace(0.0, days, 17):
        if until > 0.0:
            simulation.run(until=until, progress=False)
        values.append(shape @ (simulation.state.thickness - case.depth))
        times.append(simulation.time)
    phases = -np.unwrap(np.angle(values))
    return float(phases[-1] / (k * case.phase_speed * times[-1]) - 1.0), float(abs(values[-1] / values[0]))


def test_zigzag_walls_slow_the_wave_by_what_they_leave_out() -> None:
    """No fluid flows through the slanted edges at the wall, and so through a width of d / (4 sqrt(3)) of each cell."""
    for columns in (16, 32):
        error, height = speed_error_and_height(columns)
        left_out = 1e6 / columns / (4.0 * np.sqrt(3.0))
        assert error == pytest.approx(-left_out / KelvinChannel().decay_length, rel=0.06)
        assert height == pytest.approx(1.0, abs=0.01)


def test_the_start_is_at_rest_at_walls() -> None:
    mesh = channel(8)
    velocity = KelvinChannel().state_on(mesh).normal_velocity
    assert not velocity[wall_edges(mesh)].any()
    assert np.abs(velocity).max() > 1e-4


def test_what_does_not_fit_is_refused() -> None:
    case = KelvinChannel()
    with pytest.raises(InputError, match="kelvin-channel needs a mesh on a plane with --periodic x, and this one has"):
        case.state_on(hexagon_mesh((1e6, 1e6 * ROW), (8, 8)))
    with pytest.raises(InputError, match="x_length = 1000000 m, but the mesh after 1500000 m in x"):
        case.state_on(hexagon_mesh((1.5e6, 1.5e6 * ROW), (8, 8), "x"))
    mesh = channel(8)
    object.__setattr__(mesh, "y_cell", mesh.y_cell - 1e5)
    with pytest.raises(InputError, match=r"a wall at y = 0, but the mesh has cells at y = -45873\.4 m; move it"):
        case.state_on(mesh)
    with pytest.raises(InputError, match=r"coriolis_parameter is -0\.0001; it must be positive"):
        KelvinChannel(coriolis_parameter=-1e-4)

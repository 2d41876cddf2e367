"""The inertia-gravity wave: it obeys the equations, and the model carries it with an error of second order."""

import dataclasses

import numpy as np
import pytest

from cases import InertiaGravityWave, Williamson2, find_case
from cases.parameters import units_and_meanings
from mesh import MeshError, VoronoiMesh, hexagon_mesh
from mesh.arrays import Array
from swe import InputError, Simulation
from swe.configuration import SchemeName
from swe.constants import SECONDS_PER_DAY
from swe.integrators import Integrator

WAVES = [InertiaGravityWave(), InertiaGravityWave(waves_x=2, waves_y=-1, coriolis_parameter=-3e-4, depth=50.0)]
ROW = 0.5 * np.sqrt(3.0)


def plane(columns: int) -> VoronoiMesh:
    return hexagon_mesh((1e6, 1e6 * ROW), (columns, columns))


@pytest.mark.parametrize("case", WAVES, ids=["one", "oblique"])
def test_waves_obey_the_linear_equations(case: InertiaGravityWave) -> None:
    x, y = np.random.default_rng(5).uniform(0.0, 1e6, (2, 100))
    time, seconds, metres = 5e3, 1.0, 100.0

    def slope(values: list[Array], step: float) -> Array:
        return (values[0] - values[1]) / (2.0 * step)

    u, v = case.velocity(x, y, time)
    u_t, v_t = (slope([case.velocity(x, y, time + s)[i] for s in (seconds, -seconds)], seconds) for i in range(2))
    h_t = slope([case.thickness(x, y, time + s) for s in (seconds, -seconds)], seconds)
    h_x = slope([case.thickness(x + s, y, time) for s in (metres, -metres)], metres)
    h_y = slope([case.thickness(x, y + s, time) for s in (metres, -metres)], metres)
    u_x, v_x = (slope([case.velocity(x + s, y, time)[i] for s in (metres, -metres)], metres) for i in range(2))
    u_y, v_y = (slope([case.velocity(x, y + s, time)[i] for s in (metres, -metres)], metres) for i in range(2))
    f, size = case.coriolis(x, y), case.gravity * np.abs(h_x).max()
    np.testing.assert_allclose(u_t - f * v, -case.gravity * h_x, atol=1e-5 * size)
    np.testing.assert_allclose(v_t + f * u, -case.gravity * h_y, atol=1e-5 * size)
    np.testing.assert_allclose(h_t, -case.depth * (u_x + v_y), atol=1e-5 * np.abs(h_t).max())
    np.testing.assert_allclose(case.vorticity(x, y, time), v_x - u_y, atol=1e-5 * np.abs(v_x).max())
    assert np.abs(v_x - u_y).max() > 0.1 * np.abs(v_x).max()


def relative_error(found: Array, expected: Array) -> float:
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def errors_after_a_period(columns: int, scheme: SchemeName, integrator: Integrator) -> Array:
    """Relative l2 errors of the height of the surface and of the velocity."""
    case = InertiaGravityWave()
    seconds = case.period_days * SECONDS_PER_DAY
    simulation = Simulation(
        plane(columns), case, scheme=scheme, integrator=integrator, time_step=seconds / (2 * columns)
    )
    simulation.run(days=case.period_days, progress=False)
    found, exact = simulation.state, case.state_on(simulation.mesh, simulation.time)
    height = relative_error(found.thickness - case.depth, exact.thickness - case.depth)
    return np.array([height, relative_error(found.normal_velocity, exact.normal_velocity)])


@pytest.mark.parametrize(
    ("scheme", "integrator"), [("ringler2010", "rk4"), ("consistent", "rk4"), ("ringler2010", "fbrk3")]
)
def test_errors_over_a_period_are_of_second_order(scheme: SchemeName, integrator: Integrator) -> None:
    coarse, fine = (errors_after_a_period(columns, scheme, integrator) for columns in (16, 32))
    assert (np.log2(coarse / fine) > 1.95).all()
    assert (fine < 0.025).all()


def test_meshes_must_hold_whole_waves() -> None:
    case = InertiaGravityWave()
    assert case.state_on(hexagon_mesh((2e6, 1e6 * ROW), (16, 8))).thickness.shape == (128,)
    words = "after x_length = 1000000 m, but the mesh after 1500000 m in x; set x_length"
    with pytest.raises(InputError, match=words):
        Simulation(hexagon_mesh((1.5e6, 1.5e6 * ROW), (8, 8)), case)
    with pytest.raises(InputError, match="needs a mesh on a plane with --periodic xy, and this one has --periodic x;"):
        Simulation(hexagon_mesh((1e6, 1e6 * ROW), (8, 8), "x"), case)


def test_planes_and_spheres_are_not_mixed(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match="the mesh is on a sphere, but one on a plane is asked for"):
        Simulation(small_mesh, InertiaGravityWave())
    with pytest.raises(MeshError, match="the mesh is on a plane, but one on a sphere is asked for"):
        Simulation(plane(4), Williamson2())
    with pytest.raises(InputError, match=r"needs a mesh on a plane \(trisk mesh --plane\), and this one"):
        InertiaGravityWave().state_on(small_mesh)


def test_it_is_found_by_its_name_and_documented() -> None:
    case = find_case("inertia-gravity-wave", {"beta": "1e-11", "waves_x": "2"})
    assert (case.parameters()["beta"], case.parameters()["waves_x"]) == (1e-11, 2)
    assert not case.has_exact_solution
    np.testing.assert_allclose(case.coriolis(np.zeros(2), np.array([0.0, 1e6])), [1e-4, 1.1e-4])
    assert not {"radius", "rotation_rate"} & set(case.parameters())
    assert all(meaning for _, meaning in units_and_meanings(case).values())
    assert "doi.org" in case.reference
    assert "waves x: 2 (default 1)" in repr(case)
    with pytest.raises(InputError, match="no parameter 'radius'"):
        find_case("inertia-gravity-wave", {"radius": "1"})
    with pytest.raises(InputError, match="waves_x and waves_y are 0"):
        InertiaGravityWave(waves_x=0, waves_y=0)
    with pytest.raises(InputError, match="depth is -1; it must be positive"):
        dataclasses.replace(InertiaGravityWave(), depth=-1.0)


def test_the_period_is_in_days() -> None:
    case, place = InertiaGravityWave(), np.array([2e5])
    later = case.thickness(place, place, case.period_days * 86400.0)
    np.testing.assert_allclose(later, case.thickness(place, place), rtol=0.0, atol=1e-9 * case.amplitude)
    assert 0.01 < case.period_days < 1.0

"""Advection by a wind that stays as it is: test case 1."""

from pathlib import Path

import numpy as np
import pytest

from cases import Williamson1, Williamson5
from mesh import VoronoiMesh, build_operators
from swe import Simulation
from swe.equations.tendency import tendency
from swe.output.files import read_series


def test_thickness_is_advected_and_the_wind_stays(any_mesh: VoronoiMesh) -> None:
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("a streamfunction gives no velocity on edges of no length")
    simulation = Simulation(any_mesh, Williamson1(angle=0.7), time_step=600.0)
    model, state = simulation.model, simulation.state
    rate = state.empty_like()
    rate.normal_velocity.fill(np.nan)
    model.tendency(state, rate)
    full = tendency(state, build_operators(simulation.mesh), model.topography, model.coriolis, model.gravity)
    np.testing.assert_allclose(rate.thickness, full.thickness, atol=1e-13 * np.abs(full.thickness).max())
    assert not rate.normal_velocity.any()
    before = state.copy()
    simulation.run(days=0.25, progress=False)
    np.testing.assert_array_equal(state.normal_velocity, before.normal_velocity)
    assert np.abs(state.thickness - before.thickness).max() > 10.0


def test_constant_thickness_stays_so_to_round_off(any_mesh: VoronoiMesh) -> None:
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("a streamfunction gives no velocity on edges of no length")
    simulation = Simulation(any_mesh, Williamson1(angle=0.7, bell_height=0.0), time_step=600.0)
    rate = simulation.state.empty_like()
    simulation.model.tendency(simulation.state, rate)
    mesh = simulation.mesh
    throughput = np.abs(1000.0 * simulation.state.normal_velocity * mesh.dv_edge)[mesh.edges_on_cell].sum(axis=1)
    assert (np.abs(rate.thickness) * mesh.area_cell / throughput).max() < 1e-13
    simulation.run(days=1, progress=False)
    np.testing.assert_allclose(simulation.state.thickness, 1000.0, rtol=1e-13)


def test_bell_does_not_depend_on_the_background(icosahedral_mesh: VoronoiMesh) -> None:
    bells = []
    for depth in (1000.0, 5000.0):
        simulation = Simulation(icosahedral_mesh, Williamson1(background_depth=depth))
        simulation.run(days=3, progress=False)
        bells.append(simulation.state.thickness - depth)
    np.testing.assert_allclose(bells[0], bells[1], atol=1e-9)
    assert bells[0].min() < -10.0


def test_bell_converges_and_keeps_its_mass(
    icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh, tmp_path: Path
) -> None:
    errors = []
    for mesh in (icosahedral_mesh, larger_mesh):
        simulation = Simulation(mesh, Williamson1(angle=0.05), tmp_path / str(mesh.n_cells))
        simulation.run(days=1, progress=False)
        exact = simulation.case.state_on(simulation.mesh, simulation.time).thickness
        area = simulation.mesh.area_cell
        errors.append(np.sqrt(area @ (simulation.state.thickness - exact) ** 2 / (area @ (exact - 1000.0) ** 2)))
        series = read_series(tmp_path / str(mesh.n_cells) / "diagnostics.nc")
        assert all(np.all(np.isfinite(values)) for values in series.values())
        assert np.abs(series["mass_change"]).max() < 1e-14
    assert errors[0] < 0.7
    assert errors[1] < 0.45 * errors[0]


def test_step_is_limited_by_the_wind_alone(icosahedral_mesh: VoronoiMesh) -> None:
    prescribed = Simulation(icosahedral_mesh, Williamson1())
    assert 0.4 < prescribed.initial_courant_number <= 0.8
    wave_speed = np.sqrt(9.8 * 5960.0)
    assert prescribed.configuration.time_step > Simulation(icosahedral_mesh, Williamson5()).configuration.time_step * (
        0.5 * wave_speed / 38.6
    )
    still = Simulation(icosahedral_mesh, Williamson1(wind_speed=0.0))
    still.run(days=1, progress=False)
    assert still.configuration.time_step == 21600.0

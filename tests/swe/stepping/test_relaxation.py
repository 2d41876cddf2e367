"""Relaxed steps keep total energy, the order of the method, and the times of output."""

from pathlib import Path

import numba
import numpy as np
import pytest

from cases import Galewsky, LakeAtRest, Williamson1, Williamson2, Williamson5
from mesh import VoronoiMesh
from swe import ShallowWaterModel, Simulation, State
from swe.diagnostics.invariants import measure_invariants
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.errors import InputError
from swe.output.files import read_series
from swe.stepping.relaxation import Relaxation
from swe.stepping.steppers import RelaxedSteps
from swe.tiles.fused import FusedRungeKutta
from tests.swe.stepping.test_forward_backward import assert_order

SCHEMES = pytest.mark.parametrize("scheme", [Ringler2010, Consistent])


def random_model(mesh: VoronoiMesh, scheme: type[Scheme] = Ringler2010) -> tuple[ShallowWaterModel, State, State]:
    """A model, a state and an increment, all of random numbers."""
    random = np.random.default_rng(7)
    scaled = mesh.scaled(6.4e6)
    topography = random.uniform(0.0, 500.0, mesh.n_cells)
    model = ShallowWaterModel(scaled, topography, random.uniform(-1e-4, 1e-4, mesh.n_vertices), 9.8, scheme=scheme)
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    change = random.uniform(-50.0, 50.0, mesh.n_cells)
    change -= (scaled.area_cell @ change) / scaled.area_cell.sum()  # mass stays
    return model, state, State(change, random.uniform(-30.0, 30.0, mesh.n_edges))


def energy(model: ShallowWaterModel, state: State) -> float:
    return measure_invariants(model, state, model.diagnose(state)).total_energy


def moved(state: State, increment: State, factor: float) -> State:
    return State(
        state.thickness + factor * increment.thickness, state.normal_velocity + factor * increment.normal_velocity
    )


@SCHEMES
def test_energy_along_an_increment_is_the_cubic(any_mesh: VoronoiMesh, scheme: type[Scheme]) -> None:
    model, state, increment = random_model(any_mesh, scheme)
    first, second, third = Relaxation(model, state).coefficients(state, moved(state, increment, 1.0))
    start = energy(model, state)
    for factor in (-1.0, 0.3, 1.0, 2.0):
        change = energy(model, moved(state, increment, factor)) - start
        assert factor * (first + factor * (second + factor * third)) == pytest.approx(change, abs=1e-14 * abs(start))
        assert abs(change) > 1e-6 * abs(start)


@SCHEMES
def test_a_relaxed_step_keeps_energy_and_mass(any_mesh: VoronoiMesh, scheme: type[Scheme]) -> None:
    model, start, _ = random_model(any_mesh, scheme)
    method = FusedRungeKutta(model)
    plain, relaxed = start.copy(), start.copy()
    step = 0.3 / model.courant_number(start, 1.0)
    method.advance(plain, step)
    stepper = RelaxedSteps(method, Relaxation(model, start), start)
    time, taken = stepper.advance(relaxed, 0.0, 1000.0 * step, step, 1)
    assert taken == 1
    assert time != step
    assert abs(time - step) < 0.05 * step
    before = energy(model, start)
    assert abs(energy(model, plain) - before) > 1e-11 * abs(before)
    assert abs(energy(model, relaxed) - before) < 3e-15 * abs(before)
    area = model.mesh.area_cell
    assert abs(area @ (relaxed.thickness - start.thickness)) < 1e-14 * (area @ start.thickness)


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
def test_energy_over_five_days(larger_mesh: VoronoiMesh, integrator: str) -> None:
    plain, relaxed = (
        Simulation(larger_mesh, Williamson5(), integrator=name) for name in (integrator, f"r{integrator}")
    )
    for simulation in (plain, relaxed):
        simulation.run(days=5, progress=False)
    start = plain.initial_invariants
    assert abs(plain.invariants.total_energy - start.total_energy) > 1e-9 * start.total_energy
    assert abs(relaxed.invariants.total_energy - start.total_energy) < 1e-15 * start.total_energy
    assert abs(relaxed.invariants.mass - start.mass) < 1e-15 * start.mass
    scale = start.planetary_vorticity_magnitude
    assert abs(relaxed.invariants.absolute_vorticity - start.absolute_vorticity) < 1e-16 * scale
    np.testing.assert_allclose(
        relaxed.state.thickness, plain.state.thickness, rtol=1e-4 if integrator == "rk4" else 3e-4
    )


def test_output_times_are_met(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(
        icosahedral_mesh, Williamson5(), tmp_path, time_step=1700.0, diagnostics_interval=7200.0, integrator="rrk4"
    )
    simulation.run(days=0.75, progress=False)
    assert read_series(tmp_path / "diagnostics.nc")["time"].tolist() == [7200.0 * k for k in range(10)]
    assert simulation.time == 64800.0
    assert simulation.steps == 45


@pytest.mark.parametrize("integrator", ["rrk4", "rfbrk3"])
def test_the_last_step_ends_at_the_output_time(icosahedral_mesh: VoronoiMesh, integrator: str) -> None:
    """Not the clock alone, which is set to it, but the scaled length of the step."""
    for case, courant in ((Williamson5(), 0.8), (Galewsky(), 0.8)):
        simulation = Simulation(icosahedral_mesh, case, integrator=integrator)
        state, step = simulation.state, courant / simulation.model.courant_number(simulation.state, 1.0)
        simulation.method.advance(state, step, 5)
        stepper = simulation.stepper
        assert isinstance(stepper, RelaxedSteps)
        factor = stepper._try(state, step, 0.0)
        assert abs(factor - 1.0) > 1e-4
        factor, length = stepper._land(state, factor, step, 0.0)
        assert abs(factor * length - step) <= 1e-10 * step
        assert abs(length - step) > 1e-5 * step


def test_order_stays_four(icosahedral_mesh: VoronoiMesh) -> None:
    """Against many small steps of the plain method; the clock that is not scaled would give order three."""

    def thickness(integrator: str, time_step: float) -> np.ndarray:
        simulation = Simulation(icosahedral_mesh, Williamson5(), time_step=time_step, integrator=integrator)
        simulation.run(days=0.5, progress=False)
        return simulation.state.thickness

    exact = thickness("rk4", 75.0)
    errors = [np.abs(thickness("rrk4", step) - exact).max() for step in (2400.0, 1200.0, 600.0)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.7)


def test_order_stays_two(icosahedral_mesh: VoronoiMesh) -> None:
    """The relaxed forward-backward method has the order of the plain one."""
    assert_order("rfbrk3", icosahedral_mesh)


def test_flows_that_do_not_change_are_left_alone(icosahedral_mesh: VoronoiMesh) -> None:
    for case in (LakeAtRest(), Williamson2()):
        plain, *both = (Simulation(icosahedral_mesh, case, integrator=name) for name in ("rk4", "rrk4", "rfbrk3"))
        for simulation in (plain, *both):
            simulation.run(days=1, progress=False)
        tolerance = 1e-12 if isinstance(case, LakeAtRest) else 3e-4
        for relaxed in both:
            np.testing.assert_allclose(relaxed.state.thickness, plain.state.thickness, rtol=tolerance)
            speed = np.abs(relaxed.state.normal_velocity - plain.state.normal_velocity).max()
            assert speed < 1e3 * tolerance


def test_results_do_not_depend_on_threads(larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("swe.run.threads.CELLS_PER_THREAD", 1000)
    states = []
    available = numba.get_num_threads()
    for threads in (1, 2):
        simulation = Simulation(larger_mesh, Williamson5(), integrator="rrk4", anticipation=0.5, dissipation=1e15)
        numba.set_num_threads(threads)
        try:
            simulation.run(days=0.25, progress=False)
        finally:
            numba.set_num_threads(available)
        states.append(simulation.state)
    np.testing.assert_array_equal(states[0].thickness, states[1].thickness)
    np.testing.assert_array_equal(states[0].normal_velocity, states[1].normal_velocity)


def test_schemes_that_make_no_sense_are_refused(icosahedral_mesh: VoronoiMesh) -> None:
    for integrator in ("rrk4", "rfbrk3"):
        with pytest.raises(InputError, match=f"the wind of williamson1 is prescribed; {integrator}, anticipation"):
            Simulation(icosahedral_mesh, Williamson1(), integrator=integrator)
    with pytest.raises(InputError, match="the wind of williamson1 is prescribed; rrk4, anticipation"):
        Simulation(icosahedral_mesh, Williamson1(), anticipation=0.5)
    with pytest.raises(InputError, match="the integrator is 'euler'; it must be 'rk4', 'rrk4', 'fbrk3' or 'rfbrk3'"):
        Simulation(icosahedral_mesh, Williamson5(), integrator="euler")
    with pytest.raises(InputError, match="the anticipation is -1; it must be a finite number"):
        Simulation(icosahedral_mesh, Williamson5(), anticipation=-1.0)
    with pytest.raises(InputError, match="the dissipation is nan; it must be a finite number"):
        Simulation(icosahedral_mesh, Williamson5(), dissipation=float("nan"))

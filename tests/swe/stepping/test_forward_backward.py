"""The forward-backward method: its order, its limit, what it conserves, and terms at their times in its stages."""

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from cases import LakeAtRest, Williamson1, Williamson2, Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe import Forcing, Simulation, State
from swe.equations.terms import Term
from swe.errors import RunError, SetupWarning
from swe.integrators import STEPPINGS, Integrator
from swe.stepping.forward_backward import ForwardBackward
from swe.stepping.time_stepping import RungeKutta
from tests.swe.random_model import random_model


class TwoNumbers:
    """Equations of a thickness and a velocity, one number each, whose slopes are two functions of both and time."""

    def __init__(
        self, of_thickness: Callable[[Array, Array, float], Array], of_velocity: Callable[[Array, Array, float], Array]
    ) -> None:
        self._slopes = of_thickness, of_velocity

    def tendency(self, state: State, result: State, time: float) -> None:
        self.thickness_tendency(state, result.thickness, time)
        self.velocity_tendency(state, result.normal_velocity, time)

    def thickness_tendency(self, state: State, result: Array, time: float) -> None:
        result[:] = self._slopes[0](state.thickness, state.normal_velocity, time)

    def velocity_tendency(self, state: State, result: Array, time: float) -> None:
        result[:] = self._slopes[1](state.thickness, state.normal_velocity, time)


def amplification(phase: float) -> Array:
    """The matrix by which a step multiplies (h, u) of a wave with slopes -u and h, which has the same eigenvalues."""
    matrix = np.empty((2, 2))
    wave = TwoNumbers(lambda h, u, time: -u, lambda h, u, time: h)
    for column, start in enumerate(((1.0, 0.0), (0.0, 1.0))):
        state = State(np.array([start[0]]), np.array([start[1]]))
        ForwardBackward(wave, state).step(state, phase)
        matrix[:, column] = state.thickness[0], state.normal_velocity[0]
    return matrix


def test_limit_is_where_a_wave_begins_to_grow() -> None:
    limit = STEPPINGS["fbrk3"].stable_courant_number * np.sqrt(6.0)

    def growth(phase: float) -> float:
        return float(np.abs(np.linalg.eigvals(amplification(phase))).max()) - 1.0

    assert all(growth(phase) < 0.0 for phase in np.linspace(0.1, 0.9999 * limit, 500))
    assert growth(limit) == pytest.approx(0.0, abs=1e-12)
    assert growth(1.0001 * limit) > 0.0
    assert limit / np.sqrt(8.0) == pytest.approx(1.3655, abs=1e-4)
    assert STEPPINGS["rfbrk3"].stable_courant_number == STEPPINGS["fbrk3"].stable_courant_number


def test_a_step_is_the_published_one() -> None:
    """Lilly et al. (2023), written out for a pair of slopes that depend on both."""

    def of_thickness(u: float, h: float) -> float:
        return -h * u + 0.1 * h

    def of_velocity(u: float, h: float) -> float:
        return u * h - h**2

    equations = TwoNumbers(lambda h, u, time: of_thickness(u, h), lambda h, u, time: of_velocity(u, h))
    state, dt, (b1, b2, b3) = State(np.array([1.3]), np.array([0.7])), 0.2, (0.531, 0.531, 0.313)
    h, u = 1.3, 0.7
    h1 = h + dt / 3 * of_thickness(u, h)
    u1 = u + dt / 3 * of_velocity(u, b1 * h1 + (1 - b1) * h)
    h2 = h + dt / 2 * of_thickness(u1, h1)
    u2 = u + dt / 2 * of_velocity(u1, b2 * h2 + (1 - b2) * h)
    after = h + dt * of_thickness(u2, h2)
    velocity = u + dt * of_velocity(u2, b3 * after + (1 - 2 * b3) * h2 + b3 * h)
    ForwardBackward(equations, state).step(state, dt)
    assert state.thickness[0] == pytest.approx(after, rel=1e-14)
    assert state.normal_velocity[0] == pytest.approx(velocity, rel=1e-14)


def orders(equations: TwoNumbers, exact: tuple[float, float], end: float) -> Array:
    """Orders of convergence of the error from (1, 0.5) at time `end`, from 80, 160 and 320 steps."""
    errors = []
    for steps in (80, 160, 320):
        state = State(np.array([1.0]), np.array([0.5]))
        method = ForwardBackward(equations, state)
        for step in range(steps):
            method.step(state, end / steps, step * end / steps)
        errors.append(np.hypot(state.thickness[0] - exact[0], state.normal_velocity[0] - exact[1]))
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_order_is_two() -> None:
    """Predator and prey, whose exact state comes from many steps of RK4."""
    equations = TwoNumbers(lambda h, u, time: h * (1.0 - u), lambda h, u, time: u * (h - 1.0))
    state = State(np.array([1.0]), np.array([0.5]))
    RungeKutta(equations.tendency, state).advance(state, 4.0 / 4000, 4000)
    np.testing.assert_allclose(
        orders(equations, (float(state.thickness[0]), float(state.normal_velocity[0])), 4.0), 2.0, atol=0.1
    )


def test_order_of_the_model_is_two(icosahedral_mesh: VoronoiMesh) -> None:
    assert_order("fbrk3", icosahedral_mesh)


def assert_order(integrator: Integrator, mesh: VoronoiMesh) -> None:
    """Against many small steps of RK4, both thickness and velocity of test case 5 converge with order two."""

    def state(integrator: Integrator, time_step: float) -> State:
        simulation = Simulation(mesh, Williamson5(), time_step=time_step, integrator=integrator)
        simulation.run(days=0.5, progress=False)
        return simulation.state

    exact, found = state("rk4", 75.0), [state(integrator, step) for step in (1200.0, 600.0, 300.0)]
    for name in ("thickness", "normal_velocity"):
        errors = [np.abs(getattr(one, name) - getattr(exact, name)).max() for one in found]
        np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.25, err_msg=name)


def test_waves_are_nearly_of_order_three() -> None:
    """The error of the phase has order two, but an eighteenth of the midpoint rule's 1/6; damping has order three."""
    for phase in (0.2, 0.1):
        eigenvalue = next(value for value in np.linalg.eigvals(amplification(phase)) if value.imag > 0.0)
        assert np.angle(eigenvalue) / phase - 1.0 == pytest.approx(-(phase**2) / 109.5, rel=2e-2)
        assert np.abs(eigenvalue) - 1.0 == pytest.approx(-(phase**4) / 421.0, rel=2e-2)


def test_steps_are_longer_than_those_of_the_classical_method(icosahedral_mesh: VoronoiMesh) -> None:
    """At a time step with which RK4 blows up, days pass, and mass stays what it was."""
    runs = {}
    per_second = Simulation(icosahedral_mesh, Williamson5(), time_step=1.0).initial_courant_number
    limits = {name: STEPPINGS[name].stable_courant_number for name in ("rk4", "fbrk3")}
    step = 0.95 * limits["fbrk3"] / per_second
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SetupWarning)
        for name in limits:
            runs[name] = Simulation(icosahedral_mesh, Williamson5(), time_step=step, integrator=name)
    with pytest.raises(RunError, match=r"the Courant number was 1\.\d+ at the start: where that is above 0\.8, a sm"):
        runs["rk4"].run(days=5, progress=False)
    stable = runs["fbrk3"]
    stable.run(days=5, progress=False)
    start, end = stable.initial_invariants, stable.invariants
    assert abs(end.mass - start.mass) < 1e-15 * start.mass
    assert abs(end.absolute_vorticity - start.absolute_vorticity) < 1e-14 * start.planetary_vorticity_magnitude
    assert abs(end.total_energy - start.total_energy) < 1e-5 * start.total_energy
    assert abs(end.potential_enstrophy / start.potential_enstrophy - 1.0) < 0.02


def test_default_step_is_the_same_fraction_of_the_limit(icosahedral_mesh: VoronoiMesh) -> None:
    case, interval = Williamson5(), 86400.0 * 60
    steps = {
        name: Simulation(
            icosahedral_mesh, case, integrator=name, snapshot_interval=interval, diagnostics_interval=interval
        ).configuration.time_step
        for name in STEPPINGS
    }
    assert steps["rk4"] == steps["rrk4"]
    assert steps["fbrk3"] == steps["rfbrk3"]
    assert steps["fbrk3"] / steps["rk4"] == pytest.approx(1.3655, rel=1e-3)
    assert STEPPINGS["rk4"].default_courant_number == 0.8


def test_its_own_limit_is_warned_of(icosahedral_mesh: VoronoiMesh) -> None:
    per_second = Simulation(icosahedral_mesh, Williamson5(), time_step=1.0).initial_courant_number
    limit = STEPPINGS["fbrk3"].stable_courant_number / per_second
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Simulation(icosahedral_mesh, Williamson5(), time_step=0.999 * limit, integrator="fbrk3")
    with pytest.warns(SetupWarning, match=re.escape(f"number is 1.59; one of {0.95 * limit:.3g} s would do")):
        Simulation(icosahedral_mesh, Williamson5(), time_step=1.01 * limit, integrator="fbrk3")


def test_a_bell_in_a_prescribed_wind(icosahedral_mesh: VoronoiMesh) -> None:
    """Thickness alone moves, by a three-stage Runge-Kutta method, and ends where RK4 takes it."""
    classical, found = (Simulation(icosahedral_mesh, Williamson1(), integrator=name) for name in ("rk4", "fbrk3"))
    start = found.state.copy()
    for simulation in (classical, found):
        simulation.run(days=3, progress=False)
    assert found.configuration.time_step > 1.2 * classical.configuration.time_step
    np.testing.assert_array_equal(found.state.normal_velocity, start.normal_velocity)
    moved = np.abs(classical.state.thickness - start.thickness).max()
    np.testing.assert_allclose(found.state.thickness, classical.state.thickness, atol=0.08 * moved)
    assert abs(found.invariants.mass / found.initial_invariants.mass - 1.0) < 1e-14


def test_halves_are_the_tendency(any_mesh: VoronoiMesh) -> None:
    forcing = Forcing("both", lambda mesh, state, time: 1e-3 * time, lambda mesh, state, time: 1e-4 * state.thickness)
    model, state = random_model(any_mesh, forcing, seed=3)
    whole, halves = state.empty_like(), state.empty_like()
    model.velocity_tendency(state, halves.normal_velocity, 7.0)
    model.thickness_tendency(state, halves.thickness, 7.0)
    model.tendency(state, whole, 7.0)
    np.testing.assert_array_equal(halves.thickness, whole.thickness)
    np.testing.assert_array_equal(halves.normal_velocity, whole.normal_velocity)


def test_terms_are_evaluated_once_in_each_stage(small_mesh: VoronoiMesh) -> None:
    """A source at the states that the stages leave, an acceleration at the same velocity with the new thickness."""
    seen: dict[str, list[tuple[float, float, float]]] = {"source": [], "acceleration": []}

    def watch(what: str) -> Callable[[VoronoiMesh, State, float], float]:
        def value(mesh: VoronoiMesh, state: State, time: float) -> float:
            seen[what].append((time, float(state.thickness[0]), float(state.normal_velocity[0])))
            return 1e-4

        return value

    model, state = random_model(small_mesh, Forcing("both", watch("acceleration"), watch("source")), seed=4)
    ForwardBackward(model, state).step(state, 60.0, 100.0)
    for calls in seen.values():
        assert [time for time, _, _ in calls] == [100.0, 120.0, 130.0]
    assert [u for _, _, u in seen["source"]] == [u for _, _, u in seen["acceleration"]]
    assert all(h != other for (_, h, _), (_, other, _) in zip(seen["source"], seen["acceleration"], strict=True))


def test_a_term_with_add_alone_acts_on_both_halves(small_mesh: VoronoiMesh) -> None:
    class Both(Term):
        name, meaning, changes = "both", "by both", ("mass", "total_energy")

        def add(self, mesh: VoronoiMesh, state: State, time: float, tendency: State) -> None:
            tendency.thickness[:] += 1e-3 * state.thickness
            tendency.normal_velocity[:] -= 1e-3 * state.normal_velocity

    forcing = Forcing(
        "same",
        lambda mesh, state, time: -1e-3 * state.normal_velocity,
        lambda mesh, state, time: 1e-3 * state.thickness,
    )
    states = []
    for term in (Both(), forcing):
        model, state = random_model(small_mesh, term, seed=4)
        ForwardBackward(model, state).advance(state, 60.0, 3)
        states.append(state)
    np.testing.assert_array_equal(states[0].thickness, states[1].thickness)
    np.testing.assert_array_equal(states[0].normal_velocity, states[1].normal_velocity)


def test_a_tide_is_integrated_at_the_times_of_the_stages(small_mesh: VoronoiMesh) -> None:
    """A source that grows with time is integrated exactly, one with its square by the midpoint rule."""

    @dataclass(frozen=True, repr=False)
    class Filling(LakeAtRest):
        name: ClassVar[str] = "filling"

        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("tide", source=lambda mesh, state, time: 1e-9 * time),)

    simulation = Simulation(small_mesh, Filling(mountain_height=0.0), time_step=1800.0, integrator="fbrk3")
    before = simulation.state.thickness.copy()
    simulation.run(days=0.5, progress=False)
    np.testing.assert_allclose(simulation.state.thickness - before, 1e-9 * 43200.0**2 / 2.0, rtol=1e-9)


def test_rest_and_geostrophic_balance_stay(icosahedral_mesh: VoronoiMesh) -> None:
    lake = Simulation(icosahedral_mesh, LakeAtRest(), integrator="fbrk3")
    lake.run(days=1, progress=False)
    assert np.abs(lake.state.normal_velocity).max() < 1e-10
    runs = [Simulation(icosahedral_mesh, Williamson2(), integrator=name) for name in ("rk4", "fbrk3")]
    for simulation in runs:
        simulation.run(days=1, progress=False)
    np.testing.assert_allclose(runs[1].state.thickness, runs[0].state.thickness, rtol=3e-4)


def test_a_step_allocates_nothing_that_grows_with_the_mesh() -> None:
    import tracemalloc

    class Nothing(TwoNumbers):
        def thickness_tendency(self, state: State, result: Array, time: float) -> None:
            return

        velocity_tendency = thickness_tendency

    size = 200_000
    state = State(np.ones(size), np.zeros(size))
    method = ForwardBackward(Nothing(lambda h, u, time: h, lambda h, u, time: u), state)
    method.step(state, 1.0)
    tracemalloc.start()
    method.step(state, 1.0)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < size

"""Wind, drags, viscosity and relaxation: what they add, and what the budgets say of it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from cases import Williamson2
from mesh import VoronoiMesh, build_operators
from mesh.discrete.operators import normal_component
from mesh.discrete.walls import wall_edges
from swe import (
    Forcing,
    InputError,
    LinearDrag,
    QuadraticDrag,
    Simulation,
    ThicknessRelaxation,
    Viscosity,
    WindStress,
)
from swe.diagnostics.budgets import measure_rates
from swe.diagnostics.invariants import measure_invariants
from swe.integrators import Integrator
from swe.output.files import read_series
from swe.run.composition import plain_method
from tests.cut_mesh import without_cap
from tests.swe.random_model import random_model

HOUR = 3600.0


def ready() -> tuple[Forcing, ...]:
    """One of each, all of them strong."""
    return (
        WindStress(lambda longitude, latitude: 0.5 * np.cos(2.0 * latitude), 0.1),
        LinearDrag(1e-5),
        QuadraticDrag(3e-2),
        Viscosity(1e6),
        ThicknessRelaxation(lambda longitude, latitude: 2900.0 + 50.0 * np.sin(longitude) * np.cos(latitude), 5e5),
    )


NAMES = [term.name for term in ready()]


def term_named(name: str) -> Forcing:
    return next(term for term in ready() if term.name == name)


@pytest.fixture
def part(icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    return without_cap(icosahedral_mesh)


def test_accelerations_are_those_of_the_equations(part: VoronoiMesh) -> None:
    model, state = random_model(part, *ready(), seed=4)
    mesh, h, u = model.mesh, state.thickness, state.normal_velocity
    operators = build_operators(mesh)
    added = {term.name: model.tendency_of(term, state) for term in model.terms}
    h_edge, energy = operators.cell_to_edge @ h, operators.kinetic_energy @ u**2
    stress = normal_component(mesh, 0.5 * np.cos(2.0 * mesh.lat_edge), 0.1)
    speed = np.sqrt(energy[model.closed.cells_on_edge].sum(axis=1))
    along = operators.gradient @ (operators.divergence @ u)
    tail, head = mesh.vertices_on_edge.T
    curl = operators.curl @ u
    inner = np.ones(mesh.n_edges)
    inner[wall_edges(mesh)] = 0.0
    expected = {
        "wind": inner * stress / 1025.0 / h_edge,
        "linear_drag": -1e-5 * u,
        "quadratic_drag": -3e-2 * speed * u / h_edge,
        "viscosity": 1e6 * inner * (along - (curl[head] - curl[tail]) / mesh.dv_edge),
    }
    for name, acceleration in expected.items():
        size = np.abs(acceleration).max()
        assert size > 0.0
        np.testing.assert_allclose(added[name].normal_velocity, acceleration, rtol=0, atol=1e-12 * size, err_msg=name)
        assert not added[name].thickness.any()
    target = 2900.0 + 50.0 * np.sin(mesh.lon_cell) * np.cos(mesh.lat_cell)
    np.testing.assert_array_equal(added["relaxation"].thickness, (target - h) / 5e5)
    assert not added["relaxation"].normal_velocity.any()


@pytest.mark.parametrize("slip", [0.0, 0.4, 1.0])
def test_viscosity_takes_the_slip_of_the_model(part: VoronoiMesh, slip: float) -> None:
    """One term serves models with different slips."""
    shared = Viscosity(1e6)
    model, state = random_model(part, shared, seed=4, wall_slip=slip)
    random_model(part, shared, seed=4, wall_slip=0.7)
    (term,) = model.forcings
    mesh, u = model.mesh, state.normal_velocity
    operators = build_operators(mesh, slip)
    tail, head = mesh.vertices_on_edge.T
    curl = operators.curl @ u
    expected = 1e6 * (operators.gradient @ (operators.divergence @ u) - (curl[head] - curl[tail]) / mesh.dv_edge)
    expected[wall_edges(mesh)] = 0.0
    added = model.tendency_of(term, state).normal_velocity
    np.testing.assert_allclose(added, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_the_slip_of_a_run_is_that_of_its_viscosity(icosahedral_mesh: VoronoiMesh) -> None:
    """Also in the hash of the start, which tells a run that goes on from another one."""
    cut = without_cap(icosahedral_mesh)
    runs = [Simulation(cut, Viscous(viscosity=1e9), wall_slip=slip) for slip in (0.0, 1.0)]
    added = [run.model.tendency_of(run.model.forcings[0], run.state).normal_velocity for run in runs]
    assert np.abs(added[0] - added[1]).max() > 0.01 * np.abs(added[0]).max()
    hashes = [run._described(()).start_hash for run in runs]
    assert hashes[0] != hashes[1]


def test_budgets_are_the_work_of_each_term(part: VoronoiMesh) -> None:
    """Wind does tau . u, drag takes r h u^2, both drags and viscosity take energy, relaxation alone changes mass."""
    model, state = random_model(part, *ready(), seed=4)
    mesh, h, u = model.mesh, state.thickness, state.normal_velocity
    slope = state.empty_like()
    model.tendency(state, slope)
    rates = measure_rates(model, state, model.diagnose(state), slope)
    of_edge = mesh.dv_edge * mesh.dc_edge * u
    stress = normal_component(mesh, 0.5 * np.cos(2.0 * mesh.lat_edge), 0.1) / 1025.0
    assert rates["total_energy_rate_wind"] == pytest.approx(of_edge @ stress, rel=1e-10)
    h_edge = build_operators(mesh).cell_to_edge @ h
    assert rates["total_energy_rate_linear_drag"] == pytest.approx(-1e-5 * of_edge @ (h_edge * u), rel=1e-12)
    for name in ("linear_drag", "quadratic_drag", "viscosity"):
        assert rates[f"total_energy_rate_{name}"] < 0.0
    target = 2900.0 + 50.0 * np.sin(mesh.lon_cell) * np.cos(mesh.lat_cell)
    filled = float(mesh.area_cell @ ((target - h) / 5e5))
    assert rates["mass_rate_relaxation"] == pytest.approx(filled, rel=1e-13)
    assert {name for name in rates if name.startswith("mass_rate_")} == {"mass_rate_transport", "mass_rate_relaxation"}


@dataclass(frozen=True, repr=False)
class Forced(Williamson2):
    """A zonal flow with one of the ready terms."""

    name: ClassVar[str] = "forced"
    term: str = "wind"

    def terms(self) -> tuple[Forcing, ...]:
        return (term_named(self.term),)


def energy_and_its_rate(simulation: Simulation) -> tuple[float, float]:
    """Total energy now, and the sum of its rates."""
    model, state = simulation.model, simulation.state
    slope, diagnosis = state.empty_like(), model.diagnose(state)
    model.tendency(state, slope)
    rates = measure_rates(model, state, diagnosis, slope)
    rate = sum(value for name, value in rates.items() if name.startswith("total_energy_rate"))
    return measure_invariants(model, state, diagnosis).total_energy, rate


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
@pytest.mark.parametrize("name", NAMES)
def test_rates_are_the_change_over_steps(small_mesh: VoronoiMesh, name: str, integrator: Integrator) -> None:
    """What a term does to energy over six hours is the integral of its rate, by the trapezoidal rule with order two."""
    misses = []
    for steps in (18, 36):
        simulation = Simulation(small_mesh, Forced(term=name), time_step=6.0 * HOUR / steps, integrator=integrator)
        rows = [energy_and_its_rate(simulation)]
        for _ in range(steps):
            simulation.run(days=0.25 / steps, progress=False)
            rows.append(energy_and_its_rate(simulation))
        energies, rates = np.transpose(rows)
        changed = energies[-1] - energies[0]
        misses.append(abs(np.trapezoid(rates, dx=6.0 * HOUR / steps) - changed) / abs(changed))
    assert misses[0] < 0.1
    assert misses[1] < max(0.35 * misses[0], 1e-6)


def test_a_run_leaves_the_budgets_of_its_terms(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Mass follows the budget of the relaxation: exactly where it does not depend on the thickness that moves."""

    @dataclass(frozen=True, repr=False)
    class All(Williamson2):
        name: ClassVar[str] = "all-terms"

        def terms(self) -> tuple[Forcing, ...]:
            return ready()

    simulation = Simulation(small_mesh, All(), tmp_path, time_step=900.0, diagnostics_interval=900.0)
    assert simulation.loops == "fused"
    simulation.run(days=0.25, progress=False)
    series = read_series(tmp_path / "diagnostics.nc")
    for name in NAMES[:-1]:
        assert np.abs(series[f"total_energy_rate_{name}"]).min() > 0.0
        assert f"mass_rate_{name}" not in series
    mass, rate = series["mass"], series["mass_rate_relaxation"]
    # The mean of (h* - h)/T over the sea falls exactly as exp(-t/T).
    np.testing.assert_allclose(rate, rate[0] * np.exp(-series["time"] / 5e5), rtol=1e-9)
    np.testing.assert_allclose(mass - mass[0], 5e5 * (rate[0] - rate), rtol=1e-7, atol=1e-12 * mass[0])
    assert np.all(series["total_energy_rate_linear_drag"] < 0.0)


def test_a_field_of_numbers_is_the_same_everywhere(small_mesh: VoronoiMesh) -> None:
    model, state = random_model(small_mesh, ThicknessRelaxation(1000.0, 100.0), WindStress(0.2, density=1000.0), seed=1)
    pull, push = (model.tendency_of(term, state) for term in model.terms)
    np.testing.assert_array_equal(pull.thickness, (1000.0 - state.thickness) / 100.0)
    depth = state.thickness[small_mesh.cells_on_edge].mean(axis=1)
    np.testing.assert_allclose(push.normal_velocity, 2e-4 * np.cos(small_mesh.angle_edge) / depth, rtol=1e-12)


def test_a_term_may_serve_two_meshes(small_mesh: VoronoiMesh, icosahedral_mesh: VoronoiMesh) -> None:
    wind = WindStress(0.2)
    for mesh in (small_mesh, icosahedral_mesh, small_mesh):
        model, state = random_model(mesh, wind, seed=1)
        fresh, _ = random_model(mesh, WindStress(0.2), seed=1)
        found, expected = model.tendency_of(wind, state), fresh.tendency_of(fresh.terms[0], state)
        np.testing.assert_array_equal(found.normal_velocity, expected.normal_velocity)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LinearDrag(-1.0), "the rate of the drag is -1; it must be zero or positive"),
        (lambda: QuadraticDrag(float("nan")), "the drag coefficient is nan; it must be zero or positive"),
        (lambda: Viscosity("much"), "the viscosity is 'much'"),
        (lambda: ThicknessRelaxation(1000.0, 0.0), "the time scale of the relaxation is 0; it must be positive"),
        (lambda: ThicknessRelaxation(float("inf"), 1.0), "the thickness to relax to is inf; give a finite number, or"),
        (lambda: WindStress(0.1, density=-5.0), "the density is -5; it must be positive"),
        (lambda: WindStress(0.1, name="time"), "a term cannot be named 'time'"),
    ],
)
def test_coefficients_that_are_refused(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_a_stress_of_the_wrong_shape_is_named(small_mesh: VoronoiMesh) -> None:
    wind = WindStress(lambda longitude, latitude: np.zeros(3))
    model, state = random_model(small_mesh, wind, seed=1)
    with pytest.raises(InputError, match=r"the acceleration of the term wind failed at 0 s: ValueError"):
        model.tendency(state, state.empty_like())


@dataclass(frozen=True, repr=False)
class Viscous(Williamson2):
    """A zonal flow in a very viscous fluid."""

    name: ClassVar[str] = "viscous"
    viscosity: float = 1e8

    def terms(self) -> tuple[Forcing, ...]:
        return (Viscosity(self.viscosity),)


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
@pytest.mark.parametrize("cut", [False, True])
def test_viscosity_bounds_the_time_step(icosahedral_mesh: VoronoiMesh, integrator: Integrator, cut: bool) -> None:
    """The default step is stable, and not much shorter than it must be; a longer one is warned of."""
    mesh = without_cap(icosahedral_mesh) if cut else icosahedral_mesh
    simulation = Simulation(mesh, Viscous(), integrator=integrator)
    free = Simulation(mesh, Viscous(viscosity=0.0), integrator=integrator)
    step = simulation.configuration.time_step
    assert (
        step
        < 0.5 * free.configuration.time_step
        == 0.5 * Simulation(mesh, Williamson2(), integrator=integrator).configuration.time_step
    )
    random = np.random.default_rng(2).normal(size=mesh.n_edges)
    for steps, longer in ((60, 1.0), (60, 3.0)):
        state = simulation.state.copy()
        inner = np.ones(mesh.n_edges)
        inner[wall_edges(mesh)] = 0.0
        state.normal_velocity[:] = random * inner
        plain_method(simulation.model, state, integrator).advance(state, longer * step, steps)
        assert (np.abs(state.normal_velocity).max() < 50.0) == (longer == 1.0)
    with pytest.warns(UserWarning, match=r"likely to be unstable, as it is long for the viscosity; one of"):
        Simulation(mesh, Viscous(), integrator=integrator, time_step=1.2 * step)

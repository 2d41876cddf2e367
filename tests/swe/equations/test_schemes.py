"""A scheme is its kinetic energy and the flux that is the derivative of the energy: any such pair keeps the energy."""

import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe import InputError, ShallowWaterModel, Simulation, State
from swe.diagnostics.budgets import measure_rates
from swe.diagnostics.invariants import measure_invariants
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.fused import FusedRungeKutta
from tests.swe.random_model import random_model


def shares(mesh: VoronoiMesh) -> Array:
    """Parts of l d that the first cell of each edge has, instead of a half each."""
    return np.random.default_rng(9).uniform(0.3, 0.7, mesh.n_edges)


class Uneven(Scheme):
    name, source = "uneven", "a scheme of the tests"

    def kinetic_energy(self, u: Array, K: Array) -> None:
        mesh = self.mesh
        first, energy = shares(mesh), 0.5 * mesh.dv_edge * mesh.dc_edge * u**2
        K[:] = np.bincount(mesh.cells_on_edge[:, 0], first * energy, mesh.n_cells)
        K += np.bincount(mesh.cells_on_edge[:, 1], (1.0 - first) * energy, mesh.n_cells)
        K /= mesh.area_cell

    def flux(self, h: Array, u: Array, F: Array) -> None:
        mesh, first = self.mesh, shares(self.mesh)
        F[:] = (first * h[mesh.cells_on_edge[:, 0]] + (1.0 - first) * h[mesh.cells_on_edge[:, 1]]) * u


class Wrong(Uneven):
    name, source = "wrong", "a scheme whose flux is not the derivative of its energy"
    flux = Ringler2010.flux


def energy_rate(model: ShallowWaterModel, state: State) -> tuple[float, float]:
    """The rate of the energy along the tendency, and its size, from the definition of the energy."""
    slope = state.empty_like()
    model.tendency(state, slope)

    def energy(time: float) -> float:
        there = State(state.thickness + time * slope.thickness, state.normal_velocity + time * slope.normal_velocity)
        return measure_invariants(model, there, model.diagnose(there)).total_energy

    step = 1e-2 / np.abs(slope.normal_velocity).max()
    kinetic = measure_invariants(model, state, model.diagnose(state)).kinetic_energy
    # A cubic in time: its derivative is the combination of two differences.
    near, far = energy(step) - energy(-step), energy(2.0 * step) - energy(-2.0 * step)
    return (8.0 * near - far) / (12.0 * step), kinetic * np.abs(slope.normal_velocity).max()


def test_the_flux_is_the_derivative_of_the_energy(any_mesh: VoronoiMesh) -> None:
    wrong, size = energy_rate(*random_model(any_mesh, seed=2, scheme=Wrong))
    for scheme in (Ringler2010, Consistent, Uneven):
        rate, _ = energy_rate(*random_model(any_mesh, seed=2, scheme=scheme))
        assert abs(rate) < min(1e-7 * size, 1e-2 * abs(wrong)), scheme.name


def test_budgets_know_the_scheme(any_mesh: VoronoiMesh) -> None:
    exchanges = {}
    for scheme in (Ringler2010, Consistent, Uneven, Wrong):
        model, state = random_model(any_mesh, seed=2, scheme=scheme)
        slope = state.empty_like()
        model.tendency(state, slope)
        rates = measure_rates(model, state, model.diagnose(state), slope)
        _, size = energy_rate(model, state)
        assert abs(rates["total_energy_rate_coriolis"]) < 1e-12 * size
        assert abs(rates["mass_rate_transport"]) < 1e-14 * (model.mesh.area_cell @ np.abs(slope.thickness))
        exchanges[scheme.name] = abs(rates["total_energy_rate_exchange"]) / size
    assert exchanges["ringler2010"] < 1e-12
    assert exchanges["consistent"] < 1e-12
    assert exchanges["uneven"] < 1e-12


def test_a_scheme_of_ones_own_runs_by_plain_loops(icosahedral_mesh: VoronoiMesh) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5())
    before, start = simulation.model, simulation.state.copy()
    model = ShallowWaterModel(before.mesh, before.topography, before.coriolis, before.gravity, scheme=Uneven)
    with pytest.raises(InputError, match="the scheme is uneven, which the fused method lacks; take RungeKutta"):
        FusedRungeKutta(model)
    RungeKutta(model.tendency, start).advance(start, 300.0, 100)
    first = measure_invariants(model, simulation.state, model.diagnose(simulation.state))
    last = measure_invariants(model, start, model.diagnose(start))
    assert abs(last.total_energy - first.total_energy) < 1e-6 * first.available_energy
    assert abs(last.mass / first.mass - 1.0) < 1e-14

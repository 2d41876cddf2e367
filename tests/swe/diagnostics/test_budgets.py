"""Rates of the integrals by term: they add up to the rates of change, and those that should vanish do so."""

from pathlib import Path

import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from swe import Simulation, State
from swe.diagnostics.budgets import RATES, measure_rates, rate_name, rates_of_time
from swe.equations.anticipation import Anticipation
from swe.equations.dissipation import BiharmonicDissipation
from swe.output.files import read_series
from swe.tiles.fused import FusedRungeKutta
from tests.swe.random_model import RADIUS, derivatives_along, random_model


def gentle(mesh: VoronoiMesh) -> BiharmonicDissipation:
    """Dissipation that would be stable with steps of a minute."""
    unit = BiharmonicDissipation(mesh, 1.0).largest_time_step
    return BiharmonicDissipation(mesh, unit / 60.0)


def test_work_of_coriolis_force_and_exchange_vanish(any_mesh: VoronoiMesh) -> None:
    """Relative to the sum of the magnitudes of what cancels; q is random, and so are h and u."""
    model, state = random_model(any_mesh, seed=11)
    mesh, diagnosis = model.mesh, model.diagnose(state)
    tendency = state.empty_like()
    FusedRungeKutta(model).tendency(state, tendency)
    rates = measure_rates(model, state, diagnosis, tendency)
    flux = state.thickness[mesh.cells_on_edge].mean(axis=1) * state.normal_velocity
    bernoulli = 9.8 * (state.thickness + model.topography) + diagnosis.kinetic_energy
    gradient = (bernoulli[mesh.cells_on_edge[:, 1]] - bernoulli[mesh.cells_on_edge[:, 0]]) / mesh.dc_edge
    measure = mesh.dv_edge * mesh.dc_edge * np.abs(flux)
    coriolis = np.abs(tendency.normal_velocity + gradient)
    assert abs(rates["total_energy_rate_coriolis"]) < 1e-14 * (measure @ (coriolis + np.abs(gradient)))
    assert abs(rates["total_energy_rate_exchange"]) < 1e-14 * (measure @ np.abs(gradient))
    assert abs(rates["mass_rate_transport"]) < 1e-14 * (mesh.area_cell @ np.abs(tendency.thickness))
    circulation = 2.0 * (mesh.dc_edge @ (coriolis + np.abs(gradient)))
    assert abs(rates["absolute_vorticity_rate_coriolis"]) < 1e-14 * circulation
    assert abs(rates["absolute_vorticity_rate_gradient"]) < 1e-14 * circulation
    assert abs(measure @ (np.sign(flux) * (tendency.normal_velocity + gradient) * np.arange(mesh.n_edges))) > (
        1e-6 * (measure @ coriolis)
    )


@pytest.mark.parametrize("anticipation", [0.0, 200.0])
def test_rates_add_up_to_the_derivative_of_the_integrals(any_mesh: VoronoiMesh, anticipation: float) -> None:
    """Along the tendency the integrals are polynomials or smooth: central differences give their derivatives."""
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("gradients along edges of no length have no meaning")
    scaled = any_mesh.scaled(RADIUS)
    dissipation = gentle(scaled)
    terms = [Anticipation(scaled, anticipation)] if anticipation > 0.0 else []
    model, state = random_model(any_mesh, dissipation, *terms, seed=11)
    tendency = state.empty_like()
    model.tendency(state, tendency)
    rates = measure_rates(model, state, model.diagnose(state), tendency)
    slope = State(tendency.thickness, tendency.normal_velocity + dissipation.acceleration(state.normal_velocity))

    derivatives = derivatives_along(model, state, slope)
    for integral, (_, terms) in RATES.items():
        derivative, noise = derivatives[integral]
        parts = [rates[rate_name(integral, term)] for term in terms]
        assert sum(parts) == pytest.approx(derivative, rel=1e-5, abs=noise), integral
    assert rates["total_energy_rate_dissipation"] < 0.0
    assert abs(rates["absolute_vorticity_rate_dissipation"]) < 1e-10 * float(
        model.mesh.dc_edge @ np.abs(dissipation.acceleration(state.normal_velocity))
    )
    assert (rates["potential_enstrophy_rate_anticipation"] != 0.0) == (anticipation > 0.0)


def test_anticipation_damps_enstrophy_at_no_cost_in_energy(larger_mesh: VoronoiMesh) -> None:
    plain, anticipating = (Simulation(larger_mesh, Williamson5(), anticipation=factor) for factor in (0.0, 0.5))
    for simulation in (plain, anticipating):
        simulation.run(days=5, progress=False)
    assert anticipating.invariants.potential_enstrophy < plain.invariants.potential_enstrophy
    model, state = anticipating.model, anticipating.state
    tendency = state.empty_like()
    model.tendency(state, tendency)
    rates = measure_rates(model, state, model.diagnose(state), tendency)
    assert rates["potential_enstrophy_rate_anticipation"] < 0.0
    scale = anticipating.invariants.kinetic_energy / 86400.0
    assert abs(rates["total_energy_rate_coriolis"]) < 1e-12 * scale


def test_rates_of_the_time_step() -> None:
    terms = {rate_name(integral, term): 0.0 for integral, (_, names) in RATES.items() for term in names}
    first = {"time": 10.0, **dict.fromkeys(RATES, 5.0), **terms}
    second = {"time": 14.0, **dict.fromkeys(RATES, 13.0), **terms, "total_energy_rate_dissipation": 1.0}
    assert set(rates_of_time(first, None).values()) == {0.0}
    found = rates_of_time(second, first)
    assert found["mass_rate_time"] == 2.0
    assert found["total_energy_rate_time"] == 1.5


def test_diagnostics_show_the_budgets(larger_mesh: VoronoiMesh, tmp_path: Path) -> None:
    for name in ("rk4", "rrk4"):
        Simulation(larger_mesh, Williamson5(), tmp_path / name, integrator=name).run(days=1, progress=False)
    plain, relaxed = (read_series(tmp_path / name / "diagnostics.nc") for name in ("rk4", "rrk4"))
    for series in (plain, relaxed):
        turnover = series["kinetic_energy"] / 86400.0
        for term in ("coriolis", "exchange"):
            assert np.all(np.abs(series[f"total_energy_rate_{term}"]) < 1e-13 * turnover)
        assert np.all(series["total_energy_rate_dissipation"] == 0.0)
    total = plain["total_energy"][0] / 86400.0
    assert np.all(np.abs(plain["total_energy_rate_time"][1:]) > 1e-10 * total)
    assert np.all(np.abs(relaxed["total_energy_rate_time"]) < 1e-14 * total)

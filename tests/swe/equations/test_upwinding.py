"""Upwinding of potential vorticity: the value upstream, no work, less enstrophy, whatever the time step."""

from pathlib import Path

import numpy as np
import pytest

from cases import Williamson1, Williamson5
from mesh import VoronoiMesh, build_operators
from mesh.discrete.operators import vertex_to_cell
from swe import Simulation
from swe.diagnostics.budgets import measure_rates
from swe.equations.upwinding import Upwinding
from swe.errors import InputError
from swe.output.files import read_series
from tests.swe.random_model import RADIUS, random_model

RATE = "potential_enstrophy_rate_upwinding"


def test_it_is_what_the_operators_say(any_mesh: VoronoiMesh) -> None:
    """At a factor of 1 it is the value on the ellipse through cells and vertices, as the differences have it."""
    upwinding = Upwinding(any_mesh.scaled(RADIUS), 1.0)
    model, state = random_model(any_mesh, upwinding, seed=3)
    mesh, u = model.mesh, state.normal_velocity
    q = model.diagnose(state).potential_vorticity
    tail, head = mesh.vertices_on_edge.T
    first, second = mesh.cells_on_edge.T
    tangential, q_cell = build_operators(mesh).perp @ u, vertex_to_cell(mesh, q)
    angle = np.arctan2(mesh.dc_edge * tangential, mesh.dv_edge * u)
    change = -0.5 * (np.cos(angle) * (q_cell[second] - q_cell[first]) + np.sin(angle) * (q[head] - q[tail]))
    found = np.zeros(mesh.n_edges)
    upwinding.change_vorticity(state, q, found)
    np.testing.assert_allclose(found, change, rtol=0, atol=1e-12 * np.abs(change).max())


def test_flow_along_an_edge_carries_the_vertex_upstream(small_mesh: VoronoiMesh) -> None:
    """And flow across it the cell upstream."""
    model, state = random_model(small_mesh, seed=3)
    mesh = model.mesh
    q = np.random.default_rng(1).normal(size=mesh.n_vertices)
    u, tangential = state.normal_velocity, build_operators(mesh).perp
    mean = q[mesh.vertices_on_edge].mean(axis=1)
    edge = 7
    u[:] = 0.0
    u[mesh.edges_on_edge[edge][: mesh.n_edges_on_edge[edge]]] = mesh.weights_on_edge[edge][: mesh.n_edges_on_edge[edge]]
    assert (tangential @ u)[edge] > 0.0
    found = mean.copy()
    Upwinding(mesh, 1.0).change_vorticity(state, q, found)
    assert found[edge] == pytest.approx(q[mesh.vertices_on_edge[edge, 0]], rel=1e-12)
    u[:] = 0.0
    u[edge] = -3.0
    found = mean.copy()
    Upwinding(mesh, 1.0).change_vorticity(state, q, found)
    assert (tangential @ u)[edge] == 0.0
    across = np.subtract(*vertex_to_cell(mesh, q)[mesh.cells_on_edge[edge]])
    assert found[edge] == pytest.approx(mean[edge] - 0.5 * across, rel=1e-12)
    u[:] = 0.0
    Upwinding(mesh, 1.0).change_vorticity(state, q, mean)
    assert np.array_equal(mean, q[mesh.vertices_on_edge].mean(axis=1)), "nothing moves"


def test_it_does_no_work_takes_enstrophy_and_is_linear_in_the_factor(any_mesh: VoronoiMesh) -> None:
    found = []
    for factor in (0.25, 1.0):
        model, state = random_model(any_mesh, Upwinding(any_mesh.scaled(RADIUS), factor), seed=5)
        slope = state.empty_like()
        model.tendency(state, slope)
        rates = measure_rates(model, state, model.diagnose(state), slope)
        (term,) = model.terms
        force = model.tendency_of(term, state).normal_velocity
        flux = np.empty(any_mesh.n_edges)
        model.scheme.flux(state.thickness, state.normal_velocity, flux)
        work = model.mesh.dv_edge * model.mesh.dc_edge * flux * force
        assert abs(work.sum()) < 1e-13 * np.abs(work).sum()
        assert abs(rates["total_energy_rate_coriolis"]) < 1e-12 * np.abs(work).sum()
        assert rates[RATE] < 0.0
        found.append(rates[RATE])
    assert found[1] == pytest.approx(4.0 * found[0], rel=1e-10)


def test_a_run_loses_enstrophy_alone_at_the_rate_of_its_budget(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    for name, factor in (("none", 0.0), ("some", 0.2)):
        Simulation(small_mesh, Williamson5(), tmp_path / name, time_step=900.0, upwinding=factor).run(
            days=5, progress=False
        )
    none, some = (read_series(tmp_path / name / "diagnostics.nc") for name in ("none", "some"))
    assert np.all(none[RATE] == 0.0)
    assert np.all(some[RATE] < 0.0)
    assert some["potential_enstrophy"][-1] < none["potential_enstrophy"][-1]
    for series in (none, some):
        assert np.abs(series["total_energy_change"]).max() < 1e-7
        assert np.abs(series["total_energy_rate_coriolis"]).max() < 1e-12 * some["kinetic_energy"][0] / 86400.0
    changed = some["potential_enstrophy"] - none["potential_enstrophy"]
    trapezia = np.diff(some["time"]) * 0.5 * (some[RATE][1:] + some[RATE][:-1])
    assert changed[4] == pytest.approx(trapezia[:4].sum(), rel=0.5), "but for what follows from it"


def test_its_strength_does_not_depend_on_the_time_step(small_mesh: VoronoiMesh) -> None:
    rates = {}
    for option in ("upwinding", "anticipation"):
        for time_step in (450.0, 1800.0):
            simulation = Simulation(small_mesh, Williamson5(), time_step=time_step, **{option: 0.2})  # type: ignore[arg-type]
            slope = simulation.state.empty_like()
            model, state = simulation.model, simulation.state
            model.tendency(state, slope)
            found = measure_rates(model, state, model.diagnose(state), slope)
            rates[option, time_step] = found[f"potential_enstrophy_rate_{option}"]
    assert rates["upwinding", 450.0] == rates["upwinding", 1800.0] < 0.0
    assert rates["anticipation", 450.0] == pytest.approx(0.25 * rates["anticipation", 1800.0], rel=1e-9)


@pytest.mark.parametrize("value", [-0.1, 1.01, float("nan")])
def test_other_factors_are_refused(small_mesh: VoronoiMesh, value: float) -> None:
    with pytest.raises(InputError, match=r"the upwinding is .*; it must be a number from 0 to 1"):
        Simulation(small_mesh, Williamson5(), upwinding=value)


def test_a_prescribed_wind_has_none(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(InputError, match="is prescribed; upwinding goes with winds that evolve"):
        Simulation(small_mesh, Williamson1(), upwinding=0.5)

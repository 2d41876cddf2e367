"""Vorticity at coasts from no slip to free slip: what it is, that all forms of the tendency agree, what is kept."""

import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh, build_operators
from mesh.discrete.walls import closed_mesh, wall_edges
from swe import Simulation
from swe.damping.over_tiles import DissipationOverTiles
from swe.diagnostics.budgets import RATES, causes_of_change, measure_rates, rate_name
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.model import ShallowWaterModel
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.tendency import Energy, consistent, ringler2010, tendency
from swe.equations.terms import Term
from swe.equations.upwinding import Upwinding
from swe.errors import InputError
from swe.integrators import Integrator
from swe.run.composition import fused_method, plain_method
from swe.state import State
from swe.tiles import cutting
from swe.tiles.fused import FusedRungeKutta
from tests.cut_mesh import random_sea
from tests.swe.random_model import RADIUS, derivatives_along, random_model

EQUATIONS: dict[type[Scheme], Energy] = {Ringler2010: ringler2010, Consistent: consistent}


@pytest.fixture
def sea(icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    return random_sea(icosahedral_mesh, islands=6)


def coast_of(mesh: VoronoiMesh) -> np.ndarray:
    return np.flatnonzero((mesh.cells_on_vertex < 0).any(axis=1))


def slipping_model(
    mesh: VoronoiMesh, wall_slip: float, *terms: Term, scheme: type[Scheme] = Ringler2010
) -> tuple[ShallowWaterModel, State]:
    """`random_model` with slip along its walls."""
    model, state = random_model(mesh, *terms, seed=8, scheme=scheme)
    fields = (model.mesh, model.topography, model.coriolis, model.gravity)
    return ShallowWaterModel(*fields, scheme=scheme, terms=terms, wall_slip=wall_slip), state


def test_vorticity_and_thickness_at_coasts(sea: VoronoiMesh) -> None:
    """No slip: the inner edge's circulation over the kites that are there; free slip: none; a factor between them."""
    (no_slip, state), (half, _), (free_slip, _) = (slipping_model(sea, slip) for slip in (0.0, 0.5, 1.0))
    mesh, coast = no_slip.mesh, coast_of(sea)
    found = [model.diagnose(state).relative_vorticity for model in (no_slip, half, free_slip)]
    assert len(coast) > 100
    inner = np.flatnonzero((sea.cells_on_vertex < 0).sum(axis=1) == 1)
    sides = sea.edges_on_vertex[inner]
    circulation = mesh.edge_signs_on_vertex[inner] * mesh.dc_edge[sides] * state.normal_velocity[sides]
    assert np.all(np.count_nonzero(circulation, axis=1) == 1)
    kites = np.where(sea.cells_on_vertex >= 0, mesh.kite_areas_on_vertex, 0.0)
    np.testing.assert_allclose(found[0][inner], circulation.sum(axis=1) / kites[inner].sum(axis=1), rtol=1e-13)
    np.testing.assert_allclose(found[1][coast], 0.5 * found[0][coast], rtol=1e-15)
    assert np.all(found[2][coast] == 0.0)
    inside = np.setdiff1d(np.arange(sea.n_vertices), coast)
    for other in found[1:]:
        np.testing.assert_array_equal(other[inside], found[0][inside])
    at_vertices = np.where(sea.cells_on_vertex >= 0, state.thickness[sea.cells_on_vertex], 0.0)
    thickness = (kites * at_vertices).sum(axis=1) / kites.sum(axis=1)
    q = free_slip.diagnose(state).potential_vorticity
    np.testing.assert_allclose(q[coast], no_slip.coriolis[coast] / thickness[coast], rtol=1e-13)


@pytest.mark.parametrize("scheme", EQUATIONS)
@pytest.mark.parametrize("wall_slip", [0.3, 1.0])
def test_three_forms_agree(
    sea: VoronoiMesh, wall_slip: float, scheme: type[Scheme], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cutting.build_tiles, "__defaults__", (50,))
    model, state = slipping_model(sea, wall_slip, scheme=scheme)
    operators = build_operators(model.mesh, wall_slip)
    equation = tendency(state, operators, model.topography, model.coriolis, model.gravity, EQUATIONS[scheme])
    plain, fused, no_slip = state.empty_like(), state.empty_like(), state.empty_like()
    model.tendency(state, plain)
    FusedRungeKutta(model).tendency(state, fused)
    slipping_model(sea, 0.0, scheme=scheme)[0].tendency(state, no_slip)
    size = np.abs(equation.normal_velocity).max()
    for found in (plain, fused):
        np.testing.assert_allclose(found.normal_velocity, equation.normal_velocity, rtol=0, atol=1e-12 * size)
        np.testing.assert_array_equal(found.normal_velocity[wall_edges(sea)], 0.0)
        assert np.abs(found.normal_velocity - no_slip.normal_velocity).max() > 0.01 * size


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
@pytest.mark.parametrize("changed", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_fused_and_plain_steps_agree(
    sea: VoronoiMesh, integrator: Integrator, changed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if changed and integrator == "fbrk3":
        pytest.skip("the fused forward-backward steps know no terms")
    monkeypatch.setattr(cutting.build_tiles, "__defaults__", (50,))
    closed = closed_mesh(sea.scaled(RADIUS))
    terms = (Anticipation(closed, 100.0), Upwinding(closed, 0.5)) if changed else ()
    model, state = slipping_model(sea, 0.7, *terms)
    plain, fused = state.copy(), state.copy()
    plain_method(model, plain, integrator).advance(plain, 20.0, 3)
    assert fused_method(model, integrator).advance(fused, 20.0, 3) == 3
    np.testing.assert_allclose(fused.thickness, plain.thickness, rtol=1e-12)
    np.testing.assert_allclose(fused.normal_velocity, plain.normal_velocity, rtol=0, atol=1e-10)


@pytest.mark.parametrize("wall_slip", [0.0, 0.4, 1.0])
def test_rates_add_up_to_the_derivatives_of_the_integrals(sea: VoronoiMesh, wall_slip: float) -> None:
    """Energy and mass are kept whatever the slip; what pressure does to vorticity at coasts is in the budgets."""
    model, state = slipping_model(sea, wall_slip)
    slope = state.empty_like()
    model.tendency(state, slope)
    rates = measure_rates(model, state, model.diagnose(state), slope)
    derivatives = derivatives_along(model, state, slope)
    for integral in RATES:
        derivative, noise = derivatives[integral]
        found = sum(rates[rate_name(integral, cause)] for cause in causes_of_change(())[integral])
        assert found == pytest.approx(derivative, rel=1e-5, abs=noise), integral
    work = model.mesh.dc_edge * model.mesh.dv_edge * 1000.0 * np.abs(state.normal_velocity * slope.normal_velocity)
    assert abs(rates["total_energy_rate_coriolis"]) < 1e-14 * work.sum()
    assert abs(rates["total_energy_rate_exchange"]) < 1e-14 * work.sum()
    assert abs(rates["mass_rate_transport"]) < 1e-14 * (model.mesh.area_cell @ np.abs(slope.thickness))
    turning = np.abs(model.mesh.dc_edge * slope.normal_velocity).sum()
    kept = abs(rates["absolute_vorticity_rate_coriolis"] + rates["absolute_vorticity_rate_gradient"])
    assert (kept < 1e-14 * turning) == (wall_slip == 0.0)


def test_dissipation_has_the_slip_of_the_model(sea: VoronoiMesh) -> None:
    """It stays symmetric and takes energy, less the freer the slip; the loops over tiles agree."""
    scaled, random = sea.scaled(RADIUS), np.random.default_rng(1)
    measure = scaled.dv_edge * scaled.dc_edge
    u, v = random.normal(size=(2, sea.n_edges))
    u[wall_edges(sea)] = v[wall_edges(sea)] = 0.0
    taken, laplacian = [], np.empty(sea.n_edges)
    for wall_slip in (0.0, 0.5, 1.0):
        damping = BiharmonicDissipation(scaled, 1e15, wall_slip)
        on_u, on_v = damping.acceleration(u).copy(), damping.acceleration(v).copy()
        assert (measure * u) @ on_v == pytest.approx((measure * v) @ on_u, rel=1e-9)
        damping.laplacian(u, laplacian)
        taken.append(-(measure * u) @ laplacian)
        plain, tiled = (State(np.ones(sea.n_cells), u.copy()) for _ in range(2))
        damping.apply(plain, 10.0)
        DissipationOverTiles(scaled, damping).apply(tiled, 10.0)
        np.testing.assert_allclose(tiled.normal_velocity, plain.normal_velocity, rtol=0, atol=1e-12)
    assert taken[0] > taken[1] > taken[2] > 0.0
    assert taken[1] == pytest.approx(0.5 * (taken[0] + taken[2]), rel=1e-12)


def test_a_run_with_slip(sea: VoronoiMesh) -> None:
    """The option reaches the model, its dissipation and the record of the configuration; a sphere does not know it."""
    simulation = Simulation(sea, Williamson5(), wall_slip=0.5, dissipation=1e15)
    assert simulation.model.wall_slip == simulation.configuration.wall_slip == 0.5
    (damping,) = simulation.model.terms
    assert isinstance(damping, BiharmonicDissipation)
    assert damping.wall_slip == 0.5
    with pytest.raises(InputError, match=r"the wall slip is 1\.5; it must be a number from 0 to 1"):
        Simulation(sea, Williamson5(), wall_slip=1.5)


def test_a_sphere_does_not_know_slip(icosahedral_mesh: VoronoiMesh) -> None:
    runs = [Simulation(icosahedral_mesh, Williamson5(), wall_slip=slip) for slip in (0.0, 1.0)]
    for run in runs:
        run.run(days=0.1, progress=False)
    np.testing.assert_array_equal(runs[0].state.normal_velocity, runs[1].state.normal_velocity)


@pytest.mark.parametrize("wall_slip", [0.0, 1.0])
def test_the_bound_of_the_time_step_holds_at_coasts(sea: VoronoiMesh, wall_slip: float) -> None:
    """It is as close as on a sphere; walls, where nothing moves, do not shorten it."""
    damping = BiharmonicDissipation(sea.scaled(RADIUS), 1e15, wall_slip)
    vector = np.random.default_rng(0).normal(size=sea.n_edges)
    vector[wall_edges(sea)] = 0.0
    for _ in range(300):
        vector = damping.acceleration(vector / np.linalg.norm(vector)).copy()
    limit = 2.0 / np.linalg.norm(vector)
    assert 0.4 * limit < damping.largest_time_step <= limit

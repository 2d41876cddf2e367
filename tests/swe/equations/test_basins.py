"""The model on parts of spheres: three forms of one tendency, no flow through the cut, and all integrals kept."""

import numba
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh, build_operators
from mesh.discrete.walls import closed_mesh, wall_edges
from mesh.parts.cutting import without_cells
from swe import Simulation
from swe.diagnostics.budgets import measure_rates
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.tendency import Energy, consistent, ringler2010, tendency
from swe.equations.upwinding import Upwinding
from swe.integrators import Integrator
from swe.run.composition import fused_method, plain_method
from swe.tiles import cutting
from swe.tiles.fused import FusedRungeKutta
from tests.cut_mesh import without_cap
from tests.swe.random_model import RADIUS, random_model


@pytest.fixture
def part(any_mesh: VoronoiMesh) -> VoronoiMesh:
    return without_cap(any_mesh)


EQUATIONS: dict[type[Scheme], Energy] = {Ringler2010: ringler2010, Consistent: consistent}


@pytest.mark.parametrize("scheme", EQUATIONS)
@pytest.mark.parametrize("cells_per_tile", [50, 10_000])
def test_three_forms_of_the_tendency_agree(
    part: VoronoiMesh, scheme: type[Scheme], cells_per_tile: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cutting.build_tiles, "__defaults__", (cells_per_tile,))
    model, state = random_model(part, seed=8, scheme=scheme)
    operators = build_operators(model.mesh)
    equation = tendency(state, operators, model.topography, model.coriolis, model.gravity, EQUATIONS[scheme])
    plain, fused = state.empty_like(), state.empty_like()
    model.tendency(state, plain)
    FusedRungeKutta(model).tendency(state, fused)
    size_h, size_u = np.abs(equation.thickness).max(), np.abs(equation.normal_velocity).max()
    noise = 1e-10 if part.dv_edge.min() < 1e-3 else 1e-12
    for found in (plain, fused):
        np.testing.assert_allclose(found.thickness, equation.thickness, rtol=0, atol=1e-13 * size_h)
        np.testing.assert_allclose(found.normal_velocity, equation.normal_velocity, rtol=0, atol=noise * size_u)
        assert not found.normal_velocity[wall_edges(part)].any()
    assert size_u > 1e-4


@pytest.mark.parametrize("scheme", EQUATIONS)
def test_nothing_leaks_whatever_the_velocity_at_walls(part: VoronoiMesh, scheme: type[Scheme]) -> None:
    model, state = random_model(part, seed=8, scheme=scheme)
    leaking = state.copy()
    leaking.normal_velocity[wall_edges(part)] = 25.0
    method = FusedRungeKutta(model)
    for tendency_of in (model.tendency, method.tendency):
        tight, found = state.empty_like(), state.empty_like()
        tendency_of(state, tight)
        tendency_of(leaking, found)
        np.testing.assert_array_equal(found.thickness, tight.thickness)


@pytest.mark.parametrize("scheme", EQUATIONS)
def test_integrals_are_kept(part: VoronoiMesh, scheme: type[Scheme]) -> None:
    """What the tendency does to mass, energy and absolute vorticity vanishes, relative to what cancels."""
    model, state = random_model(part, seed=8, scheme=scheme)
    mesh, diagnosis, slope = model.mesh, model.diagnose(state), state.empty_like()
    FusedRungeKutta(model).tendency(state, slope)
    flux = np.empty(part.n_edges)
    model.scheme.flux(state.thickness, state.normal_velocity, flux)
    bernoulli = 9.8 * (state.thickness + model.topography) + diagnosis.kinetic_energy
    work = mesh.dc_edge * mesh.dv_edge * flux * slope.normal_velocity
    energy = work.sum() + (mesh.area_cell * bernoulli * slope.thickness).sum()
    assert abs(energy) < 1e-13 * np.abs(mesh.area_cell * bernoulli * slope.thickness).sum()
    assert abs(mesh.area_cell @ slope.thickness) < 1e-14 * (mesh.area_cell @ np.abs(slope.thickness))
    turning = mesh.edge_signs_on_vertex * (mesh.dc_edge * slope.normal_velocity)[model.closed.edges_on_vertex]
    assert abs(turning.sum()) < 1e-14 * np.abs(turning).sum()
    rates = measure_rates(model, state, diagnosis, slope)
    assert abs(rates["total_energy_rate_coriolis"]) < 1e-13 * np.abs(work).sum()
    assert abs(rates["total_energy_rate_exchange"]) < 1e-13 * np.abs(work).sum()


def test_terms_leave_walls_alone(part: VoronoiMesh) -> None:
    if part.dv_edge.min() < 1e-3:
        pytest.skip("gradients along edges of no length have no meaning")
    scaled = part.scaled(RADIUS)
    damping = BiharmonicDissipation(scaled, 1e12)
    terms = (Anticipation(closed_mesh(scaled), 100.0), Upwinding(closed_mesh(scaled), 0.5), damping)
    model, state = random_model(part, *terms, seed=8)
    for term in terms:
        found = model.tendency_of(term, state)
        assert np.isfinite(found.normal_velocity).all()
        assert np.abs(found.normal_velocity).max() > 0.0
        assert not found.normal_velocity[wall_edges(part)].any()
    measure = model.mesh.dv_edge * model.mesh.dc_edge
    random = np.random.default_rng(1)
    u, v = random.normal(size=(2, part.n_edges))
    u[wall_edges(part)] = v[wall_edges(part)] = 0.0
    on_u, on_v = damping.acceleration(u).copy(), damping.acceleration(v).copy()
    assert (measure * u) @ on_v == pytest.approx((measure * v) @ on_u, rel=1e-9)
    assert (measure * u) @ on_u < 0.0


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"integrator": "rrk4"},
        {"integrator": "rfbrk3"},
        {"dissipation": 1e15},
        pytest.param({"anticipation": 0.5, "dissipation": 1e15}, marks=pytest.mark.slow),
        pytest.param({"upwinding": 0.3}, marks=pytest.mark.slow),
    ],
)
def test_a_run_in_a_basin(larger_mesh: VoronoiMesh, options: dict[str, object]) -> None:
    """Test case 5 where the tropics alone are left: mass and absolute vorticity stay, no wall lets anything pass."""
    basin = without_cells(larger_mesh, np.abs(larger_mesh.lat_cell) > 1.0)
    simulation = Simulation(basin, Williamson5(), **options)  # type: ignore[arg-type]
    start, walls = simulation.initial_invariants, wall_edges(basin)
    simulation.run(days=1, progress=False)
    now = simulation.invariants
    assert not simulation.state.normal_velocity[walls].any()
    assert np.abs(simulation.state.normal_velocity).max() > 5.0
    assert abs(now.mass / start.mass - 1.0) < 1e-14
    assert abs(now.absolute_vorticity - start.absolute_vorticity) < 1e-14 * start.planetary_vorticity_magnitude
    energy = abs(now.total_energy - start.total_energy) / start.available_energy
    limit = 1e-13 if "integrator" in options else 1e-2 if options else 2e-4
    assert energy < limit


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
def test_fused_and_plain_steps_agree(larger_mesh: VoronoiMesh, integrator: Integrator) -> None:
    model, state = random_model(without_cap(larger_mesh), seed=8)
    plain, fused = state.copy(), state.copy()
    plain_method(model, plain, integrator).advance(plain, 20.0, 3)
    for threads in (1, 2):
        numba.set_num_threads(threads)
        fused = state.copy()
        assert fused_method(model, integrator).advance(fused, 20.0, 3) == 3
        np.testing.assert_allclose(fused.thickness, plain.thickness, rtol=1e-12)
        np.testing.assert_allclose(fused.normal_velocity, plain.normal_velocity, rtol=0, atol=1e-10)

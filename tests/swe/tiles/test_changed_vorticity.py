"""Anticipation and upwinding in loops over tiles do what the plain loops do, on every family of meshes."""

import numba
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.discrete.walls import closed_mesh
from swe import ShallowWaterModel, Simulation, State
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.terms import Term
from swe.equations.upwinding import Upwinding
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.cutting import build_tiles
from swe.tiles.fused import FusedRungeKutta, why_not_fused
from tests.cut_mesh import without_cap
from tests.swe.random_model import RADIUS, random_model

ANTICIPATION, UPWINDING, BOTH = ("anticipation",), ("upwinding",), ("anticipation", "upwinding")
QUICK = [(ANTICIPATION, Ringler2010), (UPWINDING, Ringler2010)]
SLOW = [(BOTH, Ringler2010), (ANTICIPATION, Consistent), (UPWINDING, Consistent), (BOTH, Consistent)]
COMBINATIONS = pytest.mark.parametrize(
    ("names", "scheme"), [*QUICK, *(pytest.param(*each, marks=pytest.mark.slow) for each in SLOW)]
)
"""Terms and schemes; each combination is compiled by itself, for half a minute."""
TIME_STEP = 20.0


@pytest.fixture(params=[50, 10_000])
def few_or_many_tiles(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (request.param,))


def model_with(
    mesh: VoronoiMesh, names: tuple[str, ...], scheme: type[Scheme] = Ringler2010
) -> tuple[ShallowWaterModel, State]:
    scaled = closed_mesh(mesh.scaled(RADIUS))
    terms: dict[str, Term] = {"anticipation": Anticipation(scaled, 100.0), "upwinding": Upwinding(scaled, 0.4)}
    return random_model(mesh, *(terms[name] for name in names), seed=9, scheme=scheme)


def assert_tendencies_agree(mesh: VoronoiMesh, names: tuple[str, ...], scheme: type[Scheme]) -> None:
    if "anticipation" in names and mesh.dv_edge.min() < 1e-3 * mesh.dv_edge.max():
        pytest.skip("gradients along edges of no length have no meaning")
    model, state = model_with(mesh, names, scheme)
    expected, found, without = state.empty_like(), state.empty_like(), state.empty_like()
    model.tendency(state, expected)
    FusedRungeKutta(model).tendency(state, found)
    model_with(mesh, (), scheme)[0].tendency(state, without)
    largest = np.abs(expected.normal_velocity).max()
    np.testing.assert_allclose(found.normal_velocity, expected.normal_velocity, rtol=0, atol=1e-12 * largest)
    largest_h = np.abs(expected.thickness).max()
    np.testing.assert_allclose(found.thickness, expected.thickness, rtol=0, atol=1e-12 * largest_h)
    assert np.abs(expected.normal_velocity - without.normal_velocity).max() > 1e-4 * largest


@pytest.mark.slow
@COMBINATIONS
@pytest.mark.usefixtures("few_or_many_tiles")
def test_tendencies_agree(any_mesh: VoronoiMesh, names: tuple[str, ...], scheme: type[Scheme]) -> None:
    assert_tendencies_agree(any_mesh, names, scheme)


@COMBINATIONS
@pytest.mark.usefixtures("few_or_many_tiles")
def test_tendencies_agree_beside_walls(any_mesh: VoronoiMesh, names: tuple[str, ...], scheme: type[Scheme]) -> None:
    assert_tendencies_agree(without_cap(any_mesh), names, scheme)


@COMBINATIONS
def test_steps_agree_and_do_not_depend_on_threads(
    larger_mesh: VoronoiMesh, names: tuple[str, ...], scheme: type[Scheme], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (100,))
    model, start = model_with(larger_mesh, names, scheme)
    assert why_not_fused(model) is None
    results, available = [], numba.get_num_threads()
    for threads in (1, 2):
        numba.set_num_threads(threads)
        try:
            state = start.copy()
            assert FusedRungeKutta(model).advance(state, TIME_STEP, 3) == 3
        finally:
            numba.set_num_threads(available)
        results.append(state)
    assert np.array_equal(results[0].thickness, results[1].thickness)
    assert np.array_equal(results[0].normal_velocity, results[1].normal_velocity)
    plain = start.copy()
    RungeKutta(model.tendency, plain).advance(plain, TIME_STEP, 3)
    np.testing.assert_allclose(results[0].normal_velocity, plain.normal_velocity, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_runs_with_them_are_fused(small_mesh: VoronoiMesh) -> None:
    simulation = Simulation(small_mesh, Williamson5(), time_step=900.0, anticipation=0.5, upwinding=0.1)
    assert simulation.loops == "fused"
    state = simulation.state.copy()
    simulation.stepper.advance(simulation.state, 0.0, 1800.0, 900.0, 2)
    RungeKutta(simulation.model.tendency, state).advance(state, 900.0, 2)
    np.testing.assert_allclose(simulation.state.normal_velocity, state.normal_velocity, rtol=0, atol=1e-11)


def test_terms_derived_from_them_take_the_plain_loops(small_mesh: VoronoiMesh) -> None:
    class Other(Anticipation):
        """A term that may do anything."""

    model, _ = random_model(small_mesh, Other(small_mesh.scaled(RADIUS), 100.0), seed=9)
    assert why_not_fused(model) == "the tendency has the term anticipation"

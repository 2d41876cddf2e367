"""Terms that are added to the loops over tiles do what they do in the plain loops."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.discrete.walls import closed_mesh, wall_edges
from swe import Forcing, InputError, ShallowWaterModel, State, ThicknessRelaxation, Viscosity, WindStress
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.terms import Term
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.cutting import build_tiles
from swe.tiles.fused import FusedRungeKutta, why_not_fused
from tests.cut_mesh import without_cap
from tests.swe.random_model import RADIUS, random_model

STEP, DAY = 5.0, 86400.0


def gusts(mesh: VoronoiMesh, state: State, time: float) -> Array:
    """A function of all that a term may depend on, which counts for as much as the bracket."""
    return 1e-3 * np.sin(time / 15.0) * np.cos(mesh.lat_edge) + 1e-5 * state.normal_velocity


def rain(mesh: VoronoiMesh, state: State, time: float) -> Array:
    return 1e-2 * np.cos(time / 15.0) + 1e-5 * state.thickness


def forced(mesh: VoronoiMesh, *others: Term, scheme: type[Scheme] = Ringler2010) -> tuple[ShallowWaterModel, State]:
    terms = Forcing("gusts", gusts, rain), WindStress(0.5), Viscosity(1e5), ThicknessRelaxation(900.0, 1e4)
    return random_model(mesh, *terms, *others, seed=9, scheme=scheme)


@pytest.fixture(params=[50, 10_000], autouse=True)
def few_or_many_tiles(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (request.param,))


@pytest.mark.parametrize("scheme", [Ringler2010, Consistent])
@pytest.mark.parametrize("walls", [False, True])
def test_steps_are_those_of_the_plain_loops(any_mesh: VoronoiMesh, scheme: type[Scheme], walls: bool) -> None:
    model, state = forced(without_cap(any_mesh) if walls else any_mesh, scheme=scheme)
    still, _ = random_model(model.mesh, seed=9, scheme=scheme)
    assert why_not_fused(model) is None
    plain, fused, bare = (state.copy() for _ in range(3))
    assert RungeKutta(model.tendency, state).advance(plain, STEP, 3, DAY) == 3
    assert FusedRungeKutta(model).advance(fused, STEP, 3, DAY) == 3
    assert FusedRungeKutta(still).advance(bare, STEP, 3) == 3
    for found, expected, without in (
        (fused.thickness, plain.thickness, bare.thickness),
        (fused.normal_velocity, plain.normal_velocity, bare.normal_velocity),
    ):
        largest = np.abs(expected).max()
        # Short edges of random meshes amplify round-off.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * largest)
        assert np.abs(expected - without).max() > 1e-5 * largest
    assert not fused.normal_velocity[wall_edges(model.mesh)].any()


def test_the_tendency_has_the_terms(icosahedral_mesh: VoronoiMesh) -> None:
    """And what changes the potential vorticity, which the loops over tiles do."""
    anticipation = Anticipation(closed_mesh(icosahedral_mesh.scaled(RADIUS)), 100.0)
    model, state = forced(icosahedral_mesh, anticipation)
    expected, found = state.empty_like(), state.empty_like()
    model.tendency(state, expected, DAY)
    FusedRungeKutta(model).tendency(state, found, DAY)
    for one, other in ((found.thickness, expected.thickness), (found.normal_velocity, expected.normal_velocity)):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


def test_what_a_term_spoils_ends_the_steps(icosahedral_mesh: VoronoiMesh) -> None:
    """Also in the last stage, which comes after the loops have counted."""
    spoilt = Forcing("spoilt", source=lambda mesh, state, time: np.where(time > 14.0, np.nan, 0.0))
    model, state = random_model(icosahedral_mesh, spoilt, seed=9)
    method = FusedRungeKutta(model)
    assert method.advance(state, STEP, 5) == 3
    assert method.unsound > 0


class Twisting(Term):
    """A term that changes the potential vorticity in its own way."""

    name, meaning, changes = "twisting", "by twisting", ()

    def change_vorticity(self, state: State, potential_vorticity: Array, at_edges: Array) -> None:
        at_edges *= 1.01


def test_terms_that_change_the_vorticity_are_refused(icosahedral_mesh: VoronoiMesh) -> None:
    model, _ = forced(icosahedral_mesh, Twisting())
    with pytest.raises(InputError, match="the tendency has the term twisting, which the fused method lacks"):
        FusedRungeKutta(model)

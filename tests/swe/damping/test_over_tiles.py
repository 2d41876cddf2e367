"""Dissipation over tiles does what the plain loops do, on every family of meshes and beside walls."""

import numba
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh, mesh_from_points
from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from swe import Simulation, State
from swe.configuration import Integrator
from swe.damping import cutting
from swe.damping.cutting import cut_for_dissipation
from swe.damping.over_tiles import DissipationOverTiles, terms_over_tiles
from swe.equations.dissipation import BiharmonicDissipation
from swe.errors import InputError
from swe.run import simulation as simulation_module
from tests.cut_mesh import without_cap

RADIUS = 6.4e6


@pytest.fixture(params=[50, 10_000])
def few_or_many_tiles(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cut_for_dissipation, "__defaults__", (request.param,))


def changed(term: BiharmonicDissipation | DissipationOverTiles, velocity: Array) -> Array:
    """What is added to a velocity in a second."""
    state = State(np.ones(1), velocity.copy())
    term.apply(state, 1.0)
    return state.normal_velocity - velocity


def assert_equal_to_round_off(mesh: VoronoiMesh) -> None:
    mesh = mesh.scaled(RADIUS)
    velocity = np.random.default_rng(4).normal(size=mesh.n_edges)
    plain = BiharmonicDissipation(mesh, 1.0)
    plain.coefficient = 0.01 * plain.largest_time_step
    (tiled,) = terms_over_tiles(mesh, (plain,))
    assert isinstance(tiled, DissipationOverTiles)
    expected = changed(plain, velocity)
    np.testing.assert_allclose(changed(tiled, velocity), expected, rtol=0, atol=1e-14 * np.abs(velocity).max())
    assert np.abs(expected).max() > 1e-3
    assert not expected[wall_edges(mesh)].any()


def regular(mesh: VoronoiMesh) -> VoronoiMesh:
    if mesh.dv_edge.min() < 1e-3 * mesh.dv_edge.max():
        pytest.skip("edges of no length make it infinite")
    return mesh


@pytest.mark.usefixtures("few_or_many_tiles")
def test_it_equals_the_plain_form(any_mesh: VoronoiMesh) -> None:
    assert_equal_to_round_off(regular(any_mesh))


@pytest.mark.usefixtures("few_or_many_tiles")
def test_it_equals_the_plain_form_beside_walls(any_mesh: VoronoiMesh) -> None:
    assert_equal_to_round_off(without_cap(regular(any_mesh)))


def test_cells_in_no_order_give_the_same(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cut_for_dissipation, "__defaults__", (50,))
    points = icosahedral_mesh.cell_points
    assert_equal_to_round_off(mesh_from_points(points[np.random.default_rng(2).permutation(len(points))]))


def test_it_does_not_depend_on_threads(larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cut_for_dissipation, "__defaults__", (100,))
    mesh = larger_mesh.scaled(RADIUS)
    term = DissipationOverTiles(mesh, BiharmonicDissipation(mesh, 1e15))
    velocity, available, found = np.random.default_rng(4).normal(size=mesh.n_edges), numba.get_num_threads(), []
    for threads in (1, 2):
        numba.set_num_threads(threads)
        try:
            found.append(changed(term, velocity))
        finally:
            numba.set_num_threads(available)
    assert np.array_equal(*found)


def test_tiles_shrink_until_they_fit(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cut_for_dissipation(icosahedral_mesh).n_tiles == 1
    monkeypatch.setattr(cutting, "MIRROR", 800)
    smaller = cut_for_dissipation(icosahedral_mesh)
    assert smaller.n_tiles > 3
    assert sum(len(smaller.arrays[number]) for number in (0, 2)) > icosahedral_mesh.n_edges
    monkeypatch.setattr(cutting, "MIRROR", 5)
    with pytest.raises(InputError, match=r"dissipation at a cell needs the \d+ edges around it; the limit is 4"):
        cut_for_dissipation(icosahedral_mesh)


@pytest.mark.parametrize("integrator", ["rk4", "rrk4"])
def test_fused_runs_take_it(integrator: Integrator, small_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps differ from those of the plain loops in round-off, and those loops are not called."""
    ends = []
    for loops in ("plain", "fused"):
        with monkeypatch.context() as patch:
            if loops == "plain":
                patch.setattr(simulation_module, "terms_over_tiles", lambda mesh, terms: terms)
            else:
                patch.setattr(BiharmonicDissipation, "apply", None)
            simulation = Simulation(
                small_mesh, Williamson5(), time_step=1800.0, dissipation=1e17, integrator=integrator
            )
            simulation.run(0.25, progress=False)
            ends.append(simulation.state)
    np.testing.assert_allclose(ends[0].normal_velocity, ends[1].normal_velocity, rtol=0, atol=1e-11)
    without = Simulation(small_mesh, Williamson5(), time_step=1800.0, integrator=integrator)
    without.run(0.25, progress=False)
    assert np.abs(ends[1].normal_velocity - without.state.normal_velocity).max() > 1e-2

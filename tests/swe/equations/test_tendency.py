"""The kernels compute what the equation on sparse operators says, on every family of meshes."""

import numba
import numpy as np
import pytest

from mesh import VoronoiMesh, build_operators
from mesh.discrete.operators import vertex_to_cell
from swe import ShallowWaterModel, State
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.tendency import Energy, consistent, ringler2010, tendency
from swe.errors import InputError

GRAVITY = 9.8


EQUATIONS: dict[type[Scheme], Energy] = {Ringler2010: ringler2010, Consistent: consistent}
"""Kinetic energy and flux of each scheme as the plain statement has them."""


def random_setting(mesh: VoronoiMesh, scheme: type[Scheme] = Ringler2010) -> tuple[ShallowWaterModel, State]:
    random = np.random.default_rng(4)
    model = ShallowWaterModel(
        mesh.scaled(6.4e6),
        topography=random.uniform(0.0, 500.0, mesh.n_cells),
        coriolis=random.uniform(-1e-4, 1e-4, mesh.n_vertices),
        gravity=GRAVITY,
        scheme=scheme,
    )
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    return model, state


@pytest.mark.parametrize("scheme", EQUATIONS)
@pytest.mark.parametrize("threads", [1, 2])
def test_kernels_equal_the_equation(any_mesh: VoronoiMesh, threads: int, scheme: type[Scheme]) -> None:
    model, state = random_setting(any_mesh, scheme)
    operators = build_operators(model.mesh)
    expected = tendency(state, operators, model.topography, model.coriolis, GRAVITY, EQUATIONS[scheme])
    found = state.empty_like()
    available = numba.get_num_threads()
    numba.set_num_threads(threads)
    try:
        model.tendency(state, found)
    finally:
        numba.set_num_threads(available)
    for name in ("thickness", "normal_velocity"):
        size = np.abs(getattr(expected, name)).max()
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=2e-14 * size, rtol=0)
        assert size > 0.0


def test_energy_does_not_change_instantaneously(any_mesh: VoronoiMesh) -> None:
    model, state = random_setting(any_mesh)
    rate = state.empty_like()
    model.tendency(state, rate)
    mesh, h, u = model.mesh, state.thickness, state.normal_velocity
    kinetic_energy = model.diagnose(state).kinetic_energy
    by_thickness = mesh.area_cell * (kinetic_energy + GRAVITY * (h + model.topography)) * rate.thickness
    h_edge = h[mesh.cells_on_edge].mean(axis=1)
    by_velocity = mesh.dc_edge * mesh.dv_edge * h_edge * u * rate.normal_velocity
    total = by_thickness.sum() + by_velocity.sum()
    assert abs(total) < 1e-12 * (np.abs(by_thickness).sum() + np.abs(by_velocity).sum())
    assert abs(by_thickness.sum()) > 1e-6 * np.abs(by_thickness).sum()


def test_mass_and_absolute_vorticity_do_not_change(any_mesh: VoronoiMesh) -> None:
    model, state = random_setting(any_mesh)
    rate = state.empty_like()
    model.tendency(state, rate)
    mass = model.mesh.area_cell * rate.thickness
    circulation = model.mesh.area_triangle * (build_operators(model.mesh).curl @ rate.normal_velocity)
    for terms in (mass, circulation):
        assert abs(terms.sum()) < 1e-13 * np.abs(terms).sum()


def test_potential_vorticity_is_advected_compatibly(any_mesh: VoronoiMesh) -> None:
    """Where q is uniform, it stays so: the thickness at vertices and the vorticity change alike."""
    model, state = random_setting(any_mesh)
    operators = build_operators(model.mesh)
    uniform = 1e-7
    h_vertex = operators.cell_to_vertex @ state.thickness
    coriolis = uniform * h_vertex - operators.curl @ state.normal_velocity
    rate = tendency(state, operators, model.topography, coriolis, GRAVITY)
    vorticity_rate = operators.curl @ rate.normal_velocity
    expected = uniform * (operators.cell_to_vertex @ rate.thickness)
    scale = np.abs(rate.normal_velocity).max() * (model.mesh.dc_edge[model.mesh.edges_on_vertex].sum(1))
    assert (np.abs(vorticity_rate - expected) * model.mesh.area_triangle / scale).max() < 1e-12


def test_lake_at_rest_stays_at_rest(any_mesh: VoronoiMesh) -> None:
    model, _ = random_setting(any_mesh)
    state = State(5000.0 - model.topography, np.zeros(model.mesh.n_edges))
    rate = state.empty_like()
    model.tendency(state, rate)
    assert np.all(rate.thickness == 0.0)
    assert np.abs(rate.normal_velocity * model.mesh.dc_edge).max() < 1e-10


def test_wrong_fields_are_refused(icosahedral_mesh: VoronoiMesh) -> None:
    cells, vertices = np.zeros(642), np.zeros(1280)
    with pytest.raises(InputError, match=r"topography has shape \(1280,\), but the mesh needs \(642,\)"):
        ShallowWaterModel(icosahedral_mesh, vertices, vertices, GRAVITY)
    cells[3] = np.nan
    with pytest.raises(InputError, match="topography is nan at entity 3"):
        ShallowWaterModel(icosahedral_mesh, cells, vertices, GRAVITY)


def test_anticipation_is_what_the_operators_say(any_mesh: VoronoiMesh) -> None:
    """Q of -time (u . grad q)_e, with q at cells the kite-weighted mean and the tangential velocity from perp."""
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("gradients along edges of no length have no meaning")
    model, state = random_setting(any_mesh)
    mesh, coriolis = model.mesh, model.coriolis
    h, u = state.thickness, state.normal_velocity
    operators = build_operators(mesh)
    q = (coriolis + operators.curl @ u) / (operators.cell_to_vertex @ h)
    tail, head = mesh.vertices_on_edge.T
    q_along = (q[head] - q[tail]) / mesh.dv_edge
    q_across = operators.gradient @ vertex_to_cell(mesh, q)
    q_edge = -100.0 * (u * q_across + (operators.perp @ u) * q_along)
    flux = (operators.cell_to_edge @ h) * u
    expected = 0.5 * (q_edge * (operators.perp @ flux) + operators.perp @ (q_edge * flux))
    anticipation = Anticipation(mesh, 100.0)
    anticipating = ShallowWaterModel(mesh, model.topography, coriolis, model.gravity, terms=[anticipation])
    found = anticipating.tendency_of(anticipation, state).normal_velocity
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    with_it, without = state.empty_like(), state.empty_like()
    anticipating.tendency(state, with_it)
    model.tendency(state, without)
    difference = with_it.normal_velocity - without.normal_velocity
    np.testing.assert_allclose(difference, expected, rtol=0, atol=1e-12 * np.abs(without.normal_velocity).max())
    np.testing.assert_array_equal(with_it.thickness, without.thickness)

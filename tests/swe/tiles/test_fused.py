"""The fused step does what the plain one does, on every family of meshes, in any numbering, with any threads."""

import dataclasses
import os
import signal
import threading

import numba
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh, mesh_from_points, scvt_mesh
from swe import ShallowWaterModel, Simulation, State
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.errors import InputError, RunStopped
from swe.integrators import Integrator
from swe.run.composition import fused_method, plain_method
from swe.tiles import cutting as tiles
from swe.tiles.cutting import build_tiles
from swe.tiles.layout import RING

RADIUS = 6.4e6
TIME_STEP = 20.0


Method = tuple[type[Scheme], Integrator]


@pytest.fixture(params=[(Ringler2010, "rk4"), (Ringler2010, "fbrk3"), (Consistent, "rk4")], ids=str)
def method(request: pytest.FixtureRequest) -> Method:
    return request.param


@pytest.fixture(params=["rk4", "fbrk3"])
def integrator(request: pytest.FixtureRequest) -> Integrator:
    return request.param


def random_model(
    mesh: VoronoiMesh, prescribed_wind: bool = False, scheme: type[Scheme] = Ringler2010
) -> tuple[ShallowWaterModel, State]:
    random = np.random.default_rng(5)
    model = ShallowWaterModel(
        mesh.scaled(RADIUS),
        topography=random.uniform(0.0, 500.0, mesh.n_cells),
        coriolis=random.uniform(-1e-4, 1e-4, mesh.n_vertices),
        gravity=9.8,
        prescribed_wind=prescribed_wind,
        scheme=scheme,
    )
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    return model, state


def increments(model: ShallowWaterModel, state: State, integrator: Integrator, steps: int = 3) -> tuple[State, State]:
    """Change of the state in some steps, by the fused and by the plain path."""
    fused, plain = state.copy(), state.copy()
    fast, slow = fused_method(model, integrator), plain_method(model, plain, integrator)
    for _ in range(steps):
        slow.step(plain, TIME_STEP)
    assert fast.advance(fused, TIME_STEP, steps) == steps
    assert fast.unsound == 0
    return difference(fused, state), difference(plain, state)


def difference(one: State, other: State) -> State:
    return State(one.thickness - other.thickness, one.normal_velocity - other.normal_velocity)


def assert_equal_to_round_off(model: ShallowWaterModel, state: State, integrator: Integrator) -> None:
    found, expected = increments(model, state, integrator)
    for name in ("thickness", "normal_velocity"):
        value, change = getattr(state, name), getattr(expected, name)
        tolerance = 1e-14 * np.abs(value).max() + 1e-13 * np.abs(change).max()
        np.testing.assert_allclose(getattr(found, name), change, atol=tolerance, rtol=0)
        assert np.abs(change).max() > 1e3 * tolerance


def test_fused_step_equals_plain_step(any_mesh: VoronoiMesh, method: Method) -> None:
    scheme, integrator = method
    assert_equal_to_round_off(*random_model(any_mesh, scheme=scheme), integrator)


def test_fused_step_equals_plain_step_on_many_tiles(
    any_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch, method: Method
) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (60,))
    scheme, integrator = method
    model, state = random_model(any_mesh, scheme=scheme)
    assert fused_method(model, integrator).tiles.n_tiles == max(1, round(any_mesh.n_cells / 60))
    assert_equal_to_round_off(model, state, integrator)


def test_meshes_have_the_cells_that_the_loops_treat_apart(any_mesh: VoronoiMesh) -> None:
    sides = any_mesh.n_edges_on_cell
    assert sides.min() < RING
    if any_mesh.n_cells == 500:
        assert sides.max() > RING + 2


def test_a_mesh_in_any_numbering_gives_the_same(
    larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch, method: Method
) -> None:
    """Cells in no order at all: the tiles follow the curve, and the step puts the state into their order and back."""
    points = larger_mesh.cell_points
    shuffled = points[np.random.default_rng(2).permutation(len(points))]
    mesh = mesh_from_points(shuffled)
    monkeypatch.setattr(build_tiles, "__defaults__", (300,))
    # As in files of others: edges in another order than that of their lower cells.
    scheme, integrator = method
    model, state = random_model(_with_cells_shuffled(mesh), scheme=scheme)
    own_order = fused_method(model, integrator).tiles
    assert own_order.cell_order is not None
    assert own_order.edge_order is not None
    assert_equal_to_round_off(model, state, integrator)


def _with_cells_shuffled(mesh: VoronoiMesh) -> VoronoiMesh:
    """The same mesh with cells renumbered at random, edges and vertices left as they are."""
    order = np.random.default_rng(3).permutation(mesh.n_cells)
    rank = np.empty_like(order)
    rank[order] = np.arange(mesh.n_cells)
    changes = {
        name: getattr(mesh, name)[order]
        for name in (
            *("n_edges_on_cell", "edges_on_cell", "vertices_on_cell", "area_cell", "mesh_density"),
            *("x_cell", "y_cell", "z_cell", "lat_cell", "lon_cell"),
        )
    }
    changes["cells_on_cell"] = np.where(mesh.cells_on_cell < 0, -1, rank[mesh.cells_on_cell])[order].astype(np.int32)
    for name in ("cells_on_edge", "cells_on_vertex"):
        changes[name] = rank[getattr(mesh, name)].astype(np.int32)
    return dataclasses.replace(mesh, **changes)


def test_results_do_not_depend_on_threads(
    larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch, method: Method
) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (100,))
    scheme, integrator = method
    model, start = random_model(larger_mesh, scheme=scheme)
    results = []
    available = numba.get_num_threads()
    for threads in (1, 2):
        numba.set_num_threads(threads)
        try:
            state, stepper = start.copy(), fused_method(model, integrator)
            stepper.advance(state, TIME_STEP, 5)
        finally:
            numba.set_num_threads(available)
        results.append(state)
    assert np.array_equal(results[0].thickness, results[1].thickness)
    assert np.array_equal(results[0].normal_velocity, results[1].normal_velocity)
    assert not np.array_equal(results[0].thickness, start.thickness)


def test_a_prescribed_wind_stays(any_mesh: VoronoiMesh, integrator: Integrator) -> None:
    model, state = random_model(any_mesh, prescribed_wind=True)
    found, expected = increments(model, state, integrator)
    assert np.all(found.normal_velocity == 0.0)
    assert np.all(expected.normal_velocity == 0.0)
    np.testing.assert_allclose(found.thickness, expected.thickness, atol=2e-11, rtol=0)
    assert np.abs(expected.thickness).max() > 1e-3


def test_unsound_values_are_counted(icosahedral_mesh: VoronoiMesh, integrator: Integrator) -> None:
    model, state = random_model(icosahedral_mesh)
    stepper = fused_method(model, integrator)
    assert stepper.advance(state, TIME_STEP, 4) == 4
    assert stepper.unsound == 0
    state.thickness[7] = -5000.0
    assert stepper.advance(state, TIME_STEP, 4) == 1
    assert stepper.unsound >= 1
    state.normal_velocity[3] = np.nan
    assert stepper.advance(state, TIME_STEP, 4) == 1
    assert stepper.unsound > 1


def test_steps_at_once_equal_steps_one_by_one(icosahedral_mesh: VoronoiMesh, integrator: Integrator) -> None:
    model, start = random_model(icosahedral_mesh)
    stepper, singly = fused_method(model, integrator), start.copy()
    # More steps than there are arrays that change roles from step to step.
    for steps in range(1, 8):
        together = start.copy()
        assert stepper.advance(together, TIME_STEP, steps) == steps
        stepper.advance(singly, TIME_STEP)
        assert np.array_equal(together.thickness, singly.thickness), steps
        assert np.array_equal(together.normal_velocity, singly.normal_velocity), steps


def test_a_step_on_a_mesh_of_pentagons_alone_stays_within_its_scratch(integrator: Integrator) -> None:
    """Rings of five are filled up to six sides, and the scratch must have room for the sixth."""
    mesh = scvt_mesh(12)
    assert mesh.max_edges == 5
    model, state = random_model(mesh)
    most = fused_method(model, integrator).tiles.most
    assert most.sides >= RING * most.computed_cells
    assert_equal_to_round_off(model, state, integrator)


def test_every_edge_is_owned_by_the_tile_of_its_lower_cell(any_mesh: VoronoiMesh) -> None:
    model, _ = random_model(any_mesh)
    found = build_tiles(model.mesh, model.topography, model.coriolis, 9.8, 60)
    cells = np.arange(any_mesh.n_cells) if found.cell_order is None else found.cell_order
    edges = np.arange(any_mesh.n_edges) if found.edge_order is None else found.edge_order
    assert np.array_equal(np.sort(edges), np.arange(any_mesh.n_edges))
    rank = np.empty_like(cells)
    rank[cells] = np.arange(any_mesh.n_cells)
    lower = rank[any_mesh.cells_on_edge].min(axis=1)
    for tile in range(found.n_tiles):
        own = lower[edges[found.first_edge[tile] : found.first_edge[tile + 1]]]
        assert np.all((own >= found.first_cell[tile]) & (own < found.first_cell[tile + 1]))


def test_tiles_shrink_until_they_fit(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    model, _ = random_model(icosahedral_mesh)
    arguments = model.mesh, model.topography, model.coriolis, 9.8
    assert build_tiles(*arguments).n_tiles == 1
    monkeypatch.setattr(tiles, "MIRROR", 700)
    smaller = build_tiles(*arguments)
    assert smaller.n_tiles > 3
    assert smaller.most.edges <= 700
    monkeypatch.setattr(tiles, "MIRROR", 5)
    with pytest.raises(
        InputError, match=r"a cell of the mesh has .* edges around it and its neighbours; the limit is 5"
    ):
        build_tiles(*arguments)


def test_a_stop_comes_between_steps(larger_mesh: VoronoiMesh, integrator: Integrator) -> None:
    """Ctrl-C comes while the compiled loop runs: the clock must say what the state is."""
    simulation = Simulation(larger_mesh, Williamson5(), time_step=10.0, integrator=integrator)
    method, state = fused_method(simulation.model, integrator), simulation.state.copy()
    timer = threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(RunStopped, match=r"stopped by SIGINT at day .*; nothing is kept"):
        simulation.run(days=1000, progress=False)
    assert simulation.steps > 0
    assert simulation.time == 10.0 * simulation.steps
    method.advance(state, 10.0, simulation.steps)
    assert np.array_equal(state.thickness, simulation.state.thickness)
    assert np.array_equal(state.normal_velocity, simulation.state.normal_velocity)


def test_the_tendency_is_that_of_the_plain_path(any_mesh: VoronoiMesh, method: Method) -> None:
    scheme, integrator = method
    model, state = random_model(any_mesh, scheme=scheme)
    found, expected = state.empty_like(), state.empty_like()
    fused_method(model, integrator).tendency(state, found)
    model.tendency(state, expected)
    for name in ("thickness", "normal_velocity"):
        value = getattr(expected, name)
        np.testing.assert_allclose(getattr(found, name), value, rtol=0, atol=1e-12 * np.abs(value).max())


def test_the_border_of_a_tile_holds_the_edges_of_its_cells_that_others_own(any_mesh: VoronoiMesh) -> None:
    model, _ = random_model(any_mesh)
    found = build_tiles(model.mesh, model.topography, model.coriolis, 9.8, 60, with_border=True)
    cells = np.arange(any_mesh.n_cells) if found.cell_order is None else found.cell_order
    edges = np.arange(any_mesh.n_edges) if found.edge_order is None else found.edge_order
    for tile in range(found.n_tiles):
        own = cells[found.first_cell[tile] : found.first_cell[tile + 1]]
        of_own = np.isin(any_mesh.cells_on_edge, own).any(axis=1)
        of_own[edges[found.first_edge[tile] : found.first_edge[tile + 1]]] = False
        parts = found.index_parts[tile]
        border = (parts[-1] - parts[-2]) // 2
        first = found.halo_parts[tile, 1]
        np.testing.assert_array_equal(np.sort(edges[found.halo[first : first + border]]), np.flatnonzero(of_own))


def test_mass_stays_on_many_tiles(any_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    """What leaves a tile at its border enters the other, though both compute the velocity there."""
    monkeypatch.setattr(build_tiles, "__defaults__", (60,))
    model, state = random_model(any_mesh)
    area, before = model.mesh.area_cell, state.thickness.copy()
    assert fused_method(model, "fbrk3").advance(state, TIME_STEP, 20) == 20
    moved = area @ np.abs(state.thickness - before)
    assert abs(area @ (state.thickness - before)) < 1e-13 * moved

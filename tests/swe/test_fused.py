"""The fused step does what the plain one does, on every family of meshes, in any numbering, with any threads."""

import dataclasses

import numba
import numpy as np
import pytest

from mesh import VoronoiMesh, mesh_from_points
from swe import ShallowWaterModel, State
from swe.fused import FusedRungeKutta
from swe.tile_kernels import MIRROR, RING
from swe.tiles import build_tiles
from swe.time_stepping import RungeKutta

RADIUS = 6.4e6
TIME_STEP = 20.0


def random_model(mesh: VoronoiMesh, prescribed_wind: bool = False) -> tuple[ShallowWaterModel, State]:
    random = np.random.default_rng(5)
    model = ShallowWaterModel(
        mesh.scaled(RADIUS),
        topography=random.uniform(0.0, 500.0, mesh.n_cells),
        coriolis=random.uniform(-1e-4, 1e-4, mesh.n_vertices),
        gravity=9.8,
        prescribed_wind=prescribed_wind,
    )
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    return model, state


def increments(model: ShallowWaterModel, state: State, steps: int = 3) -> tuple[State, State]:
    """Change of the state in some steps, by the fused and by the plain path."""
    fused, plain = state.copy(), state.copy()
    fast, slow = FusedRungeKutta(model), RungeKutta(model.tendency, plain)
    for _ in range(steps):
        slow.step(plain, TIME_STEP)
    assert fast.advance(fused, TIME_STEP, steps) == steps
    assert fast.unsound == 0
    return difference(fused, state), difference(plain, state)


def difference(one: State, other: State) -> State:
    return State(one.thickness - other.thickness, one.normal_velocity - other.normal_velocity)


def assert_equal_to_round_off(model: ShallowWaterModel, state: State) -> None:
    found, expected = increments(model, state)
    for name in ("thickness", "normal_velocity"):
        value, change = getattr(state, name), getattr(expected, name)
        tolerance = 1e-14 * np.abs(value).max() + 1e-13 * np.abs(change).max()
        np.testing.assert_allclose(getattr(found, name), change, atol=tolerance, rtol=0)
        assert np.abs(change).max() > 1e3 * tolerance


def test_fused_step_equals_plain_step(any_mesh: VoronoiMesh) -> None:
    assert_equal_to_round_off(*random_model(any_mesh))


def test_fused_step_equals_plain_step_on_many_tiles(any_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build_tiles, "__defaults__", (60,))
    model, state = random_model(any_mesh)
    assert FusedRungeKutta(model).tiles.n_tiles == max(1, round(any_mesh.n_cells / 60))
    assert_equal_to_round_off(model, state)


def test_meshes_have_the_cells_that_the_loops_treat_apart(any_mesh: VoronoiMesh) -> None:
    sides = any_mesh.n_edges_on_cell
    assert sides.min() < RING
    if any_mesh.n_cells == 500:
        assert sides.max() > RING + 2


def test_a_mesh_in_any_numbering_gives_the_same(larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells in no order at all: the tiles follow the curve, and the step puts the state into their order and back."""
    points = larger_mesh.cell_points
    shuffled = points[np.random.default_rng(2).permutation(len(points))]
    mesh = mesh_from_points(shuffled)
    monkeypatch.setattr(build_tiles, "__defaults__", (300,))
    # As in files of others: edges in another order than that of their lower cells.
    model, state = random_model(_with_cells_shuffled(mesh))
    tiles = FusedRungeKutta(model).tiles
    assert tiles.cell_order is not None
    assert tiles.edge_order is not None
    assert_equal_to_round_off(model, state)


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


def test_results_do_not_depend_on_threads(larger_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("needs two processors")
    monkeypatch.setattr(build_tiles, "__defaults__", (100,))
    model, start = random_model(larger_mesh)
    results = []
    available = numba.get_num_threads()
    for threads in (1, 2):
        numba.set_num_threads(threads)
        try:
            state, stepper = start.copy(), FusedRungeKutta(model)
            stepper.advance(state, TIME_STEP, 5)
        finally:
            numba.set_num_threads(available)
        results.append(state)
    assert np.array_equal(results[0].thickness, results[1].thickness)
    assert np.array_equal(results[0].normal_velocity, results[1].normal_velocity)
    assert not np.array_equal(results[0].thickness, start.thickness)


def test_a_prescribed_wind_stays(any_mesh: VoronoiMesh) -> None:
    model, state = random_model(any_mesh, prescribed_wind=True)
    found, expected = increments(model, state)
    assert np.all(found.normal_velocity == 0.0)
    assert np.all(expected.normal_velocity == 0.0)
    np.testing.assert_allclose(found.thickness, expected.thickness, atol=2e-11, rtol=0)
    assert np.abs(expected.thickness).max() > 1e-3


def test_unsound_values_are_counted(icosahedral_mesh: VoronoiMesh) -> None:
    model, state = random_model(icosahedral_mesh)
    stepper = FusedRungeKutta(model)
    assert stepper.advance(state, TIME_STEP, 4) == 4
    assert stepper.unsound == 0
    state.thickness[7] = -5000.0
    assert stepper.advance(state, TIME_STEP, 4) == 1
    assert stepper.unsound >= 1
    state.normal_velocity[3] = np.nan
    assert stepper.advance(state, TIME_STEP, 4) == 1
    assert stepper.unsound > 1


def test_steps_at_once_equal_steps_one_by_one(icosahedral_mesh: VoronoiMesh) -> None:
    model, start = random_model(icosahedral_mesh)
    stepper, together, singly = FusedRungeKutta(model), start.copy(), start.copy()
    stepper.advance(together, TIME_STEP, 3)
    for _ in range(3):
        stepper.advance(singly, TIME_STEP)
    assert np.array_equal(together.thickness, singly.thickness)
    assert np.array_equal(together.normal_velocity, singly.normal_velocity)


def test_every_edge_is_owned_once_and_tiles_fit_their_indices(any_mesh: VoronoiMesh) -> None:
    model, _ = random_model(any_mesh)
    tiles = build_tiles(model.mesh, model.topography, model.coriolis, 9.8, 60)
    assert tiles.first_cell[-1] == any_mesh.n_cells
    assert tiles.first_edge[-1] == any_mesh.n_edges
    assert np.all(np.diff(tiles.first_edge) > 0)
    assert tiles.most.edges <= MIRROR
    assert tiles.indices.max() < MIRROR + tiles.most.edges

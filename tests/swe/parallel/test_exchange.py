"""Between stages the values of other processes arrive: two parts of a sphere give the bits of the whole."""

import threading
from collections.abc import Callable

import numpy as np
import pytest

from mesh import VoronoiMesh, mesh_from_points
from mesh.arrays import Array, Index
from mesh.parts.mesh_part import MeshPart, cut_part
from mesh.triangulation.ordering import inverse_order
from swe import ShallowWaterModel, State
from swe.equations.schemes import Ringler2010
from swe.integrators import Integrator
from swe.parallel.processes import OneProcess, Own
from swe.run.composition import fused_method, plain_method
from swe.stepping.steppers import Method
from swe.tiles import cutting
from swe.tiles.fused import FusedRungeKutta
from tests.swe.parallel.short_run import blocks_by_longitude

RADIUS = 6.4e6
STEPS = 3


class Turns:
    """Lets two threads compute in turns, as compiled loops of two cannot run at once, and meet where they exchange."""

    def __init__(self) -> None:
        self.turn = threading.Lock()
        self._meeting = threading.Barrier(2, timeout=60.0)

    def meet(self) -> None:
        self.turn.release()
        self._meeting.wait()
        self.turn.acquire()


class Meeting(OneProcess):
    """A process that is not alone; all of an exchange is in `exchange`, whatever the order of the values."""

    alone = False

    def exchange_in(self, cell_order: Index | None, edge_order: Index | None) -> Callable[[State], None]:
        def exchange(state: State) -> None:
            pair = (state.thickness, cell_order), (state.normal_velocity, edge_order)
            in_order = State(*(v.copy() if o is None else v[inverse_order(o)] for v, o in pair))
            self.exchange(in_order)
            for (values, order), arrived in zip(pair, (in_order.thickness, in_order.normal_velocity), strict=True):
                values[:] = arrived if order is None else arrived[order]

        return exchange


class Part(Meeting):
    """One of two processes: `own` cells and edges are computed here, what else its mesh has by the other."""

    def __init__(self, whole: State, part: MeshPart, turns: Turns) -> None:
        self._whole, self._cells, self._edges, self._turns = whole, part.cells, part.edges, turns
        self._own = part.own_cells, part.own_edges
        self.exchanges = 0

    def exchange(self, state: State) -> None:
        own_cells, own_edges = self._own
        self._whole.thickness[self._cells[own_cells]] = state.thickness[own_cells]
        self._whole.normal_velocity[self._edges[own_edges]] = state.normal_velocity[own_edges]
        self._turns.meet()
        state.thickness[:] = self._whole.thickness[self._cells]
        state.normal_velocity[:] = self._whole.normal_velocity[self._edges]
        self._turns.meet()
        self.exchanges += 1


def setting(mesh: VoronoiMesh) -> tuple[Array, Array, State]:
    random = np.random.default_rng(5)
    topography, coriolis = random.uniform(0.0, 500.0, mesh.n_cells), random.uniform(-1e-4, 1e-4, mesh.n_vertices)
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    return topography, coriolis, state


def fused(model: ShallowWaterModel, _: State, integrator: Integrator) -> Method:
    return fused_method(model, integrator)


@pytest.mark.parametrize(
    ("integrator", "build", "exchanges"),
    [
        ("rk4", fused, 4 * STEPS),
        ("rk4", plain_method, 4 * STEPS),
        ("fbrk3", fused, 1 + 3 * STEPS),
        ("fbrk3", plain_method, 6 * STEPS),
    ],
)
def test_two_parts_give_the_bits_of_the_whole(
    larger_mesh: VoronoiMesh,
    integrator: Integrator,
    build: Callable[[ShallowWaterModel, State, Integrator], Method],
    exchanges: int,
) -> None:
    def method(model: ShallowWaterModel, state: State) -> Method:
        return build(model, state, integrator)

    mesh = larger_mesh.scaled(RADIUS)
    topography, coriolis, start = setting(mesh)
    expected = start.copy()
    method(ShallowWaterModel(mesh, topography, coriolis, 9.8), expected).advance(expected, 20.0, STEPS)
    shared, turns = start.copy(), Turns()
    blocks = (mesh.lon_cell < np.pi).astype(int)
    parts, failures = [], []

    def run(block: int) -> None:
        with turns.turn:
            try:
                part = cut_part(mesh, blocks, block, Ringler2010.rings)
                process = Part(shared, part, turns)
                state = State(start.thickness[part.cells], start.normal_velocity[part.edges])
                model = ShallowWaterModel(
                    part.mesh, topography[part.cells], coriolis[part.vertices], 9.8, processes=process
                )
                assert (part.mesh.cells_on_edge < 0).any()
                assert method(model, state).advance(state, 20.0, STEPS) == STEPS
                parts.append(process)
            except BaseException as error:
                failures.append(error)
                turns._meeting.abort()
                raise

    threads = [threading.Thread(target=run, args=(block,)) for block in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
    assert [process.exchanges for process in parts] == [exchanges, exchanges]
    np.testing.assert_array_equal(shared.thickness, expected.thickness)
    np.testing.assert_array_equal(shared.normal_velocity, expected.normal_velocity)
    assert np.abs(expected.thickness - start.thickness).max() > 1e-3


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
def test_a_process_alone_takes_the_compiled_steps(icosahedral_mesh: VoronoiMesh, integrator: Integrator) -> None:
    """With an exchange that does nothing the stages are called one by one, and give the same bits."""

    class Idle(OneProcess):
        alone = False

    mesh = icosahedral_mesh.scaled(RADIUS)
    topography, coriolis, start = setting(mesh)
    states = []
    for processes in (OneProcess(), Idle()):
        state = start.copy()
        model = ShallowWaterModel(mesh, topography, coriolis, 9.8, processes=processes)
        assert fused_method(model, integrator).advance(state, 20.0, STEPS) == STEPS
        states.append(state)
    np.testing.assert_array_equal(states[0].thickness, states[1].thickness)
    np.testing.assert_array_equal(states[0].normal_velocity, states[1].normal_velocity)


def test_values_arrive_in_any_order_of_the_tiles(
    icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a shuffled mesh tiles have an order of their own; what arrives is told in the order of the mesh."""
    build = cutting.build_tiles
    monkeypatch.setattr("swe.tiles.fused.build_tiles", lambda *arguments, **options: build(*arguments, 60, **options))
    shuffled = mesh_from_points(
        np.random.default_rng(0).permutation(icosahedral_mesh.cell_points), density_name="shuffled"
    ).scaled(RADIUS)
    topography, coriolis, start = setting(shuffled)
    seen = []

    class Telling(Meeting):
        def exchange(self, state: State) -> None:
            seen.append(state.copy())
            state.thickness[0] = 1234.5

    model = ShallowWaterModel(shuffled, topography, coriolis, 9.8, processes=Telling())
    state, method = start.copy(), FusedRungeKutta(model)
    assert method.tiles.cell_order is not None
    method.advance(state, 20.0)
    assert state.thickness[0] == 1234.5
    assert len(seen) == 4
    alone = start.copy()
    FusedRungeKutta(ShallowWaterModel(shuffled, topography, coriolis, 9.8)).advance(alone, 20.0)
    far = np.abs(shuffled.cell_points @ shuffled.cell_points[0]) < 0.5 * RADIUS**2
    np.testing.assert_array_equal(seen[-1].thickness[far], alone.thickness[far])


class Fed(OneProcess):
    """A process to which others always send the same values at what it does not own."""

    alone = False

    def __init__(self, part: MeshPart, values: State) -> None:
        self.own = Own(part.own_cells, part.own_edges, part.own_vertices)
        self._part, self._values = part, values

    def exchange_in(self, cell_order: Index | None, edge_order: Index | None) -> Callable[[State], None]:
        assert cell_order is None
        cells, edges = self._part.halo_cells, self._part.halo_edges
        places = edges if edge_order is None else inverse_order(edge_order)[edges]

        def exchange(state: State) -> None:
            state.thickness[cells] = self._values.thickness[cells]
            state.normal_velocity[places] = self._values.normal_velocity[edges]

        return exchange


@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
def test_the_rim_that_nobody_sends_holds_no_values_from_before(
    icosahedral_mesh: VoronoiMesh, integrator: Integrator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tiles leave out some of it and read it all the same; memory may hold anything, here what is not a number."""
    mesh = icosahedral_mesh.scaled(RADIUS)
    topography, coriolis, start = setting(mesh)
    part = cut_part(mesh, blocks_by_longitude(mesh, 3), 0, Ringler2010.rings)
    state = State(start.thickness[part.cells], start.normal_velocity[part.edges])
    state.normal_velocity[(part.mesh.cells_on_edge < 0).any(axis=1)] = 0.0
    process = Fed(part, state.copy())
    model = ShallowWaterModel(part.mesh, topography[part.cells], coriolis[part.vertices], 9.8, processes=process)
    empty = np.empty
    with monkeypatch.context() as patch:
        patch.setattr(np, "empty", lambda *sizes, **types: filled(empty(*sizes, **types)))
        method = fused_method(model, integrator)
    assert method.advance(state, 20.0, STEPS) == STEPS
    assert np.isfinite(state.normal_velocity).all()


def filled(values: Array) -> Array:
    """`values`, all of which are not numbers if they can be."""
    if values.dtype.kind == "f":
        values.fill(np.nan)
    return values

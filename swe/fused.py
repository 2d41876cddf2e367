"""The fast path: classical RK4 whose stages are one pass over the tiles of the mesh each."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.model import ShallowWaterModel
from swe.state import State
from swe.tile_kernels import MIRROR, rk4_steps
from swe.tiles import Tiles, build_tiles


class FusedRungeKutta:
    """Advances a state by classical RK4; computes what `RungeKutta(model.tendency, state)` does, to round-off.

    `unsound` counts, after a step, the thicknesses that are not positive and the values that are not finite.
    """

    def __init__(self, model: ShallowWaterModel) -> None:
        self.tiles = build_tiles(model.mesh, model.topography, model.coriolis, model.gravity)
        self.model = model
        self._scratch = _scratch(self.tiles)
        cells, edges = model.mesh.n_cells, model.mesh.n_edges
        self._stages = [(np.empty(cells), np.empty(edges)) for _ in range(3)]
        self._unsound = np.zeros(self.tiles.n_tiles, np.int64)

    @property
    def unsound(self) -> int:
        """Number of values of the last step's result that no sound state has."""
        return int(self._unsound.sum())

    @property
    def bytes_per_step(self) -> int:
        """What a step must move, every array counted once for each stage that reads or writes it.

        The tiles are read in all four stages. States are read and written 2, 3, 3 and 4 times: each stage reads that at
        which it takes its slope and, after the first, the one at the start; the last reads those of all stages.
        """
        tiles = sum(array.nbytes for array in self.tiles.arrays)
        state = sum(array.nbytes for array in self._stages[0])
        return 4 * tiles + (2 + 3 + 3 + 4) * state

    def advance(self, state: State, time_step: float, steps: int = 1) -> int:
        """Advance `state` by `steps` steps of `time_step` seconds; gives how many, fewer where one went wrong.

        That is where `unsound` is not zero.
        """
        tiles, model = self.tiles, self.model
        h, u = _in_order(state.thickness, tiles.cell_order), _in_order(state.normal_velocity, tiles.edge_order)
        moving = not model.prescribed_wind
        done = rk4_steps(
            *(tiles.arrays, self._scratch, model.gravity, moving, (h, u), *self._stages),
            *(time_step, steps, self._unsound),
        )
        if tiles.cell_order is not None:
            state.thickness[tiles.cell_order] = h
        if tiles.edge_order is not None:
            state.normal_velocity[tiles.edge_order] = u
        return int(done)


def _in_order(values: Array, order: Index | None) -> Array:
    return values if order is None else values[order]


def _scratch(tiles: Tiles) -> tuple[Array, ...]:
    """A row for every thread there may be, of the size of the largest tile; untouched rows take no memory.

    In the order of the kernels: thickness, circulation and its mirror, potential vorticity, contributions to edges, and
    the tendencies of both.
    """
    most, threads = tiles.most, numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    sizes = (most.cells, MIRROR + most.edges, most.vertices, most.sides, most.computed_cells, most.own_edges)
    return tuple(np.zeros((threads, size)) for size in sizes)

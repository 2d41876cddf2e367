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

    The weights of the Coriolis flux are those of the kite areas, which `weights_on_edge` of files of others equal up to
    their noise. Topography and Coriolis parameter are taken from the model once, here.
    """

    def __init__(self, model: ShallowWaterModel) -> None:
        self.tiles = build_tiles(model.mesh, model.topography, model.coriolis, model.gravity)
        self.model = model
        self._scratch = _scratch(self.tiles)
        cells, edges = model.mesh.n_cells, model.mesh.n_edges
        self._stages = [(np.empty(cells), np.empty(edges)) for _ in range(3)]
        self._unsound = np.zeros(self.tiles.n_tiles, np.int64)
        self._taken = np.zeros(1, np.int64)

    def count_taken(self) -> int:
        """Number of steps that were taken since this was last asked."""
        taken = int(self._taken[0])
        self._taken[0] = 0
        return taken

    @property
    def unsound(self) -> int:
        """Number of thicknesses that are not positive and of values that are not finite after the last step."""
        return int(self._unsound.sum())

    @property
    def bytes_per_step(self) -> int:
        """What a step must move, every array counted once for each stage that reads or writes it.

        The tiles are read in all four stages. A stage needs 2, 3, 3 and 4 states: that at which it takes its slope,
        after the first also that at the start, and that which it writes; the last writes over the one at the start.
        """
        tiles = sum(array.nbytes for array in self.tiles.arrays)
        state = sum(array.nbytes for array in self._stages[0])
        return 4 * tiles + (2 + 3 + 3 + 4) * state

    def advance(self, state: State, time_step: float, steps: int = 1) -> None:
        """Advance `state` in place by `steps` steps of `time_step` seconds, fewer where one left `unsound` values.

        `count_taken` tells how many. Where Ctrl-C comes in the middle, all steps are taken before it is raised.
        """
        tiles, model = self.tiles, self.model
        h, u = _in_order(state.thickness, tiles.cell_order), _in_order(state.normal_velocity, tiles.edge_order)
        moving = not model.prescribed_wind
        try:
            rk4_steps(
                *(tiles.arrays, self._scratch, model.gravity, moving, (h, u), *self._stages),
                *(time_step, steps, self._taken, self._unsound),
            )
        finally:
            if tiles.cell_order is not None:
                state.thickness[tiles.cell_order] = h
            if tiles.edge_order is not None:
                state.normal_velocity[tiles.edge_order] = u


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

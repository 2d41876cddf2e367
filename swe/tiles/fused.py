"""The fast path: classical RK4 whose stages are one pass over the tiles of the mesh each."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.equations.model import ShallowWaterModel
from swe.errors import InputError
from swe.state import State
from swe.tiles import tile_kernels
from swe.tiles.cutting import Tiles, build_tiles


class FusedRungeKutta:
    """Advances a state by classical RK4; computes what `RungeKutta(model.tendency, state)` does, to round-off.

    The weights of the Coriolis flux are those of the kite areas, which `weights_on_edge` of files of others equal up to
    their noise. Topography and Coriolis parameter are taken from the model once, here. Raises `InputError` where the
    model anticipates potential vorticity, which the loops over tiles do not.
    """

    def __init__(self, model: ShallowWaterModel) -> None:
        if model.anticipation > 0.0:
            raise InputError(
                "the fused method does not anticipate potential vorticity; take RungeKutta(model.tendency, ...)"
            )
        self.tiles = build_tiles(model.mesh, model.topography, model.coriolis, model.gravity)
        self.model = model
        self._scratch = _scratch(self.tiles)
        cells, edges = model.mesh.n_cells, model.mesh.n_edges
        self._stages = [(np.empty(cells), np.empty(edges)) for _ in range(3)]
        self._unsound = np.zeros(self.tiles.n_tiles, np.int64)

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

    def advance(self, state: State, time_step: float, steps: int = 1) -> int:
        """Advance `state` in place by `steps` steps of `time_step` seconds, fewer where one left `unsound` values.

        Gives the number of steps taken.
        """
        tiles, model = self.tiles, self.model
        h, u = self._in_order(state)
        taken: int = tile_kernels.rk4_steps(
            *(tiles.arrays, self._scratch, model.gravity, not model.prescribed_wind, (h, u), *self._stages),
            *(time_step, steps, self._unsound),
        )
        self._put_back(h, u, state)
        return taken

    def tendency(self, state: State, result: State) -> None:
        """Write the time derivative of `state` into `result`, as the stages of a step take it."""
        tiles, model = self.tiles, self.model
        in_order = tiles.cell_order is None and tiles.edge_order is None
        slope = (result.thickness, result.normal_velocity) if in_order else self._stages[0]
        for values in slope:
            values.fill(0.0)
        moving, at = not model.prescribed_wind, self._in_order(state)
        tile_kernels.tendency(tiles.arrays, self._scratch, model.gravity, moving, at, slope, self._unsound)
        self._put_back(*slope, result)

    def _in_order(self, state: State) -> tuple[Array, Array]:
        """Thickness and velocity in the order of the tiles: the state's own arrays where that is their order."""
        tiles = self.tiles
        return _in_order(state.thickness, tiles.cell_order), _in_order(state.normal_velocity, tiles.edge_order)

    def _put_back(self, h: Array, u: Array, state: State) -> None:
        """Put values in the order of the tiles into `state`, unless they are its own arrays."""
        for values, order, target in (
            (h, self.tiles.cell_order, state.thickness),
            (u, self.tiles.edge_order, state.normal_velocity),
        ):
            if values is not target:
                target[slice(None) if order is None else order] = values


def _in_order(values: Array, order: Index | None) -> Array:
    return values if order is None else values[order]


def _scratch(tiles: Tiles) -> tuple[Array, ...]:
    """A row for every thread there may be, of the size of the largest tile; untouched rows take no memory.

    In the order of the kernels: thickness, circulation and its mirror, potential vorticity, contributions to edges, and
    the tendencies of both.
    """
    most, threads = tiles.most, numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    sizes = (
        most.cells,
        tile_kernels.MIRROR + most.edges,
        most.vertices,
        most.sides,
        most.computed_cells,
        most.own_edges,
    )
    return tuple(np.zeros((threads, size)) for size in sizes)

"""The fast path: methods whose stages are passes over the tiles of the mesh, and the first of them, classical RK4."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.kernels import count_unsound
from swe.equations.model import ShallowWaterModel
from swe.equations.schemes import Ringler2010
from swe.equations.terms import Term
from swe.equations.upwinding import Upwinding
from swe.errors import InputError
from swe.integrators import STEPPINGS, Integrator
from swe.parallel.processes import anywhere
from swe.state import State
from swe.tiles import tile_kernels
from swe.tiles.added_terms import AddedTerms
from swe.tiles.cutting import Tiles, build_tiles
from swe.tiles.layout import LANES, MIRROR

LAST = 1.0 / 6.0
"""Weight of the last slope in a step of RK4, which `tile_kernels.stage` gives to a stage of weight 0."""


def why_not_fused(model: ShallowWaterModel, integrator: Integrator = "rk4") -> str | None:
    """What the loops over tiles do not compute of a model, as part of a sentence; None if they compute all of it."""
    passes = STEPPINGS[integrator].forward_backward
    names = [term.name for term in model.terms_in_stages if passes or not (_in_loops(term) or _is_added(term))]
    if names:
        return f"the tendency has the term{'s' if len(names) > 1 else ''} {' and '.join(names)}"
    if isinstance(model.scheme, Consistent) and STEPPINGS[integrator].forward_backward:
        return f"the scheme is {model.scheme.name} and the integrator {integrator}"
    return None if isinstance(model.scheme, Ringler2010 | Consistent) else f"the scheme is {model.scheme.name}"


def _in_loops(term: Term) -> bool:
    """Whether the loops over tiles compute a term themselves."""
    return type(term) in (Anticipation, Upwinding)


def _is_added(term: Term) -> bool:
    """Whether a term is one to add to what the loops compute (`AddedTerms`): it changes no potential vorticity."""
    return type(term).change_vorticity is Term.change_vorticity


class FusedMethod:
    """What methods share whose stages are passes over tiles: the tiles, scratch, and the order of the state in them.

    The weights of the Coriolis flux follow from the kite areas; `weights_on_edge` in files from other programs equal
    them up to their noise. Topography and Coriolis parameter are taken from the model once, here. Raises `InputError`
    if the loops over tiles do not compute all of the model (`why_not_fused`).
    """

    def __init__(self, model: ShallowWaterModel, stages: int, plain_twin: str, with_border: bool = False) -> None:
        reason = why_not_fused(model, "fbrk3" if with_border else "rk4")
        if reason:
            raise InputError(f"{reason}, which the fused method lacks; take {plain_twin}")
        sides = model.scheme.sides if isinstance(model.scheme, Consistent) else None
        self.tiles = build_tiles(
            model.mesh,
            model.topography,
            model.coriolis,
            model.gravity,
            sides=sides,
            with_border=with_border,
            changed_vorticity=any(map(_in_loops, model.terms_in_stages)),
            own=model.processes.own,
            wall_slip=model.wall_slip,
        )
        self.model = model
        self._scratch = _scratch(self.tiles)
        self._parts = None if sides is None else _parts_of_flux(self.tiles)
        self._changed = _changed(model, self.tiles)
        self._added = AddedTerms(model, [term for term in model.terms_in_stages if _is_added(term)], self.tiles)
        cells, edges = model.mesh.n_cells, model.mesh.n_edges
        # Edges at the rim of a part are in no tile and keep their zeros.
        self._stages = [(np.zeros(cells), np.zeros(edges)) for _ in range(stages)]
        self._unsound = np.zeros(self.tiles.n_tiles, np.int64)
        self._fetch = model.processes.exchange_in(self.tiles.cell_order, self.tiles.edge_order)

    @property
    def _setting(self) -> tuple[object, ...]:
        """What every loop of `tile_kernels` takes first: the tiles, scratch, changes of vorticity, gravity, motion."""
        model = self.model
        return (
            *(self.tiles.arrays, self._scratch, self._parts, *self._changed),
            *(model.gravity, not model.prescribed_wind),
        )

    @property
    def unsound(self) -> int:
        """Number of non-finite values and non-positive thicknesses after the last step."""
        return int(self._unsound.sum())

    @property
    def bytes_per_step(self) -> int:
        """Bytes that a step must move, with every array counted once for each stage that reads or writes it."""
        raise NotImplementedError

    def advance(self, state: State, time_step: float, steps: int = 1, time: float = 0.0) -> int:
        """Advance `state` in place by `steps` steps of `time_step` seconds, fewer if one leaves `unsound` values.

        `time` is that of the state, s since the start. Returns the number of steps taken.
        """
        y = self._in_order(state)
        if self.model.processes.alone and not self._added:
            taken = self._steps(y, time_step, steps)
        else:
            taken = self._steps_by_stages(y, time_step, steps, time)
        self._put_back(*y, state)
        return taken

    def _steps(self, y: tuple[Array, Array], time_step: float, steps: int) -> int:
        """Advance y, in the order of the tiles, by up to `steps` steps; return how many were taken."""
        raise NotImplementedError

    def _steps_by_stages(self, y: tuple[Array, Array], time_step: float, steps: int, time: float) -> int:
        """The same from `time` on, with terms added to each stage, and an exchange of values between processes."""
        raise NotImplementedError

    def _exchange(self, pair: tuple[Array, Array]) -> None:
        """Fetch the values of other processes into a pair of thickness and velocity in the order of the tiles."""
        self._fetch(State(*pair))

    def _any_unsound(self, h: Array, u: Array) -> bool:
        """Whether any process finds unsound values in a state that has been exchanged.

        Where tiles found some they are counted again, as tiles also make values that another process computes, and make
        them wrong; and where terms were added after the tiles had counted.
        """
        count = count_unsound(h, u) if self._added or self._unsound.any() else 0
        self._unsound[:] = 0
        self._unsound[0] = anywhere(self.model.processes, count)
        return bool(self._unsound[0] > 0)

    def tendency(self, state: State, result: State, time: float = 0.0) -> None:
        """Write the time derivative of `state` into `result`, as the stages of a step use it at any `time`."""
        tiles = self.tiles
        in_order = tiles.cell_order is None and tiles.edge_order is None
        slope = (result.thickness, result.normal_velocity) if in_order else self._stages[0]
        for values in slope:
            values.fill(0.0)
        at = self._in_order(state)
        tile_kernels.tendency(*self._setting, at, slope, self._unsound)
        if self._added:
            self._added.evaluate(at, time)
            self._added.add(1.0, slope)
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


class FusedRungeKutta(FusedMethod):
    """Advances a state by classical RK4, with the same result as `RungeKutta(model.tendency, state)` to round-off."""

    def __init__(self, model: ShallowWaterModel) -> None:
        super().__init__(model, stages=3, plain_twin="RungeKutta(model.tendency, ...)")

    @property
    def bytes_per_step(self) -> int:
        """See `FusedMethod`.

        The tiles are read in all four stages. The stages need 2, 3, 3 and 4 states: the one at which the slope is
        taken, after the first stage also the initial one, and the one written; the last overwrites the initial one.
        """
        tiles = sum(array.nbytes for array in self.tiles.arrays)
        state = sum(array.nbytes for array in self._stages[0])
        return 4 * tiles + (2 + 3 + 3 + 4) * state

    def _steps(self, y: tuple[Array, Array], time_step: float, steps: int) -> int:
        taken: int = tile_kernels.rk4_steps(*self._setting, y, *self._stages, time_step, steps, self._unsound)
        return taken

    def _steps_by_stages(self, y: tuple[Array, Array], time_step: float, steps: int, time: float) -> int:
        """See `FusedMethod`; the stages are those of `rk4_steps`."""
        fixed, (second, third, fourth) = (*self._setting, y), self._stages
        stages = ((y, second, 0.0, 0.5), (second, third, 0.5, 0.5), (third, fourth, 0.5, 1.0), (fourth, y, 1.0, 0.0))
        for taken in range(1, steps + 1):
            begin = time + (taken - 1) * time_step
            for at, result, node, weight in stages:
                if self._added:
                    self._added.evaluate(at, begin + node * time_step)
                tile_kernels.stage(*fixed, at, second, third, result, time_step, weight, self._unsound)
                if self._added:
                    self._added.add((weight or LAST) * time_step, result)
                self._exchange(result)
            if self._any_unsound(*y):
                return taken
        return steps


def _in_order(values: Array, order: Index | None) -> Array:
    return values if order is None else values[order]


def _scratch(tiles: Tiles) -> tuple[Array, ...]:
    """One row per possible thread, sized for the largest tile; untouched rows take no memory.

    In the order that the kernels expect: thickness, circulation and its mirror, potential vorticity, contributions to
    edges, and the tendencies of thickness and velocity.
    """
    most, threads = tiles.most, numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    sizes = (
        most.cells + LANES,
        MIRROR + most.edges,
        most.vertices,
        most.sides,
        most.computed_cells + LANES,
        most.own_edges,
    )
    return tuple(np.zeros((threads, size)) for size in sizes)


def _parts_of_flux(tiles: Tiles) -> tuple[Array, ...]:
    """The same for schemes whose flux has parts: kinetic energy, and the parts of the flux."""
    most, threads = tiles.most, numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    return tuple(np.zeros((threads, size)) for size in (most.cells + LANES, most.flux_sides))


def _changed(model: ShallowWaterModel, tiles: Tiles) -> tuple[tuple[Array, ...] | None, float | None, float | None]:
    """Scratch, the seconds of anticipation and the factor of upwinding, None where there is no such term.

    The scratch is in the order of `swe.tiles.vorticity_loop`: twice the potential vorticity at sides, that of cells,
    the flows past sides, differences along them, and the circulations at them.
    """
    terms = model.terms_in_stages
    seconds = next((term.seconds for term in terms if isinstance(term, Anticipation)), None)
    factor = next((term.factor for term in terms if isinstance(term, Upwinding)), None)
    if seconds is None and factor is None:
        return None, None, None
    most, threads = tiles.most, numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    sizes = (most.sides, most.cells + LANES, most.sides, most.sides, most.sides)
    return tuple(np.zeros((threads, size)) for size in sizes), seconds, factor

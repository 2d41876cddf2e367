"""Descent on the clustering energy: Lloyd's method and Lloyd-preconditioned L-BFGS in one loop.

Both lower the energy E = sum_i of the integral of rho |x - x_i|^2 over Voronoi cell i (Du, Faber, Gunzburger 1999).
With m_i the mass of a cell and M_i its moment, the integral of x, the tangential gradient is that of
2 (m_i x_i - M_i); it vanishes where every generator is the constrained centroid M_i/|M_i| of its cell. Under uniform
density the energy never rises; under another one it is known to the error of its quadrature, within which L-BFGS lets
it rise where the slope says that it falls.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.density.named import Density, uniform
from mesh.errors import MeshError
from mesh.generation.lbfgs import PairMemory, all_dots, combine_and_move, move_all, new_pair
from mesh.generation.multilevel import MultilevelPreconditioner, preconditioner_on_sphere
from mesh.geometry.sphere import mean_spacing
from mesh.geometry.surface import UNIT_SPHERE, Surface
from mesh.integrals.moments import evaluate, number_of_blocks
from mesh.integrals.plane_moments import evaluate_in_plane
from mesh.integrals.weighted_moments import WeightedCells
from mesh.mesh_request import MeshRequest
from mesh.triangulation.moving import MovingCells, Triangulation

PAIRS = 7
"""Pairs that L-BFGS remembers."""

GAIN = 0.5
"""Weight of the coarse grids in the multilevel preconditioner."""

LARGEST_MOVE = 0.5
"""Largest displacement of a generator in one iteration, in mean spacings: longer moves tangle the triangulation."""

MAXIMUM_HALVINGS = 12
ARMIJO_FRACTION = 1e-4
RELATIVE_ROUND_OFF = 1e-13
"""Changes of energy smaller than this part of it are lost in round-off; then slopes decide on a step."""

RELATIVE_QUADRATURE_ERROR = 1e-4
"""The same under a density: kinks leave errors of this size in the energy that the gradient does not see."""

LEAST_CURVATURE = 0.25
"""Under a density, pairs with s.y below this part of s.s, over the number of cells, are not kept: quadrature gives
neutral motions, such as rotations of a symmetric density, a curvature of this size."""

WOLFE_FRACTION = 0.8

PATIENCE = 100
"""Iterations without a fall of energy or residual after which the descent counts as ended by round-off."""

PATIENCE_UNDER_DENSITY = 1000
"""The same under a density, where the energy may rise by its error for a while."""


@dataclass
class History:
    """What each iteration reached: energy (radian^2 steradian, m^4 in a plane), residual (mean spacings), seconds."""

    energy: list[float] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    @property
    def iterations(self) -> int:
        """Number of iterations, the starting points not counted."""
        return len(self.residual) - 1

    def followed_by(self, later: "History") -> "History":
        """What was reached here, and by a `later` descent that began at the last points."""
        seconds = [self.seconds[-1] + each for each in later.seconds[1:]]
        return History(self.energy + later.energy[1:], self.residual + later.residual[1:], self.seconds + seconds)


LARGEST_TOLERANCE = 10.0
"""Mean spacings; no generator is as far from its centroid."""


@dataclass(frozen=True)
class Limits:
    """When to stop: at a residual in mean spacings, or after so many iterations or seconds.

    A descent that the quadrature of the density ended above the tolerance still counts as converged where the residual
    is `acceptable`.
    """

    tolerance: float = 1e-8
    iterations: int = MeshRequest.max_iterations
    seconds: float = MeshRequest.max_seconds
    acceptable: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.tolerance <= LARGEST_TOLERANCE:
            raise MeshError(
                f"the tolerance is {self.tolerance:g} mean spacings; it must be positive, and {LARGEST_TOLERANCE:g} at "
                "most"
            )
        if not self.seconds >= 0.0:
            raise MeshError(f"the time allowed is {self.seconds:g} s; it must not be negative")

    def since(self, begin: float) -> "Limits":
        """These limits for the rest of work that began when `time.perf_counter` gave `begin`."""
        return replace(self, seconds=max(0.0, self.seconds - (time.perf_counter() - begin)))

    def reason_to_stop(self, history: History) -> str | None:
        """Which limit the last iteration reached: `tolerance`, `iterations` or `seconds`; None for none."""
        if history.residual[-1] <= self.tolerance:
            return "tolerance"
        if history.iterations >= self.iterations:
            return "iterations"
        return "seconds" if history.seconds[-1] >= self.seconds else None


@dataclass(frozen=True)
class ScvtResult:
    """Generators (n_cells, 3), their Delaunay triangles, the convergence history, and why the optimiser stopped.

    `reason` is `tolerance`, `iterations`, `seconds`, or what hides any further step: `round-off` or, under a density,
    `quadrature`. `fixed` (n_cells,) marks generators that were held.
    """

    points: Array
    triangles: Index
    history: History
    reason: str
    fixed: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class Iterate:
    """Where an optimiser stands: number of iterations, residual (mean spacings), energy, and points (n_cells, 3).

    The points are the optimiser's own; copy them to keep them.
    """

    number: int
    residual: float
    energy: float
    points: Array


Callback = Callable[[Iterate], None]
"""Called with the start and after each iteration."""


class _State:
    """Points with their energy, and gradient in Lloyd-scaled variables, plain and preconditioned."""

    def __init__(self, points: Array, preconditioned: bool) -> None:
        self.points = points.copy()
        self.gradient = np.empty_like(points)
        self.preconditioned = np.empty_like(points) if preconditioned else self.gradient
        self.scales = np.ones(len(points))
        self.energy = np.inf
        self.slope = 0.0
        self.residual = np.inf


class Optimizer:
    """Moves points (n, 3) on the unit sphere, or on another surface, towards an SCVT.

    `method` is `lbfgs` or `lloyd`, which is the same loop without a memory and without coarse grids. `triangles` may
    give a valid triangulation of the points. `density` is that of the mass, uniform if None; `fixed` (n,) marks
    generators that stay where they are. `cells` may give their cells, where these are not all of the sphere, and their
    mean `spacing` in lengths of the `surface`; coarse grids, which cover the whole sphere, only cost iterations there,
    so that these cells may have a `preconditioner` of their own. Results do not depend on the number of threads.
    """

    def __init__(
        self,
        points: Array,
        triangles: Index | None = None,
        method: str = MeshRequest.method,
        density: Density | None = None,
        fixed: NDArray[np.bool_] | None = None,
        cells: MovingCells | None = None,
        spacing: float | None = None,
        surface: Surface = UNIT_SPHERE,
        preconditioner: MultilevelPreconditioner | None = None,
    ) -> None:
        if method not in ("lbfgs", "lloyd"):
            raise MeshError(f"there is no optimisation method named '{method}'; choose lbfgs or lloyd")
        quasi_newton = method == "lbfgs"
        self._spacing = mean_spacing(len(points)) if spacing is None else spacing
        self._triangulation = Triangulation(points, triangles) if cells is None else cells
        self._surface, self._preconditioner = surface, preconditioner if quasi_newton else None
        if quasi_newton and cells is None:
            self._preconditioner = preconditioner_on_sphere(points, GAIN)
        coarse_grids = self._preconditioner is not None
        self._memory = PairMemory(PAIRS if quasi_newton else 0, len(points))
        self._current = _State(points, coarse_grids)
        self._trial = _State(points, coarse_grids)
        n_blocks = number_of_blocks(len(points))
        self._pair_partials = np.empty((n_blocks, 2 * (PAIRS + 1) + 1))
        self._cell_partials = np.empty((n_blocks, 3))
        self._gradient_square = 0.0
        self._fixed = fixed
        self._evaluate: Callable[..., None] = evaluate_in_plane if surface.is_flat else evaluate
        self._weighted = density is not None or fixed is not None
        self._noise, self._least_curvature = RELATIVE_ROUND_OFF, 0.0
        self._least_energy, self._patience = np.inf, PATIENCE
        if self._weighted:
            # Plateaus are sought on the whole sphere, as finely as the number of points asks if these cover it.
            often = cells is None or fixed is None
            self._evaluate = WeightedCells(density or uniform, len(points), fixed, often, surface).evaluate
            self._noise, self._least_curvature = RELATIVE_QUADRATURE_ERROR, LEAST_CURVATURE / len(points)
            self._patience = PATIENCE_UNDER_DENSITY

    def run(self, limits: Limits, callback: Callback | None = None) -> ScvtResult:
        """Iterate until a limit is reached, or until round-off or quadrature allow no further step."""
        history, begin = History(), time.perf_counter()
        self._evaluate_trial(self._memory.steps[0])
        self._accept_start()
        while True:
            state = self._current
            history.energy.append(state.energy)
            history.residual.append(state.residual)
            history.seconds.append(time.perf_counter() - begin)
            if callback is not None:
                callback(Iterate(history.iterations, state.residual, state.energy, state.points))
            reason = limits.reason_to_stop(history)
            if reason is None and (_stagnates(history, self._patience) or not self._step()):
                reason = "quadrature" if self._weighted else "round-off"
            if reason is not None:
                self._triangulation.update(state.points)
                return ScvtResult(state.points, self._triangulation.triangles, history, reason, self._fixed)

    def _step(self) -> bool:
        """One iteration; False if no step is left, not even down the gradient.

        Under a density, whose energy is known to the error of its quadrature only, a step of Lloyd's method is left.
        """
        if self._search_along_new_direction():
            return True
        self._memory.clear()
        if self._search_along_new_direction():
            return True
        if not self._weighted:
            return False
        slot = self._memory.spare_slot()
        self._memory.steps[slot] = -self._current.gradient.ravel()
        self._move(slot, 1.0)
        self._evaluate_trial(self._memory.steps[slot])
        self._accept(slot, 1.0)
        return True

    def _search_along_new_direction(self) -> bool:
        """Halve the step until it is acceptable, and take it; False if none is."""
        slot, slope, length = self._direction()
        for _ in range(MAXIMUM_HALVINGS):
            self._evaluate_trial(self._memory.steps[slot])
            if self._acceptable(slope, length):
                self._accept(slot, length)
                return True
            length *= 0.5
            self._move(slot, length)
        return False

    def _direction(self) -> tuple[int, float, float]:
        """Write a new direction to a spare slot and move the trial points; give the slot, the slope and the length."""
        memory, state = self._memory, self._current
        step_factors, change_factors, scale = memory.factors()
        slope = -scale * self._gradient_square
        slope -= float(step_factors @ memory.step_dots + change_factors @ memory.change_dots)
        if not slope < 0.0:
            memory.clear()
            step_factors, change_factors, scale = memory.factors()
            slope = -self._gradient_square
        slot = memory.spare_slot()
        largest = self._pair_partials[:, :1]
        combine_and_move(
            state.preconditioned.ravel(),
            memory.steps,
            memory.changes,
            memory.slots,
            scale,
            step_factors,
            change_factors,
            state.points,
            state.scales,
            1.0,
            slot,
            self._surface.is_flat,
            self._trial.points,
            largest,
        )
        length = 1.0
        move = np.sqrt(largest.max()) / self._spacing
        if move > LARGEST_MOVE:
            length = LARGEST_MOVE / move
            self._move(slot, length)
        return slot, slope, length

    def _move(self, slot: int, length: float) -> None:
        """Trial points at another length along the direction in `slot`."""
        state = self._current
        direction, is_flat = self._memory.steps[slot], self._surface.is_flat
        move_all(state.points, state.scales, direction, length, is_flat, self._trial.points)

    def _evaluate_trial(self, direction: Array) -> None:
        """Triangulation, energy and gradient at the trial points, and the slope along `direction` there."""
        state, triangulation = self._trial, self._triangulation
        triangulation.update(state.points, self._current.points)
        self._evaluate(
            state.points,
            triangulation.circumcenters,
            triangulation.ring_starts,
            triangulation.rings,
            direction.reshape(-1, 3),
            self._current.scales,
            state.gradient,
            state.scales,
            self._cell_partials,
        )
        state.energy = float(self._cell_partials[:, 0].sum())
        state.slope = float(self._cell_partials[:, 1].sum())
        state.residual = self._surface.to_centroid(float(self._cell_partials[:, 2].max())) / self._spacing

    def _acceptable(self, slope: float, length: float) -> bool:
        """Whether the energy falls (Armijo) or, where its error hides that, the slope does.

        The latter is the approximate Wolfe condition of Hager and Zhang (2005), equation (4.1); the energy must still
        stay within its error of the least one so far.
        """
        if self._trial.energy - self._current.energy <= ARMIJO_FRACTION * length * slope:
            return True
        ceiling = (1.0 + self._noise) * self._least_energy
        return self._trial.energy <= ceiling and self._trial.slope <= -WOLFE_FRACTION * slope

    def _accept_start(self) -> None:
        """Make the first evaluated points the current ones."""
        self._current, self._trial = self._trial, self._current
        self._precondition(self._current)
        self._memory.clear()
        self._least_energy = self._current.energy
        self._gradient_square = float(np.dot(self._current.gradient.ravel(), self._current.preconditioned.ravel()))

    def _accept(self, slot: int, length: float) -> None:
        """Make the trial points the current ones and remember the step in `slot`."""
        old, new, memory, partials = self._current, self._trial, self._memory, self._pair_partials
        self._precondition(new)
        new_pair(
            old.gradient.ravel(),
            old.preconditioned.ravel(),
            new.preconditioned.ravel(),
            memory.steps[slot],
            memory.changes[slot],
            length,
            partials,
        )
        old_step, old_change, step_step = partials[:, :3].sum(axis=0)
        old_dots = np.concatenate([memory.step_dots, [old_step], memory.change_dots, [old_change]])
        slots = np.append(memory.slots, slot)
        gradient, preconditioned = new.gradient.ravel(), new.preconditioned.ravel()
        all_dots(gradient, preconditioned, memory.steps, memory.changes, slots, partials)
        sums = partials[:, : 2 * len(slots) + 1].sum(axis=0)
        memory.update(slot, old_dots, sums[:-1], self._least_curvature * step_step)
        self._gradient_square = float(sums[-1])
        self._least_energy = min(self._least_energy, new.energy)
        self._current, self._trial = new, old

    def _precondition(self, state: _State) -> None:
        if self._preconditioner is not None:
            self._preconditioner.apply(state.gradient, state.preconditioned)
            if self._fixed is not None:
                state.preconditioned[self._fixed] = 0.0


def _stagnates(history: History, patience: int) -> bool:
    """Whether the last iterations lowered the energy by no more than round-off and the residual by less than half."""
    if history.iterations < patience:
        return False
    fall = history.energy[-1 - patience] - history.energy[-1]
    lost_in_round_off = fall <= RELATIVE_ROUND_OFF * history.energy[-1]
    return lost_in_round_off and min(history.residual[-patience:]) > 0.5 * min(history.residual[:-patience])

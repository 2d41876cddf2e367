"""Explicit Runge-Kutta methods from a Butcher tableau."""

from collections.abc import Callable
from dataclasses import dataclass

from swe.equations.kernels import add_scaled, count_unsound
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere
from swe.state import State

Tendency = Callable[[State, State, float], None]
"""Writes the time derivative of its first argument into its second; the third is the time, s."""


@dataclass(frozen=True)
class ButcherTableau:
    """An explicit method: `stages[i]` weights the earlier slopes in stage i, `weights` all slopes at the end."""

    stages: tuple[tuple[float, ...], ...]
    weights: tuple[float, ...]

    @property
    def nodes(self) -> tuple[float, ...]:
        """Times of the stages, as fractions of a step."""
        return tuple(sum(coefficients) for coefficients in self.stages)


RK4 = ButcherTableau(
    stages=((), (1 / 2,), (0.0, 1 / 2), (0.0, 0.0, 1.0)),
    weights=(1 / 6, 1 / 3, 1 / 3, 1 / 6),
)
"""The classical fourth-order method."""


class RungeKutta:
    """Advances a state in place with an explicit method; the slopes are allocated once.

    `processes` exchange values in a state before its slope is taken.
    `unsound` is the number of non-finite values and non-positive thicknesses after `advance`.
    """

    def __init__(
        self,
        tendency: Tendency,
        state: State,
        tableau: ButcherTableau = RK4,
        processes: Processes = ONE_PROCESS,
    ) -> None:
        self.tendency = tendency
        self.processes = processes
        self.tableau = tableau
        self.unsound = 0
        self._stage = state.empty_like()
        self._slopes = [state.empty_like() for _ in tableau.weights]

    def advance(self, state: State, time_step: float, steps: int = 1, time: float = 0.0) -> int:
        """Take up to `steps` steps from `time`, s, fewer if one leaves `unsound` values; return their number."""
        for taken in range(1, steps + 1):
            self.step(state, time_step, time + (taken - 1) * time_step)
            self.unsound = anywhere(self.processes, count_unsound(state.thickness, state.normal_velocity))
            if self.unsound:
                return taken
        return steps

    def step(self, state: State, time_step: float, time: float = 0.0) -> None:
        """Advance `state` by `time_step` seconds from `time`, s."""
        tableau = self.tableau
        for coefficients, node, slope in zip(tableau.stages, tableau.nodes, self._slopes, strict=True):
            stage = self._combine(state, time_step, coefficients, self._stage)
            if stage is not state:
                self.processes.exchange(stage)
            self.tendency(stage, slope, time + node * time_step)
        self._combine(state, time_step, tableau.weights, state)
        self.processes.exchange(state)

    def _combine(self, state: State, time_step: float, coefficients: tuple[float, ...], result: State) -> State:
        """Write state + dt sum_i c_i k_i into `result`; return `state` itself if all c_i vanish."""
        base = state
        for coefficient, slope in zip(coefficients, self._slopes, strict=False):
            if coefficient == 0.0:
                continue
            factor = time_step * coefficient
            add_scaled(base.thickness, factor, slope.thickness, result.thickness)
            add_scaled(base.normal_velocity, factor, slope.normal_velocity, result.normal_velocity)
            base = result
        return base

"""Forward-backward Runge-Kutta: in every stage thickness goes first, and velocity follows with the new thickness."""

from typing import Protocol

import numpy as np

from mesh.arrays import Array
from swe.equations.kernels import add_scaled, blend, count_unsound
from swe.integrators import FB_RK32, ForwardBackwardStage
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere
from swe.state import State


class Equations(Protocol):
    """Time derivatives of a state, each alone or both: `ShallowWaterModel`. The last argument is the time, s."""

    def tendency(self, state: State, result: State, time: float) -> None:
        """Write both into `result`."""

    def thickness_tendency(self, state: State, result: Array, time: float) -> None:
        """Write that of thickness into `result`."""

    def velocity_tendency(self, state: State, result: Array, time: float) -> None:
        """Write that of velocity into `result`."""


class ForwardBackward:
    """Advances a state in place by FB-RK(3,2) (`FB_RK32`).

    The slopes of a stage are taken at the time of the state that the stage before it left. `processes` exchange values
    in a state after each of its halves is new. `unsound` is the number of non-finite values and non-positive
    thicknesses after `advance`.
    """

    def __init__(self, equations: Equations, state: State, processes: Processes = ONE_PROCESS) -> None:
        self.tendency = equations.tendency
        self.processes = processes
        self.unsound = 0
        self._equations = equations
        # The last stage no longer needs the state that the first one left, and writes over it.
        first, second = state.empty_like(), state.empty_like()
        self._results = first, second, first
        self._slope = state.empty_like()
        self._blend = np.empty_like(state.thickness)

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
        at, now = state, time
        for stage, result in zip(FB_RK32, self._results, strict=True):
            self._take(stage, state, at, result, time_step, now)
            at, now = result, time + stage.fraction * time_step
        state.thickness[:] = at.thickness
        state.normal_velocity[:] = at.normal_velocity

    def _take(
        self, stage: ForwardBackwardStage, start: State, at: State, result: State, time_step: float, time: float
    ) -> None:
        """Write into `result` the state that a stage finds from `start`, with slopes at the state `at`."""
        factor, slope, blended = stage.fraction * time_step, self._slope, self._blend
        self._equations.thickness_tendency(at, slope.thickness, time)
        add_scaled(start.thickness, factor, slope.thickness, result.thickness)
        self.processes.exchange(State(result.thickness, at.normal_velocity))
        blend(stage.new, result.thickness, stage.last, at.thickness, stage.start, start.thickness, blended)
        self._equations.velocity_tendency(State(blended, at.normal_velocity), slope.normal_velocity, time)
        add_scaled(start.normal_velocity, factor, slope.normal_velocity, result.normal_velocity)
        self.processes.exchange(result)

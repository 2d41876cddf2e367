"""From one output time to the next: steps of equal length, or scaled by relaxation, and terms that act after steps."""

from collections.abc import Sequence
from typing import Protocol

from swe.equations.kernels import count_unsound, move_along
from swe.equations.terms import Term
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere
from swe.state import State
from swe.stepping.relaxation import Relaxation
from swe.stepping.schedule import equal_step, steps_towards

LANDINGS = 5
"""Attempts at a step whose scaled length ends at an output time; two suffice unless round-off blurs the factor."""

LANDED = 1e-10
"""Fraction of a step by which the last one may miss the output time that the clock shows."""


class Method(Protocol):
    """A Runge-Kutta method, forward-backward or not: a `FusedMethod` or its plain twin."""

    @property
    def unsound(self) -> int:
        """Number of non-finite values and non-positive thicknesses after the last step."""

    def advance(self, state: State, time_step: float, steps: int = 1, time: float = 0.0) -> int:
        """Take up to `steps` steps in place from `time`, s, fewer if one leaves `unsound` values; return how many."""


class Stepper(Protocol):
    """Advances a state in time."""

    @property
    def unsound(self) -> int:
        """Number of non-finite values and non-positive thicknesses after the last step."""

    def advance(self, state: State, time: float, event: float, time_step: float, most: int) -> tuple[float, int]:
        """Take up to `most` steps of about `time_step` seconds from `time` towards `event`, without passing it.

        Returns the time after them and their number.
        """


class FixedSteps:
    """Steps of equal length, except the last before an event, which may be shorter."""

    def __init__(self, method: Method) -> None:
        self._method = method

    @property
    def unsound(self) -> int:
        """Number of non-finite values and non-positive thicknesses after the last step."""
        return self._method.unsound

    def advance(self, state: State, time: float, event: float, time_step: float, most: int) -> tuple[float, int]:
        """See `Stepper`."""
        step, times = steps_towards(time, event, time_step, most)
        taken = self._method.advance(state, step, len(times), time)
        return times[taken - 1], taken


class AfterSteps:
    """The `terms` that act after steps; `processes` exchange the values that these change."""

    def __init__(self, terms: Sequence[Term], processes: Processes) -> None:
        self._terms, self._processes = terms, processes

    def apply(self, state: State, time_step: float, unsound: int) -> int:
        """Change `state` after a step that left it with `unsound` values; return how many it has now."""
        for term in self._terms:
            term.apply(state, time_step)
            self._processes.exchange(state)
            unsound = count_unsound(state.thickness, state.normal_velocity)
        return anywhere(self._processes, unsound)


class SplitMethod:
    """A method whose every step is followed by `terms`."""

    def __init__(self, method: Method, terms: Sequence[Term], processes: Processes = ONE_PROCESS) -> None:
        self._method = method
        self._after = AfterSteps(terms, processes)
        self.unsound = 0

    def advance(self, state: State, time_step: float, steps: int = 1, time: float = 0.0) -> int:
        """See `Method`."""
        for taken in range(1, steps + 1):
            self._method.advance(state, time_step, 1, time + (taken - 1) * time_step)
            self.unsound = self._after.apply(state, time_step, self._method.unsound)
            if self.unsound:
                return taken
        return steps


def followed_by(terms: Sequence[Term], method: Method, processes: Processes = ONE_PROCESS) -> Method:
    """The method itself if there are no `terms` that act after steps."""
    return SplitMethod(method, terms, processes) if terms else method


class RelaxedSteps:
    """Steps whose increments are scaled to conserve total energy, and the clock with them.

    The time left to an event is divided into equal steps, afresh after each. The `terms` act after each step.
    """

    def __init__(
        self,
        method: Method,
        relaxation: Relaxation,
        state: State,
        terms: Sequence[Term] = (),
        processes: Processes = ONE_PROCESS,
    ) -> None:
        self._method = method
        self._relaxation = relaxation
        self._terms = AfterSteps(terms, processes)
        self._after = state.empty_like()
        self.unsound = 0

    def advance(self, state: State, time: float, event: float, time_step: float, most: int) -> tuple[float, int]:
        """See `Stepper`."""
        taken = self.unsound = 0
        while taken < most and time < event and not self.unsound:
            time = self._step(state, time, event, time_step)
            taken += 1
        return time, taken

    def _step(self, state: State, time: float, event: float, time_step: float) -> float:
        """Take one step; return the time after it."""
        step = equal_step(time, event, time_step)
        factor = self._try(state, step, time)
        following = time + factor * step
        if step == event - time:
            factor, step = self._land(state, factor, step, time)
            following = event
        unsound = move_along(
            state.thickness, state.normal_velocity, self._after.thickness, self._after.normal_velocity, factor
        )
        self.unsound = self._terms.apply(state, factor * step, unsound)
        return following

    def _try(self, state: State, step: float, time: float) -> float:
        """Find the state after `step` seconds from `time`; return the factor that scales its increment."""
        self._after.thickness[:] = state.thickness
        self._after.normal_velocity[:] = state.normal_velocity
        self._method.advance(self._after, step, 1, time)
        return self._relaxation.factor(state, self._after)

    def _land(self, state: State, factor: float, remaining: float, time: float) -> tuple[float, float]:
        """Find, by the secant method, the step of scaled length `remaining` seconds; return its factor and length."""
        step, excess = remaining, factor * remaining - remaining
        following = remaining / factor
        for _ in range(LANDINGS):
            if abs(excess) <= LANDED * remaining:
                break
            before, excess_before, step = step, excess, following
            factor = self._try(state, step, time)
            excess = factor * step - remaining
            if excess != excess_before:
                following = step - excess * (step - before) / (excess - excess_before)
        return factor, step

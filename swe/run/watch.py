"""What watches a run from outside: callbacks on schedules, and a condition that ends it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesh.plain import plain_number
from mesh.shown import Rows, Shown, in_words
from swe.errors import InputError
from swe.stepping.schedule import ROUNDING


@dataclass(frozen=True, repr=False)
class Callback(Shown):
    """Calls `function` with the simulation after the first step that reaches each whole multiple of `interval` seconds.

    The function may read everything but must change nothing. Raises `InputError` if the interval is not positive.
    """

    function: Callable[[Any], object]
    interval: float

    def __post_init__(self) -> None:
        interval = plain_number("the interval of a callback", self.interval, InputError)
        if not 0.0 < interval < np.inf:
            raise InputError(f"the interval of a callback is {interval:g} s; it must be positive and finite")
        if not callable(self.function):
            raise InputError(f"a callback is {self.function!r}; it must be a function of the simulation")
        object.__setattr__(self, "interval", interval)

    def _title_and_rows(self) -> tuple[str, Rows]:
        return f"Callback of {in_words(self.function)}", {"interval": in_words(self.interval, "s")}


class Watch:
    """The callbacks and the stop condition of one call of `Simulation.run`, from `time`, seconds, on.

    Both are functions of the `swe.run.simulation.Simulation`.
    """

    def __init__(
        self,
        simulation: object,
        time: float,
        callbacks: Iterable[Callback],
        stop_when: Callable[[Any], bool] | None,
    ) -> None:
        self._simulation = simulation
        self._callbacks = list(callbacks)
        for callback in self._callbacks:
            if not isinstance(callback, Callback):
                raise InputError(f"a callback is {callback!r}; give swe.Callback(function, interval)")
        self._called = [self._count(callback, time) for callback in self._callbacks]
        self._stop_when = stop_when

    def most_steps(self, time: float, time_step: float) -> int:
        """Steps that may be taken at once without missing one that a callback or the stop condition must see."""
        if self._stop_when is not None:
            return 1
        waits = (
            ((called + 1) * callback.interval - time) / time_step
            for callback, called in zip(self._callbacks, self._called, strict=True)
        )
        return max(1, int(min(waits, default=2.0**31)))

    def call(self, time: float) -> None:
        """Call the callbacks that are due."""
        for number, callback in enumerate(self._callbacks):
            count = self._count(callback, time)
            if count > self._called[number]:
                self._called[number] = count
                callback.function(self._simulation)

    def is_over(self) -> bool:
        """Whether the stop condition holds."""
        return self._stop_when is not None and bool(self._stop_when(self._simulation))

    @property
    def reason(self) -> str:
        """The condition, in words."""
        return f"{getattr(self._stop_when, '__name__', 'the stop condition')} held"

    @staticmethod
    def _count(callback: Callback, time: float) -> int:
        """Multiples of the interval up to `time`."""
        return int(np.floor(time / callback.interval * (1.0 + ROUNDING)))

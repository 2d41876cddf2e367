"""When things happen in a run: at whole multiples of an interval, and at the end."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

ROUNDING = 1e-9
"""A step that would stop short of an event by less than this fraction of its length lands on the event."""

EXCESS = 0.01
"""Fraction of a step by which the steps before an event may together exceed the length asked for."""


@dataclass(frozen=True)
class Schedule:
    """Whole multiples of `interval` seconds up to and including `end` seconds, which is always an event.

    A multiple that differs from the end by round-off counts as the end.
    """

    interval: float
    end: float

    def next_after(self, time: float) -> float:
        """The first event later than `time`, seconds; infinity after the end."""
        if time >= self.end:
            return float("inf")
        count = np.floor(time / self.interval)
        while count * self.interval <= time:
            count += 1.0
        event = float(count * self.interval)
        return self.end if event > self.end - ROUNDING * self.interval else event

    def last_before_end(self) -> float:
        """The last event before the end, seconds; 0 if there is none."""
        count = np.floor(self.end / self.interval)
        while count > 0.0 and count * self.interval > self.end - ROUNDING * self.interval:
            count -= 1.0
        return float(count * self.interval)

    def ends_on_multiple(self) -> bool:
        """Whether the end is a whole multiple of the interval, to the last bit."""
        return self.end == float(np.round(self.end / self.interval) * self.interval)

    def is_due(self, time: float) -> bool:
        """Whether `time` is an event: the start, a multiple of the interval, or the end."""
        return time == 0.0 or time == self.end or time == np.round(time / self.interval) * self.interval


def last_shared(schedules: Sequence[Schedule]) -> float:
    """The last time, seconds, up to which a run with these schedules does the same as any longer run.

    That is its end if the end is a multiple of every interval. Otherwise it is the last event before: after that comes
    a step shortened to land on the end, or a record that a longer run does not write.
    """
    if all(schedule.ends_on_multiple() for schedule in schedules):
        return schedules[0].end
    return max(schedule.last_before_end() for schedule in schedules)


def step_towards(time: float, event: float, time_step: float) -> tuple[float, float]:
    """Length of the next step and the time after it: `time_step`, or less to land exactly on `event`."""
    remaining = event - time
    if remaining <= time_step * (1.0 + ROUNDING):
        return remaining, event
    return time_step, time + time_step


def steps_towards(time: float, event: float, time_step: float, most: int) -> tuple[float, list[float]]:
    """Length of the next steps and the time after each: as many steps of equal length as there are, up to `most`."""
    step, following = step_towards(time, event, time_step)
    times = [following]
    while len(times) < most and times[-1] < event:
        next_step, following = step_towards(times[-1], event, time_step)
        if next_step != step:
            break
        times.append(following)
    return step, times


def equal_step(time: float, event: float, time_step: float) -> float:
    """Length of the equal steps that divide the time left to `event`: about `time_step`, at most a hundredth more."""
    remaining = event - time
    return float(remaining / max(1.0, np.ceil(remaining / time_step - EXCESS)))


def dividing_step(limit: float, interval: float) -> float:
    """The largest time step not above `limit` that divides `interval`, seconds."""
    return float(interval / np.ceil(interval / limit * (1.0 - ROUNDING)))

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swe.stepping.schedule import Schedule, dividing_step, step_towards, steps_towards


def test_events_are_multiples_and_the_end() -> None:
    schedule = Schedule(interval=10.0, end=25.0)
    times, time = [], 0.0
    while time < 25.0:
        time = schedule.next_after(time)
        times.append(time)
    assert times == [10.0, 20.0, 25.0]
    assert schedule.next_after(25.0) == float("inf")
    assert [time for time in range(26) if schedule.is_due(float(time))] == [0, 10, 20, 25]


@given(interval=st.floats(1.0, 1e5), count=st.integers(1, 100_000), early=st.sampled_from([1e-9, 1e-3, 0.5]))
def test_an_event_is_not_passed_a_little_before_it(interval: float, count: int, early: float) -> None:
    """The step before an event may end a thousandth of a second before it, however long the run."""
    event = count * interval
    schedule = Schedule(interval, end=1e12)
    if event - early < event:
        assert schedule.next_after(event - early) == event
    assert schedule.next_after(event) == (count + 1) * interval


@given(tenths=st.integers(1, 100), hours=st.integers(1, 240))
def test_the_last_multiple_and_the_end_are_one_event(tenths: int, hours: int) -> None:
    interval, end = 0.05 * hours * 3600.0, 0.1 * tenths * 86400.0
    times, time = [], 0.0
    while time < end:
        time = Schedule(interval, end).next_after(time)
        times.append(time)
    assert np.diff(times, prepend=0.0).min() > 1.0


@given(interval=st.floats(1.0, 1e6), limit=st.floats(0.5, 1e4))
def test_dividing_step_divides_and_is_as_large_as_allowed(interval: float, limit: float) -> None:
    step = dividing_step(limit, interval)
    count = interval / step
    assert count == pytest.approx(round(count), abs=1e-6)
    assert step <= limit * (1 + 1e-8)
    assert round(count) == 1 or interval / (round(count) - 1) > limit * (1 - 1e-8)


@given(step=st.floats(1.0, 1000.0), interval=st.floats(1.0, 5000.0))
def test_steps_land_exactly_on_events(step: float, interval: float) -> None:
    time, count = 0.0, 0
    while time < interval:
        length, time = step_towards(time, interval, step)
        assert 0.0 < length <= step * (1 + 1e-8)
        count += 1
    assert time == interval
    assert count <= interval / step + 2


@given(step=st.floats(1.0, 1000.0), interval=st.floats(1.0, 5000.0), most=st.integers(1, 7))
def test_many_steps_at_once_are_those_taken_singly(step: float, interval: float, most: int) -> None:
    singly, time = [], 0.0
    while time < interval:
        length, time = step_towards(time, interval, step)
        singly.append((length, time))
    together: list[tuple[float, float]] = []
    while not together or together[-1][1] < interval:
        length, times = steps_towards(together[-1][1] if together else 0.0, interval, step, most)
        assert 1 <= len(times) <= most
        together += [(length, time) for time in times]
    assert together == singly

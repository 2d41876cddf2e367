"""Requests to stop that a run heeds at the end of a step."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from swe.errors import RunStopped

HEEDED = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Whether, and by which signal, the run was asked to stop."""

    def __init__(self) -> None:
        self.signal: signal.Signals | None = None
        self.heeded = False

    def note(self, number: int, _frame: FrameType | None) -> None:
        """Take note of a signal; at the second one, stop at once."""
        if self.signal is not None:
            self.heeded = True
            raise KeyboardInterrupt
        self.signal = signal.Signals(number)

    def raise_if_any(self, day: float, whereabouts: str) -> None:
        """Raise `RunStopped` if the run was asked to stop."""
        if self.signal is not None:
            self.heeded = True
            raise RunStopped(f"stopped by {self.signal.name} at day {day:.3f}; {whereabouts}", self.signal)


@contextmanager
def stop_requests() -> Iterator[StopRequest]:
    """Note Ctrl-C and SIGTERM within the context if this is the main thread; do nothing in any other.

    Signals that the program ignores stay ignored. One that was noted but not heeded is passed on at the end.
    """
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    before = {number: signal.getsignal(number) for number in HEEDED}
    heeded = [number for number, handler in before.items() if handler not in (signal.SIG_IGN, None)]
    for number in heeded:
        signal.signal(number, request.note)
    try:
        yield request
    finally:
        for number in heeded:
            signal.signal(number, before[number])
    if request.signal is not None and not request.heeded:
        signal.raise_signal(request.signal)

"""Requests to stop that a run heeds at the end of a step."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from swe.errors import RunStopped
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere

HEEDED = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Whether, and by which signal, the run was asked to stop, as far as all of its `processes` know."""

    def __init__(self, processes: Processes = ONE_PROCESS) -> None:
        self.signal: signal.Signals | None = None
        self.heeded = False
        self._processes = processes
        self._noted: signal.Signals | None = None

    def note(self, number: int, _frame: FrameType | None) -> None:
        """Take note of a signal; at the second one, stop at once."""
        if self._noted is not None:
            self.heeded = True
            raise KeyboardInterrupt
        self._noted = signal.Signals(number)

    def listen(self) -> None:
        """Learn of the signals that any process has noted until now."""
        number = anywhere(self._processes, 0 if self._noted is None else int(self._noted))
        self.signal = signal.Signals(number) if number else None

    def raise_if_any(self, day: float, whereabouts: str) -> None:
        """Raise `RunStopped` if the run was asked to stop."""
        if self.signal is not None:
            self.heeded = True
            raise RunStopped(f"stopped by {self.signal.name} at day {day:.3f}; {whereabouts}", self.signal)

    def pass_on(self) -> None:
        """Raise again, for whoever heeds it now, a signal that was noted here but not heeded."""
        if self._noted is not None and not self.heeded:
            signal.raise_signal(self._noted)


@contextmanager
def stop_requests(processes: Processes = ONE_PROCESS) -> Iterator[StopRequest]:
    """Note Ctrl-C and SIGTERM within the context if this is the main thread; do nothing in any other.

    Signals that the program ignores stay ignored. One that was noted but not heeded is passed on at the end.
    """
    request = StopRequest(processes)
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
    request.pass_on()

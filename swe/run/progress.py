"""The progress bar of a run: simulated days, days per minute of wall-clock time, Courant number."""

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

REFRESH_SECONDS = 0.1


class ProgressBar:
    """A context manager that draws on standard error if `visible`, and otherwise does nothing."""

    def __init__(self, first_day: float, last_day: float, visible: bool) -> None:
        self._progress = Progress(
            TextColumn("day {task.completed:.2f} of {task.total:g}"),
            BarColumn(),
            TextColumn("{task.fields[speed]:.1f} days/min"),
            TextColumn("Courant {task.fields[courant]:.2f}"),
            TimeRemainingColumn(),
            console=Console(stderr=True),
            disable=not visible,
        )
        self._task = self._progress.add_task("", total=last_day, speed=0.0, courant=float("nan"))
        self._progress.update(self._task, completed=first_day)
        self._first_day, self._last_day = first_day, last_day
        self._begin = self._shown = time.perf_counter()

    def __enter__(self) -> "ProgressBar":
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def update(self, day: float) -> None:
        """Show the simulated `day`, ten times a second at most."""
        now = time.perf_counter()
        if now - self._shown < REFRESH_SECONDS and day < self._last_day:
            return
        self._shown = now
        minutes = max(now - self._begin, 1e-9) / 60.0
        self._progress.update(self._task, completed=day, speed=(day - self._first_day) / minutes)

    def show_courant_number(self, courant: float) -> None:
        """Show the Courant number of the present state."""
        self._progress.update(self._task, courant=courant)

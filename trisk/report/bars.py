"""Progress bars."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from mesh.generation.optimizer import Callback, Iterate


@contextmanager
def convergence_bar(tolerance: float, visible: bool) -> Iterator[Callback]:
    """Give a callback that shows how close the residual has come to `tolerance`, on a logarithmic scale."""
    columns = (
        TextColumn("mesh: iteration {task.fields[iteration]}"),
        BarColumn(),
        TextColumn("residual {task.fields[residual]:.1e} of {task.fields[tolerance]:.0e} spacings"),
        TimeElapsedColumn(),
    )
    first = math.nan
    progress = Progress(*columns, console=Console(stderr=True), disable=not visible)
    task = progress.add_task("", total=1.0, iteration=0, residual=math.nan, tolerance=tolerance)
    try:

        def show(iterate: Iterate) -> None:
            nonlocal first
            progress.start()  # at the first iterate, so that a refused request shows no bar
            residual = iterate.residual
            first = max(residual, 2.0 * tolerance) if math.isnan(first) else first
            way = math.log(first / max(residual, 1e-300)) / math.log(first / tolerance)
            progress.update(task, completed=min(max(way, 0.0), 1.0), iteration=iterate.number, residual=residual)

        yield show
    finally:
        progress.stop()


@contextmanager
def bars_of_parts(visible: bool) -> Iterator[Callable[[str, float], None]]:
    """Give a callback that takes the name of a task and the fraction done, 0 to 1; a new name adds a bar."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), disable=not visible) as progress:
        tasks: dict[str, TaskID] = {}

        def show(what: str, part: float) -> None:
            if what not in tasks:
                tasks[what] = progress.add_task(what, total=1.0)
            progress.update(tasks[what], completed=part)

        yield show

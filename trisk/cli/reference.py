"""`trisk reference`: solutions by the spectral model, with progress."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from cases.base import Case
from postprocess.reference.making import MEASURES, REFERENCE_DAYS, Reference, make_reference
from postprocess.reference.reference_file import write_reference
from trisk.cli.outputs import require_possible_file


def make(
    case: Case, days: Sequence[float], truncation: int, damping_hours: float, output: Path, history: str, quiet: bool
) -> None:
    """Run the spectral model, write the reference and print how its truncations differ."""
    require_possible_file(output)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), disable=quiet) as progress:
        tasks = {}

        def show(what: str, part: float) -> None:
            if what not in tasks:
                tasks[what] = progress.add_task(what, total=1.0)
            progress.update(tasks[what], completed=part)

        chosen = tuple(sorted(days)) or REFERENCE_DAYS.get(case.name, (case.recommended_days,))
        reference = make_reference(case, chosen, truncation, damping_hours, history, show)
    write_reference(reference, output)
    if not quiet:
        _print_differences(reference)


def _print_differences(reference: Reference) -> None:
    finest = reference.truncations[-1]
    table = Table(title=f"{reference.case.title}: relative l2 norms of the difference from T{finest}")
    for column in ("truncation", "day", *MEASURES):
        table.add_column(column, justify="right")
    for truncation, by_day in zip(reference.truncations[:-1], reference.differences, strict=True):
        for day, norms in zip(reference.days, by_day, strict=True):
            table.add_row(f"T{truncation}", f"{day:g}", *(f"{norm:.2e}" for norm in norms))
    Console().print(table)

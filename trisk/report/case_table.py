"""What `trisk cases` prints: all cases, or the parameters of one."""

from collections.abc import Iterable

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cases import Case
from cases.parameters import units_and_meanings


def print_cases(cases: Iterable[Case]) -> None:
    """Print one row for each case."""
    table = Table("name", "what it is", "days", "exact", "order", "reference", title="Test cases")
    table.columns[1].overflow = "fold"
    for case in cases:
        authors_and_year = case.reference.partition(",")[0]
        table.add_row(case.name, case.title, f"{case.recommended_days:g}", *_accuracy(case), authors_and_year)
    console = Console()
    console.print(table)
    console.print("trisk cases NAME lists the parameters of one, for trisk run NAME --set PARAMETER=VALUE")


def print_case(case: Case) -> None:
    """Print a description of `case`, and its parameters with values, units and meanings."""
    exact, order = _accuracy(case)
    console = Console()
    console.print(escape(case.title), style="bold")
    if case.reference:
        console.print(escape(case.reference))
    console.print(f"recommended days: {case.recommended_days:g}; exact solution: {exact}; order: {order}")
    table = Table("parameter", "default", "units", "meaning", title=f"Parameters of {escape(case.name)}")
    described = units_and_meanings(case)
    for name, value in case.parameters().items():
        table.add_row(name, escape(_in_words(value)), *map(escape, described[name]))
    console.print(table)


def _in_words(value: object) -> str:
    """A value as a user may type it; in a user's own case it may be anything."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.10g}" if isinstance(value, float | int) else str(value)


def _accuracy(case: Case) -> tuple[str, str]:
    """Whether there is an exact solution, and the accepted order of convergence."""
    order = case.convergence_order
    return "yes" if case.has_exact_solution else "no", "-" if order is None else f"{order:g}"

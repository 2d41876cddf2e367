"""What `trisk compare` prints: what was found, error norms and conservation."""

import typer
from rich.console import Console
from rich.table import Table

from postprocess.compare.comparison import SHOWN_DIAGNOSTICS, Comparison, in_scientific_notation
from postprocess.reports.sentences import Verdict

FIELD_LABELS = {
    "thickness": "thickness",
    "velocity": "velocity",
    "normal_velocity": "normal velocity",
    "vorticity": "vorticity",
}


def print_verdict(verdict: Verdict) -> None:
    """Print what was found, a sentence a line; a narrow terminal wraps them."""
    for sentences in verdict.values():
        for sentence in sentences:
            typer.echo(sentence)


def print_comparison(comparison: Comparison) -> None:
    """Print the norms of all runs on all days, and how far conserved quantities have changed by then."""
    console = Console()
    console.print(_norms_table(comparison))
    console.print(_conservation_table(comparison))


def _norms_table(comparison: Comparison) -> Table:
    title = f"{comparison.case}: error norms, reference: {comparison.solution.name}"
    table = _table(title, "day", "run", "cells", "field", "l1", "l2", "linf")
    for entry in comparison.entries:
        beginning = (f"{entry.day:g}", str(entry.run.directory), str(entry.run.mesh.n_cells))
        for field, norms in entry.norms.items():
            values = (in_scientific_notation(value) for value in (norms.l1, norms.l2, norms.linf))
            table.add_row(*beginning, FIELD_LABELS[field], *values)
            beginning = ("", "", "")
        table.add_section()
    if known := [_uncertainty(comparison, day) for day in comparison.days if comparison.solution.uncertainty(day)]:
        table.caption = "uncertainty of the reference (l2), " + "; ".join(known)
    return table


def _uncertainty(comparison: Comparison, day: float) -> str:
    of_fields = comparison.solution.uncertainty(day).items()
    return f"day {day:g}: " + ", ".join(f"{field} {in_scientific_notation(value)}" for field, value in of_fields)


def _conservation_table(comparison: Comparison) -> Table:
    changes = ("mass", "energy", "enstrophy", "vorticity")
    title = "Changes since the start: mass, available energy, potential enstrophy, absolute vorticity"
    table = _table(title, "day", "run", *changes, "max m/s")
    for entry in comparison.entries:
        *values, speed = (entry.conservation[name] for name in SHOWN_DIAGNOSTICS)
        shown = (f"{value:+.1e}" for value in values)
        table.add_row(f"{entry.day:g}", str(entry.run.directory), *shown, f"{speed:.4g}")
    return table


def _table(title: str, *columns: str) -> Table:
    """A table whose second column, the directories, wraps on a narrow terminal."""
    table = Table(*columns, title=title)
    for column in table.columns:
        column.no_wrap = True
    table.columns[1].no_wrap = False
    table.columns[1].overflow = "fold"
    return table

"""What `trisk quality --table1` prints: our qualities above the published ones."""

from pathlib import Path

from rich.console import Console
from rich.table import Table

from postprocess.studies.table1 import (
    PUBLISHED_BISECTION,
    PUBLISHED_SCVT,
    UNIFORM_TOLERANCE,
    Row,
    measures,
    table1,
)
from postprocess.studies.table1_page import write_table1_page


def print_table1(max_level: int, output: Path | None) -> None:
    """Compute and print Table 1 up to `max_level`; with `output`, write a page to that folder as well."""
    console = Console(width=150)
    table = Table("level", "cells", "", "bisection", "SCVT", "residual", "seconds")
    for column in table.columns:
        column.no_wrap = True

    def add(row: Row) -> None:
        ours = (" ".join(f"{value:.4f}" for value in measures(quality)) for quality in (row.bisection, row.scvt))
        published = (PUBLISHED_BISECTION[row.level], PUBLISHED_SCVT[row.level])
        theirs = (" ".join(f"{value:.4f}" for value in values) for values in published)
        residual, seconds = f"{row.scvt.residual:.1e}", f"{row.seconds:.1f}"
        table.add_row(str(row.level), str(row.scvt.cells), "ours", *ours, residual, seconds)
        table.add_row("", "", "published", *theirs, "", "", end_section=True)
        Console(stderr=True).print(f"level {row.level}: {row.scvt.cells} cells, residual {residual}")

    rows = table1(max_level, UNIFORM_TOLERANCE, add)
    console.print(table)
    if output is not None:
        console.print(str(write_table1_page(output, rows)))

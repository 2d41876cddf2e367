"""What commands print: progress of the mesh generation, and tables of results."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from mesh import VoronoiMesh
from mesh.discrete.quality import quality_and_note
from mesh.generation.optimizer import Callback, Iterate
from swe.output.files import DIAGNOSTICS_FILE, load_record, read_series


@contextmanager
def convergence_bar(tolerance: float, visible: bool) -> Iterator[Callback]:
    """Give a callback that shows how far the residual has come down, on a logarithmic scale, to `tolerance`."""
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
            progress.start()  # with the first iterate, so that what is refused shows no bar
            residual = iterate.residual
            first = max(residual, 2.0 * tolerance) if math.isnan(first) else first
            way = math.log(first / max(residual, 1e-300)) / math.log(first / tolerance)
            progress.update(task, completed=min(max(way, 0.0), 1.0), iteration=iterate.number, residual=residual)

        yield show
    finally:
        progress.stop()


def print_quality(mesh: VoronoiMesh, name: str) -> None:
    """Print the quality of `mesh` as a table."""
    measured, note = quality_and_note(mesh)
    known = "unknown" if math.isnan(measured.residual) else f"{measured.residual:.2e} mean spacings"
    rows = [
        ("cells", str(measured.cells)),
        ("largest / smallest neighbour distance (mu)", f"{measured.mu:.6f}"),
        ("mean of shortest / longest distance (sigma_avg)", f"{measured.sigma_avg:.6f}"),
        ("smallest of those (sigma_min)", f"{measured.sigma_min:.6f}"),
        ("mean triangle quality (q_avg)", f"{measured.q_avg:.6f}"),
        ("smallest triangle quality (q_min)", f"{measured.q_min:.6f}"),
        ("distance to the centroids, at most (residual)", known),
        *([("on the residual", note)] if note else []),
        ("obtuse triangles", str(measured.obtuse)),
        ("largest / smallest cell area", f"{measured.area_ratio:.6f}"),
    ]
    _print_table(f"Quality of {name}", rows)


def print_table1(max_level: int, output: Path | None) -> None:
    """Make Table 1 up to `max_level` and print it; with `output`, write the page on mesh generation there too."""
    from postprocess.pages.mesh_page import UNIFORM_TOLERANCE, write_page
    from postprocess.pages.table1 import PUBLISHED_BISECTION, PUBLISHED_SCVT, Row, measures, table1

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
        console.print(str(write_page(output, rows, lambda line: Console(stderr=True).print(line))))


def print_run(directory: Path) -> None:
    """Print the summary of a finished run as a table, and where its files are."""
    record = load_record(directory)
    series = read_series(directory / DIAGNOSTICS_FILE)
    last = {name: float(values[-1]) for name, values in series.items()}
    rows = [
        ("status", record["status"]),
        ("cells, threads", f"{record['cells']}, {record['threads']}"),
        ("day reached", f"{record['day_reached']:g}"),
        ("time step, steps", f"{record['configuration']['time_step']:g} s, {record['steps']}"),
        ("wall-clock time", f"{record['wall_seconds']:.1f} s"),
        ("Courant number", f"{last['courant_number']:.2f}"),
        ("largest speed", f"{last['max_speed']:.2f} m/s"),
        ("change of mass", f"{last['mass_change']:+.2e}"),
        ("change of total energy, of the available", f"{last['total_energy_change']:+.2e}"),
        ("change of total energy, of the total", f"{last['total_energy_change_of_total']:+.2e}"),
        ("change of potential enstrophy", f"{last['potential_enstrophy_change']:+.2e}"),
        ("change of absolute vorticity, of |f|", f"{last['absolute_vorticity_change']:+.2e}"),
        ("files", str(directory)),
    ]
    _print_table(f"Run of {record['case']}", rows)


def _print_table(title: str, rows: list[tuple[str, str]]) -> None:
    table = Table(title=title, show_header=False)
    for row in rows:
        table.add_row(*row)
    Console().print(table)

"""Summaries of a mesh and of a run."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from mesh import VoronoiMesh
from mesh.discrete.quality import quality_and_note
from mesh.generation.well_centered import WellCentered
from mesh.parts.sea_cells import CulledSea
from swe.output.files import DIAGNOSTICS_FILE, load_record, read_series


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


def tell_of_centring(centring: WellCentered) -> None:
    """Print, in a line, what a mesh without obtuse triangles gained and lost."""
    typer.echo(
        f"well-centred: the least triangle quality is {centring.least_quality:.3f}, and the residual rose from "
        f"{centring.residual_before:.1e} to {centring.residual:.1e} mean spacings"
    )


def tell_of_sea(sea: CulledSea) -> None:
    """Print, in a line, how many cells of a mesh a sea has and what was left out of its region."""
    typer.echo(
        f"kept {np.count_nonzero(sea.kept)} of {sea.kept.size} cells; left out of the region {sea.channel_cells} "
        f"cells of channels, and {sea.lakes} lakes of {sea.lake_cells} cells"
    )


def print_run(directory: Path) -> None:
    """Print a summary of a finished run as a table, with the place of its files."""
    record = load_record(directory)
    series = read_series(directory / DIAGNOSTICS_FILE)
    last = {name: float(values[-1]) for name, values in series.items()}
    rows = [
        ("status", record["status"]),
        *_size_of(record),
        ("day reached", f"{record['day_reached']:g}"),
        ("time step, steps", f"{record['configuration']['time_step']:g} s, {record['steps']}"),
        ("wall-clock time", f"{record['wall_seconds']:.1f} s"),
        ("Courant number", f"{last['courant_number']:.2f}"),
        ("largest speed", f"{last['max_speed']:.2f} m/s"),
        ("mass change", f"{last['mass_change']:+.2e}"),
        ("total energy change / available energy", f"{last['total_energy_change']:+.2e}"),
        ("total energy change / total energy", f"{last['total_energy_change_of_total']:+.2e}"),
        ("potential enstrophy change", f"{last['potential_enstrophy_change']:+.2e}"),
        ("absolute vorticity change / integral of |f|", f"{last['absolute_vorticity_change']:+.2e}"),
        ("files", str(directory)),
    ]
    _print_table(f"Run of {record['case']}", rows)


def _size_of(record: dict[str, Any]) -> list[tuple[str, str]]:
    """Cells and what they were divided among, as a row."""
    cells, processes, threads = record["cells"], record.get("processes", 1), record["threads"]
    if processes == 1:
        return [("cells, threads", f"{cells}, {threads}")]
    return [("cells, processes, threads of each", f"{cells}, {processes}, {threads}")]


def _print_table(title: str, rows: list[tuple[str, str]]) -> None:
    table = Table(title=title, show_header=False)
    for row in rows:
        table.add_row(*row)
    Console().print(table)

"""`trisk bench`: the meshes it times on, and the table it prints."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from cases import find_case
from mesh import VoronoiMesh, read_mesh, scvt_mesh
from mesh.generation.generators import MINIMUM_CELLS
from swe import Simulation
from swe.run.benchmark import Timing, measure

CASE = "williamson5"
DEFAULT_CELLS = (10242, 40962)

TOLERANCE = 1e-2
"""Residual of the meshes made for timing: the cost of a step hardly depends on it, that of the mesh does."""


def timings(mesh_file: Path | None, cells: Sequence[int], recompute_metrics: bool, show: bool) -> list[Timing]:
    """Timings of test case 5 on the mesh of a file or on meshes of so many cells, told one by one if `show`."""
    if mesh_file is not None and cells:
        raise typer.BadParameter("give either --mesh FILE or --cells N")
    if recompute_metrics and mesh_file is None:
        raise typer.BadParameter("--recompute-metrics goes with --mesh FILE")
    for number in cells:
        if number < MINIMUM_CELLS:
            raise typer.BadParameter(f"{number} cells make no mesh; give at least {MINIMUM_CELLS}")
    results = []
    for mesh in _meshes(mesh_file, cells or DEFAULT_CELLS, recompute_metrics):
        if show:
            typer.echo(f"timing {mesh.n_cells} cells", err=True)
        results.append(measure(Simulation(mesh, find_case(CASE))))
    return results


def _meshes(mesh_file: Path | None, cells: Sequence[int], recompute_metrics: bool) -> Iterator[VoronoiMesh]:
    if mesh_file is not None:
        yield read_mesh(mesh_file, recompute_metrics)
        return
    for number in cells:
        yield scvt_mesh(number, tolerance=TOLERANCE)


def print_timings(results: Sequence[Timing]) -> None:
    """Print a table of timings."""
    table = Table(
        title=f"{CASE}, classical RK4: cost per cell and step, medians of alternating turns",
        caption="ns: fused; plain: plain loops; bytes: every array once for each stage; GB/s: bytes by ns; "
        "triad: GB/s of STREAM; budget: bytes that the triad would move in that time",
    )
    for heading in ("cells", "threads", "ns", "plain", "ratio", "bytes", "GB/s", "triad", "budget"):
        table.add_column(heading, justify="right", no_wrap=True)
    for timing in results:
        table.add_row(
            str(timing.cells),
            str(timing.threads),
            f"{timing.ns_per_cell_step:.1f}",
            f"{timing.plain_ns_per_cell_step:.0f}",
            f"{timing.plain_twin_ratio:.2f}",
            f"{timing.bytes_per_cell_step:.0f}",
            f"{timing.gb_per_s:.1f}",
            f"{timing.triad_gb_per_s:.1f}",
            f"{timing.ns_per_cell_step * timing.triad_gb_per_s:.0f}",
        )
    Console().print(table)

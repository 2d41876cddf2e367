"""`trisk bench`: time the solver on meshes of several sizes."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from trisk.cli.options import AnticipationFraction, DissipationCoefficient, Quiet, Recompute, Scheme, UpwindingFactor

if TYPE_CHECKING:
    from mesh import VoronoiMesh
    from swe.run.benchmark import Timing

CASE = "williamson5"
DEFAULT_CELLS = (10242, 40962)

TOLERANCE = 1e-2
"""Residual of the meshes made for timing: the cost of a step hardly depends on it, the cost of the mesh does."""


def bench(
    cells: Annotated[
        list[int] | None,
        typer.Option("--cells", metavar="N", help="Number of cells, repeatable; by default 10242 and 40962."),
    ] = None,
    mesh_file: Annotated[Path | None, typer.Option("--mesh", help="Time the solver on this mesh instead.")] = None,
    integrator: Annotated[
        Literal["rk4", "fbrk3"], typer.Option("--integrator", help="The method whose steps are timed.")
    ] = "rk4",
    scheme: Scheme = "ringler2010",
    anticipation: AnticipationFraction = 0.0,
    upwinding: UpwindingFactor = 0.0,
    dissipation: DissipationCoefficient = 0.0,
    recompute_metrics: Recompute = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print a list of JSON objects.")] = False,
    quiet: Quiet = False,
) -> None:
    """Time the solver.

    Reports the cost of a step of test case 5, beside plain loops and the memory bandwidth.
    """
    options = {
        "integrator": integrator,
        "scheme": scheme,
        "anticipation": anticipation,
        "upwinding": upwinding,
        "dissipation": dissipation,
    }
    results = _timings(mesh_file, cells or (), options, recompute_metrics, not quiet)
    if as_json:
        typer.echo(json.dumps([asdict(timing) for timing in results]))
    else:
        from trisk.report.timings_table import print_timings

        print_timings(results, CASE)


def _timings(
    mesh_file: Path | None, cells: Sequence[int], options: dict[str, Any], recompute_metrics: bool, show: bool
) -> "list[Timing]":
    """Timings of test case 5, in runs with `options`, on the mesh of a file or on meshes of these sizes.

    They are announced one by one if `show`.
    """
    from cases import find_case
    from mesh.generation.generators import MINIMUM_CELLS
    from swe import Simulation
    from swe.run.benchmark import measure

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
        results.append(measure(Simulation(mesh, find_case(CASE), **options)))
    return results


def _meshes(mesh_file: Path | None, cells: Sequence[int], recompute_metrics: bool) -> "Iterator[VoronoiMesh]":
    from mesh import read_mesh, scvt_mesh

    if mesh_file is not None:
        yield read_mesh(mesh_file, recompute_metrics)
        return
    for number in cells:
        yield scvt_mesh(number, tolerance=TOLERANCE)

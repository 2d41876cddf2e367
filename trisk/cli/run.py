"""`trisk run`: run a test case, or continue a run."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from trisk.cli.options import (
    AnticipationFraction,
    CaseName,
    DissipationCoefficient,
    Quiet,
    Recompute,
    Scheme,
    Settings,
    UpwindingFactor,
    WallSlip,
)


def run(
    case: CaseName,
    output: Annotated[Path, typer.Option("--output", "-o", help="Run directory to create.")],
    mesh_file: Annotated[Path | None, typer.Option("--mesh", help="MPAS mesh file.")] = None,
    cells: Annotated[int | None, typer.Option("--cells", help="Generate a mesh of this many cells instead.")] = None,
    settings: Settings = None,
    means: Annotated[
        bool, typer.Option("--cell-means", help="Start from cell means instead of values at cell centres.")
    ] = False,
    days: Annotated[
        float | None,
        typer.Option(
            "--days",
            help="Simulated days since the start; by default what the paper recommends or, with --resume, "
            "what the run was given.",
        ),
    ] = None,
    time_step: Annotated[
        float | None, typer.Option("--dt", help="Time step in seconds; by default from the mesh and the wave speed.")
    ] = None,
    snapshot_hours: Annotated[float, typer.Option("--snapshot-hours", help="Hours between snapshots.")] = 24.0,
    diagnostics_hours: Annotated[float, typer.Option("--diagnostics-hours", help="Hours between diagnostics.")] = 6.0,
    checkpoint_hours: Annotated[
        float, typer.Option("--checkpoint-hours", help="Simulated hours between checkpoints.")
    ] = 24.0,
    integrator: Annotated[
        Literal["rk4", "rrk4", "fbrk3", "rfbrk3"],
        typer.Option(
            "--integrator",
            help="rk4, or fbrk3, of order two with longer and cheaper steps; rrk4 and rfbrk3 scale their steps to "
            "conserve total energy to round-off.",
        ),
    ] = "rk4",
    scheme: Scheme = "ringler2010",
    anticipation: AnticipationFraction = 0.0,
    upwinding: UpwindingFactor = 0.0,
    dissipation: DissipationCoefficient = 0.0,
    wall_slip: WallSlip = 0.0,
    fields: Annotated[
        str | None,
        typer.Option(
            "--fields",
            help="Fields that snapshots hold, as in thickness,potential_vorticity; by default all of them or, with "
            "--resume, those of the run.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the run in the directory.")] = False,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Continue the run in the directory, on its mesh; a finished run continues to a later --days.",
        ),
    ] = False,
    recompute_metrics: Recompute = False,
    quiet: Quiet = False,
) -> None:
    """Run a test case and write snapshots and diagnostics.

    Ctrl-C and SIGTERM stop the run and leave a checkpoint. Under mpiexec, as many processes share the run, whose files
    are the same.
    """
    from cases import find_case
    from cases.parameters import split_settings
    from swe import Simulation
    from swe.configuration import Options
    from swe.diagnostics.outputs import chosen_fields
    from swe.errors import InputError
    from swe.output.recorder import days_of, fields_of, run_to_go_on_with
    from swe.run.composition import rings_needed
    from swe.tiles.fused import why_not_fused
    from trisk.arguments.meshes import MeshSource, mesh_file_of_run
    from trisk.arguments.shared import processes_with_mesh
    from trisk.report.summaries import print_run

    chosen = find_case(case, split_settings(settings or ()))
    options: dict[str, Any] = {
        "time_step": time_step,
        "snapshot_interval": 3600.0 * snapshot_hours,
        "diagnostics_interval": 3600.0 * diagnostics_hours,
        "checkpoint_interval": 3600.0 * checkpoint_hours,
        "sampling": "mean" if means else "point",
        "integrator": integrator,
        "anticipation": anticipation,
        "dissipation": dissipation,
        "scheme": scheme,
        "upwinding": upwinding,
        "wall_slip": wall_slip,
    }
    # Refuse what can be refused before a mesh is made in vain.
    asked = Options(**options)
    asked.require_suitable(chosen.name, chosen.prescribed_wind)
    before = run_to_go_on_with(output, force, resume)
    if days is None:
        days = chosen.recommended_days if before is None else days_of(before, output)
    names = fields.replace(" ", "").split(",") if fields is not None else fields_of(before)
    chosen_fields(names)
    if not 0.0 < days < float("inf"):
        raise InputError(f"the run is to last {days:g} days; give a number above 0")
    if cells is not None and chosen.radius == 0.0:
        raise InputError(f"{chosen.name} is on a plane, and --cells makes spheres; give --mesh (trisk mesh --plane)")
    if resume and recompute_metrics and mesh_file is None:
        raise typer.BadParameter("--recompute-metrics goes with --mesh FILE")
    of_run = mesh_file_of_run(output) if resume and mesh_file is None else None
    source = MeshSource(mesh_file, cells, recompute_metrics, quiet, of_run)
    with processes_with_mesh(source, output, chosen.radius, rings_needed(asked)) as (mesh, processes):
        simulation = Simulation(
            mesh, chosen, output, fields=names, overwrite=force, resume=resume, processes=processes, **options
        )
        if not quiet and simulation.loops == "plain":
            typer.echo(
                f"{why_not_fused(simulation.model, integrator)}: plain loops take the steps, at several times the cost",
                err=True,
            )
        simulation.run(until=days, progress=not quiet)
        if not quiet and processes.first:
            print_run(output)

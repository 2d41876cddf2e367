"""`trisk study`: what meshes and time steps do to solutions."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import CaseName, Quiet, Recompute, Schemes, Settings

app = typer.Typer(
    help="Study how meshes or time steps turn into errors. An interrupted study continues where it stopped."
)

Output = Annotated[Path, typer.Option("--output", "-o", help="Folder of the study; one begun before is continued.")]


@app.command()
def mesh(
    case: CaseName,
    output: Output,
    families: Annotated[
        list[str] | None, typer.Option("--family", help="Family of meshes, repeatable; by default all.")
    ] = None,
    cells: Annotated[
        list[int] | None,
        typer.Option(
            "--cells",
            help="Number of cells, 10*4^k+2, repeatable; by default 642, 2562, 10242. On a plane about so many; by "
            "default 576, 2304, 9216.",
        ),
    ] = None,
    plane: Annotated[
        str | None,
        typer.Option(
            "--plane", metavar="LX,LY", help="Lengths of the plane, m; by default x_length and y_length of the case."
        ),
    ] = None,
    periodic: Annotated[
        str | None,
        typer.Option("--periodic", help="Where the plane repeats itself: xy, x or none; by default as the case says."),
    ] = None,
    days: Annotated[
        float | None, typer.Option("--days", help="Simulated days; by default what the paper recommends.")
    ] = None,
    error_day: Annotated[
        float | None, typer.Option("--error-day", help="Day at which errors are taken; by default the last.")
    ] = None,
    schemes: Schemes = None,
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Run a case over families and sizes of meshes.

    Sets mesh quality beside solution error and conservation.
    """
    from cases import find_case
    from cases.parameters import split_settings
    from postprocess.reports.study_report import write_mesh_report
    from postprocess.studies.families import FAMILIES
    from postprocess.studies.lines import chosen_schemes
    from postprocess.studies.mesh_study import Plan, carry_out
    from postprocess.studies.plane_families import PLANE_CELLS, plane_of_study
    from trisk.arguments.pairs import pair_of

    chosen = find_case(case, split_settings(settings or ()))
    days = chosen.recommended_days if days is None else days
    on_plane = plane_of_study(chosen, None if plane is None else pair_of("--plane", plane), periodic)
    plan = Plan(
        output,
        chosen,
        days,
        days if error_day is None else error_day,
        tuple(families or (FAMILIES if on_plane is None else on_plane.families)),
        tuple(cells or ((642, 2562, 10242) if on_plane is None else PLANE_CELLS)),
        chosen_schemes(schemes),
        on_plane,
    )
    tell = _teller(quiet)
    finest, rows = carry_out(plan, not quiet, tell)
    tell(str(write_mesh_report(plan, finest, rows, ["trisk", *sys.argv[1:]])))


@app.command()
def time(
    case: CaseName,
    output: Output,
    time_steps: Annotated[list[float], typer.Option("--dt", help="Time step in seconds; give several.")],
    mesh_file: Annotated[Path | None, typer.Option("--mesh", help="MPAS mesh file.")] = None,
    cells: Annotated[int | None, typer.Option("--cells", help="Generate a mesh of this many cells instead.")] = None,
    days: Annotated[
        float | None, typer.Option("--days", help="Simulated days; by default what the paper recommends.")
    ] = None,
    schemes: Schemes = None,
    settings: Settings = None,
    recompute_metrics: Recompute = False,
    quiet: Quiet = False,
) -> None:
    """Run a case with several time steps.

    Reports the energy drift and the time-stepping error.
    """
    from cases import find_case
    from cases.parameters import split_settings
    from postprocess.reports.study_report import write_time_report
    from postprocess.studies.lines import chosen_schemes
    from postprocess.studies.time_study import TimePlan, carry_out
    from trisk.arguments.meshes import chosen_mesh

    chosen = find_case(case, split_settings(settings or ()))
    used = chosen_mesh(mesh_file, cells, recompute_metrics, quiet)
    days = chosen.recommended_days if days is None else days
    plan = TimePlan(output, chosen, used, days, tuple(time_steps), chosen_schemes(schemes))
    tell = _teller(quiet)
    rows = carry_out(plan, not quiet, tell)
    tell(str(write_time_report(plan, rows, ["trisk", *sys.argv[1:]])))


def _teller(quiet: bool) -> Callable[[str], None]:
    """A function that prints a line, unless `quiet`."""

    def tell(line: str) -> None:
        if not quiet:
            typer.echo(line)

    return tell

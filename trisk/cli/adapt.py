"""`trisk adapt`: a mesh that follows the solution on it."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import CaseName, Quiet, Scheme, Settings

FINER = 4
"""Cells of the fine mesh for each one of the others."""


def adapt(
    case: CaseName,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder of all rounds; one begun before is continued.")
    ],
    cells: Annotated[int, typer.Option("--cells", help="Number of cells of each mesh.")],
    days: Annotated[
        float | None, typer.Option("--days", help="Simulated days of a round; by default what the paper recommends.")
    ] = None,
    rounds: Annotated[int, typer.Option("--rounds", help="How many times the mesh is made anew.")] = 3,
    fine: Annotated[
        int | None,
        typer.Option("--fine", help="Cells of the uniform mesh that errors refer to; by default 4 times as many."),
    ] = None,
    begin_again: Annotated[
        bool,
        typer.Option("--begin-again", help="Begin each round at the start of the case, not where the last one ended."),
    ] = False,
    coast: Annotated[
        str | None,
        typer.Option("--coast", metavar="REGION", help="Fill the sea of this region up to its coast; see trisk mesh."),
    ] = None,
    density_floor: Annotated[
        float | None,
        typer.Option("--density-floor", help="Raise the energy, over its largest value, to this; by default to 0.001."),
    ] = None,
    density_power: Annotated[
        float | None,
        typer.Option("--density-power", help="Power of the energy that gives the density of a mesh; by default 0.5."),
    ] = None,
    scheme: Scheme = "ringler2010",
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Run a case, make a mesh for its kinetic energy, carry the state over, and run again.

    The report sets the meshes and their errors beside uniform meshes of as many cells and of the same cost. An
    interrupted call continues where it stopped.
    """
    from cases import find_case
    from cases.parameters import split_settings
    from postprocess.adaptation.adapt_report import write_adaptation
    from postprocess.adaptation.energy_density import MILD_FLOOR, MILD_POWER
    from postprocess.adaptation.rounds import Plan, adapt

    chosen = find_case(case, split_settings(settings or ()))
    days = chosen.recommended_days if days is None else days
    fine = FINER * cells if fine is None else fine
    density_floor = MILD_FLOOR if density_floor is None else density_floor
    density_power = MILD_POWER if density_power is None else density_power

    def tell(line: str) -> None:
        if not quiet:
            typer.echo(line)

    plan = Plan(output, chosen, cells, fine, days, rounds, begin_again, coast, scheme, density_floor, density_power)
    made = adapt(plan, not quiet, tell)
    tell(str(write_adaptation(plan, made, ["trisk", *sys.argv[1:]])))

"""`trisk reference`: solutions by the spectral model."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import CaseName, Quiet, Settings


def reference(
    case: CaseName,
    output: Annotated[Path, typer.Option("--output", "-o", help="File of harmonics to write.")],
    days: Annotated[
        list[float] | None, typer.Option("--day", help="Day to keep, repeatable; by default those of the case.")
    ] = None,
    truncation: Annotated[
        int, typer.Option("--truncation", help="Highest total wavenumber; a half and a quarter of it are run as well.")
    ] = 341,
    damping_hours: Annotated[
        float, typer.Option("--damping-hours", help="Time in which del^8 damps that wavenumber to 1/e; inf for none.")
    ] = 1.0,
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Make a reference solution of a case with the spectral model."""
    from cases import find_case
    from cases.parameters import split_settings
    from postprocess.reference.making import REFERENCE_DAYS, make_reference
    from postprocess.reference.reference_file import write_reference
    from postprocess.runs.folders import require_possible_file
    from trisk.arguments.outputs import command_line
    from trisk.report.bars import bars_of_parts
    from trisk.report.reference_table import print_differences

    chosen = find_case(case, split_settings(settings or ()))
    require_possible_file(output)
    chosen_days = tuple(sorted(days or ())) or REFERENCE_DAYS.get(chosen.name, (chosen.recommended_days,))
    with bars_of_parts(not quiet) as show:
        made = make_reference(chosen, chosen_days, truncation, damping_hours, command_line(), show)
    write_reference(made, output)
    if not quiet:
        print_differences(made)

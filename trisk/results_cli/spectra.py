"""`trisk spectra`: spectra of runs."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet


def spectra(
    run_directories: Annotated[list[Path], typer.Argument(help="Directories of runs.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the table and the figure.")],
    days: Annotated[
        list[float] | None, typer.Option("--day", help="Day of a snapshot, repeatable; by default the last.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Write and draw spectra of energy and potential enstrophy.

    The energy is kinetic energy; wavenumbers are total wavenumbers, on periodic planes waves in the longer period.
    """
    from postprocess.figures.spectra_figure import write_spectra_of
    from postprocess.runs.reading import read_run

    paths = write_spectra_of([read_run(directory) for directory in run_directories], days or (), output)
    if not quiet:
        for path in paths:
            typer.echo(path)

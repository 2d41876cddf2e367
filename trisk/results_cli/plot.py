"""`trisk plot`: figures of a run."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet


def plot(
    run_directory: Annotated[Path, typer.Argument(help="Directory that a run wrote.")],
    quiet: Quiet = False,
) -> None:
    """Draw maps, the mesh and the conservation of a run.

    The figures go to the run's figures folder.
    """
    from postprocess.figures.plots import plot_run
    from postprocess.runs.reading import read_run
    from swe.output.files import FIGURES_FOLDER

    paths = plot_run(read_run(run_directory), run_directory / FIGURES_FOLDER)
    if not quiet:
        for path in paths:
            typer.echo(path)

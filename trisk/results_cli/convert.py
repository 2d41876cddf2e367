"""`trisk convert`: runs in the file formats of other programs."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet


def convert(
    run_directory: Annotated[Path, typer.Argument(help="Directory that a run wrote.")],
    to: Annotated[
        str,
        typer.Option(
            "--to",
            metavar="[ugrid|vtk]",
            help="ugrid, one NetCDF file in the conventions UGRID and CF, or vtk, a folder of files for ParaView.",
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="File (ugrid) or folder (vtk) to write.")],
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier result.")] = False,
    quiet: Quiet = False,
) -> None:
    """Write the mesh and all snapshots of a run in a format that other programs open.

    Prints the files to open.
    """
    from postprocess.convert.conversion import convert_run
    from trisk.arguments.outputs import command_line
    from trisk.report.bars import bars_of_parts

    with bars_of_parts(not quiet) as show:
        paths = convert_run(run_directory, to, output, force, command_line(), show)
    if not quiet:
        for path in paths:
            typer.echo(path)

"""`trisk view`: a run or a mesh as a page for a browser."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet


def view(
    run_directory: Annotated[Path, typer.Argument(help="Directory that a run wrote, or the file of a mesh.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="HTML file to write.")],
    other_directory: Annotated[
        Path | None, typer.Argument(help="Another run on the same mesh, shown beside it with their difference.")
    ] = None,
    fields: Annotated[
        str | None,
        typer.Option(
            "--fields",
            help="Fields of the page, as in thickness,normal_velocity; by default all that the snapshots hold at "
            "cells and vertices.",
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Make a page that shows a run, or two, or a mesh in a browser.

    The page needs no network: it holds the cells and all snapshots.
    """
    from mesh import read_mesh
    from postprocess.runs.reading import read_run
    from postprocess.view import require_page, view_page

    require_page(output)
    other = None if other_directory is None else read_run(other_directory)
    shown = read_mesh(run_directory) if run_directory.is_file() else read_run(run_directory)
    path = view_page(shown, output, other, _names(fields))
    if not quiet:
        typer.echo(path)


def _names(fields: str | None) -> list[str]:
    return [] if fields is None else [name.strip() for name in fields.split(",")]

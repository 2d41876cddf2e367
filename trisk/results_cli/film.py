"""`trisk film`: a film of a run."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from trisk.cli.options import Quiet

USUAL_CENTRE = "270,0"


def film(
    run_directory: Annotated[Path, typer.Argument(help="Directory that a run wrote.")],
    field: Annotated[str, typer.Option("--field", help="Field of the snapshots, such as potential_vorticity.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write, .mp4 or .gif.")],
    projection: Annotated[
        Literal["mollweide", "orthographic", "cylindrical"] | None,
        typer.Option("--projection", help="By default the first, or the second with a centre off the equator."),
    ] = None,
    centre: Annotated[
        str | None,
        typer.Option(
            "--centre",
            metavar="LONGITUDE,LATITUDE",
            help="Middle of the map, degrees; planes have none.",
            show_default=USUAL_CENTRE,
        ),
    ] = None,
    days: Annotated[
        str | None, typer.Option("--days", metavar="FIRST,LAST", help="First and last day; by default all days.")
    ] = None,
    size: Annotated[
        str, typer.Option("--size", metavar="WIDTH,HEIGHT", help="Width and height in pixels.")
    ] = "1280,720",
    quiet: Quiet = False,
) -> None:
    """Write a film of a field, one frame for each snapshot.

    MP4 needs the extra 'film'; GIF does not.
    """
    from postprocess.figures.field_map import MIDDLE
    from postprocess.film.film import film as write_film
    from postprocess.runs.folders import require_possible_file
    from postprocess.runs.reading import open_run
    from trisk.arguments.pairs import pair_of
    from trisk.report.bars import bars_of_parts

    require_possible_file(output)
    asked_days = None if days is None else pair_of("--days", days)
    width, height = pair_of("--size", size, whole=True)
    asked_middle = None if centre is None else pair_of("--centre", centre)
    with open_run(run_directory) as run, bars_of_parts(not quiet) as progress:
        usual = pair_of("--centre", USUAL_CENTRE) if run.mesh.on_a_sphere else MIDDLE
        write_film(
            run,
            field,
            output,
            days=asked_days,
            size=(int(width), int(height)),
            projection=projection,
            centre=asked_middle or usual,
            progress=progress,
        )
    if not quiet:
        typer.echo(output)

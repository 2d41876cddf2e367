"""`trisk cull`: the cells of a mesh that lie in a region."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import FileFormat, Quiet, Recompute


def cull(
    file: Annotated[Path, typer.Argument(help="MPAS mesh file.")],
    keep: Annotated[
        str,
        typer.Option(
            "--keep",
            metavar="REGION",
            help="north-atlantic, world-ocean, a box WEST,EAST,SOUTH,NORTH in degrees, polygons FILE.geojson, or a "
            "mask or signed distance FILE.nc:VARIABLE.",
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="MPAS mesh file to write.")],
    keep_lakes: Annotated[bool, typer.Option("--keep-lakes", help="Keep all seas, not only the largest.")] = False,
    keep_channels: Annotated[bool, typer.Option("--keep-channels", help="Keep channels of one cell's width.")] = False,
    recompute_metrics: Recompute = False,
    file_format: FileFormat = "netcdf4",
    quiet: Quiet = False,
) -> None:
    """Keep the cells of a mesh whose centres lie in a region, with walls along its coast."""
    from mesh import find_region, read_mesh, write_mesh
    from mesh.files.io import require_format
    from mesh.parts.culling import culled
    from mesh.parts.sea_cells import sea_cells
    from postprocess.runs.folders import require_possible_file
    from trisk.arguments.outputs import command_line
    from trisk.report.summaries import print_quality, tell_of_sea

    require_format(file_format)
    require_possible_file(output)
    region = find_region(keep)
    whole = read_mesh(file, recompute_metrics)
    sea = sea_cells(whole, region, keep_lakes=keep_lakes, keep_channels=keep_channels)
    part = culled(whole, sea.kept)
    write_mesh(part, output, command_line(), file_format)
    if not quiet:
        tell_of_sea(sea)
        print_quality(part, str(output))

"""`trisk partition`: a mesh divided into blocks for many processes."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet, Recompute


def partition(
    file: Annotated[Path, typer.Argument(help="MPAS mesh file.")],
    blocks: Annotated[int, typer.Option("--blocks", help="Number of blocks: processes, or more than one for each.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the files and the map.")],
    weights: Annotated[
        str | None,
        typer.Option(
            "--weights",
            metavar="FILE.nc:VARIABLE",
            help="Balance this variable, one positive number for each cell; by default the number of cells.",
        ),
    ] = None,
    recompute_metrics: Recompute = False,
    quiet: Quiet = False,
) -> None:
    """Divide a mesh into connected blocks with METIS.

    Writes graph.info and graph.info.part.N as MPAS reads them, and a map of the blocks, and prints how good they are.
    """
    from mesh.files.partition_files import read_weights, write_partition
    from mesh.partition.measures import measure_partition
    from mesh.partition.partition import partition_graph
    from postprocess.figures.block_map import write_block_figure
    from postprocess.runs.folders import prepared_folder, require_possible_folder
    from trisk.arguments.cells import cells_to_divide
    from trisk.report.partition_table import print_partition

    require_possible_folder(output)
    source = None if weights is None else _file_and_variable(weights)
    graph, drawn = cells_to_divide(file, recompute_metrics)
    costs = None if source is None else read_weights(*source, graph.n_cells)
    divided = partition_graph(graph, blocks, costs)
    folder = prepared_folder(output)
    paths = write_partition(folder, graph, divided)
    pictures = () if drawn is None else (write_block_figure(drawn, graph, divided, folder / "blocks.png"),)
    if not quiet:
        print_partition(str(file), divided, measure_partition(graph, divided, costs), (*paths, *pictures))


def _file_and_variable(weights: str) -> tuple[Path, str]:
    path, _, variable = weights.rpartition(":")
    if not (path and variable):
        raise typer.BadParameter(f"{weights!r} names no variable of a file; write FILE.nc:VARIABLE")
    return Path(path), variable

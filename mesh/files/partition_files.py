"""The graph of cells and the block of each cell as text, as METIS and MPAS read them, and weights of cells."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.partition.cell_graph import CellGraph
from mesh.partition.partition import Partition
from mesh.plain import plain_count
from mesh.safe_files import AnyPath, dataset, written_aside

GRAPH_FILE = "graph.info"
CELLS_AT_ONCE = 100_000


def write_partition(folder: AnyPath, graph: CellGraph, partition: Partition) -> tuple[Path, Path]:
    """Write `graph.info` and `graph.info.part.N`, for N blocks, to a folder; return their paths.

    The first has the numbers of cells and of edges between cells in its first line, then a line for each cell with its
    neighbours, counted from 1. The second has the block of each cell, counted from 0. Raises `OSError` where they
    cannot be written.
    """
    folder = Path(folder)
    graph_path = folder / GRAPH_FILE
    with written_aside(graph_path) as aside, aside.open("w") as file:
        file.write(f"{graph.n_cells} {graph.n_edges}\n")
        file.writelines(_lines_of(graph))
    part_path = folder / f"{GRAPH_FILE}.part.{partition.n_blocks}"
    with written_aside(part_path) as aside, aside.open("w") as file:
        file.writelines(f"{block}\n" for block in partition.block_of_cell.tolist())
    return graph_path, part_path


def _lines_of(graph: CellGraph) -> Iterator[str]:
    for first in range(0, graph.n_cells, CELLS_AT_ONCE):
        starts = graph.starts[first : first + CELLS_AT_ONCE + 1]
        names = [str(neighbour + 1) for neighbour in graph.neighbours[starts[0] : starts[-1]].tolist()]
        ends = (starts - starts[0]).tolist()
        for start, end in pairwise(ends):
            yield " ".join(names[start:end]) + "\n"


def read_partition(path: AnyPath, cells: int, blocks: int | None = None) -> Partition:
    """Read the block of each of `cells` cells from a file of METIS; by default the N of `graph.info.part.N` blocks.

    Raises `MeshError` where the file is missing, holds anything but one whole number for each cell, or a block that is
    negative or not below the number of blocks.
    """
    path = Path(path)
    n_blocks = _blocks_in_name(path) if blocks is None else plain_count("the number of blocks", blocks)
    try:
        words = path.read_bytes().split()
    except OSError as error:
        raise MeshError(f"{path}: {error.strerror}; give a file with the block of each cell") from error
    try:
        block_of_cell = np.array(words, dtype=np.bytes_).astype(np.int64)
    except (ValueError, OverflowError) as error:
        raise MeshError(f"{path}: {error}; give a file with one whole number, the block, for each cell") from error
    if len(block_of_cell) != cells:
        raise MeshError(f"{path}: {len(block_of_cell)} blocks for {cells} cells; give the file of this mesh")
    wrong = np.flatnonzero((block_of_cell < 0) | (block_of_cell >= n_blocks))
    if len(wrong):
        raise MeshError(
            f"{path}: line {wrong[0] + 1} names block {block_of_cell[wrong[0]]}, but the {n_blocks} blocks are 0 to "
            f"{n_blocks - 1}; give the right number of blocks or another file"
        )
    return Partition(block_of_cell.astype(np.int32), n_blocks)


def _blocks_in_name(path: Path) -> int:
    number = path.suffix[1:]
    if not (number.isdecimal() and int(number) > 0):
        raise MeshError(f"{path}: its name does not end with the number of blocks; name it {GRAPH_FILE}.part.N")
    return int(number)


def read_weights(path: AnyPath, variable: str, cells: int) -> Array:
    """Read the weights (cells,) of cells from a variable of a NetCDF file.

    Raises `MeshError` where there is no such file or variable, or it does not hold one number for each cell.
    """
    path = Path(path)
    try:
        with dataset(path) as file:
            file.set_auto_mask(False)
            if variable not in file.variables:
                raise MeshError(f"{path}: no variable named '{variable}'; name one that holds a weight for each cell")
            source = file.variables[variable]
            if source.shape != (cells,) or source.dtype is str or source.dtype.kind not in "iuf":
                raise MeshError(
                    f"{path}: {variable} of shape {source.shape} and type {source.dtype} is not one number for each of "
                    f"{cells} cells; name a variable that is"
                )
            return np.asarray(source[:], dtype=np.float64)
    except (OSError, RuntimeError) as error:
        reason = "not a readable NetCDF file" if path.is_file() else "no such file"
        raise MeshError(f"{path}: {reason}; give one with a weight for each cell") from error

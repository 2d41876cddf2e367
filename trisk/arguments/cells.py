"""The cells of a mesh file that a command divides."""

from pathlib import Path

from mesh import VoronoiMesh, read_mesh
from mesh.arrays import Array
from mesh.files.cells_of_file import count_cells, read_cells
from mesh.partition.cell_graph import CellGraph, cell_graph
from postprocess.figures.block_map import MOST_POLYGONS


def cells_to_divide(file: Path, recompute_metrics: bool) -> tuple[CellGraph, VoronoiMesh | Array | None]:
    """The graph of the cells of a file, and what a map of them is drawn from.

    That is the mesh, validated; of a large one, whose cells are drawn by pixels, only generators and triangles are read
    and checked, and there is no map of a plane.
    """
    if count_cells(file) > MOST_POLYGONS:
        graph, points = read_cells(file)
        return graph, points if points[:, 2].any() else None
    mesh = read_mesh(file, recompute_metrics)
    return cell_graph(mesh), mesh

"""Of a mesh file only its cells: how many, their neighbours and their generators, for meshes too large for the rest."""

from pathlib import Path

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError, require
from mesh.files.mesh_file import FileContent, opened_mesh_file, read_content
from mesh.geometry.sphere import dot, from_lonlat, normalize
from mesh.partition.cell_graph import CellGraph, graph_of_triangles
from mesh.safe_files import AnyPath

CARTESIAN = ("x_cell", "y_cell", "z_cell")
ANGLES = ("lon_cell", "lat_cell")


def count_cells(path: AnyPath) -> int:
    """How many cells a mesh file has; raise `MeshError` where that cannot be read."""
    return _read(Path(path), frozenset()).n_cells


def read_cells(path: AnyPath) -> tuple[CellGraph, Array]:
    """The graph of the cells of a mesh file, and their generators (n_cells, 3) on the unit sphere, or in metres.

    Reads generators and triangles alone, and takes a tenth of the memory of the mesh. Raises `MeshError` where one of
    the two is missing or wrong.
    """
    path = Path(path)
    content = _read(path, frozenset({*CARTESIAN, *ANGLES, "cells_on_vertex"}))
    try:
        return _graph(content), _generators(content)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error


def _read(path: Path, names: frozenset[str]) -> FileContent:
    try:
        with opened_mesh_file(path) as file:
            return read_content(file, names)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error


def _graph(content: FileContent) -> CellGraph:
    if "cells_on_vertex" not in content.arrays:
        raise MeshError("cellsOnVertex is missing; a mesh file must have its triangles")
    triangles = content.arrays["cells_on_vertex"]
    require(triangles < content.n_cells, "vertices", f"cellsOnVertex names none of the {content.n_cells} cells")
    return graph_of_triangles(content.n_cells, triangles)


def _generators(content: FileContent) -> Array:
    arrays = content.arrays
    if all(name in arrays for name in CARTESIAN):
        points = np.stack([arrays[name] for name in CARTESIAN], axis=1)
    elif all(name in arrays for name in ANGLES):
        points = from_lonlat(*(arrays[name] for name in ANGLES))
    else:
        raise MeshError("xCell, yCell and zCell are missing, and lonCell and latCell too; give a file that has them")
    if not content.on_a_sphere:
        return points
    size = dot(points, points)
    require(np.isfinite(size) & (size > 0.0), "cells", "the generator is no place on a sphere; mend the file")
    return normalize(points)

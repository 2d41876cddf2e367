"""Planar hexagon meshes as the tool of the MPAS community makes them: a file from its own formulae, numbers from 1.

Facts of its conventions: rows of cells from the south, every other one shifted by half a distance; the centre of the
first cell is at (dc / 2, dc sqrt(3) / 2); rings of cells start in the west and go counter-clockwise; a cell owns the
edges to its west, south-west and south-east, whose first cell it is, and the vertices to its south-west and south;
longitudes and latitudes are zero, and z is too. Attributes are on_a_sphere, sphere_radius 0, is_periodic, x_period and
y_period; the files are classic.
"""

from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

DIMENSIONS = {"nCells": 1, "nEdges": 3, "nVertices": 2}


def planar_arrays(columns: int, rows: int, dc: float) -> dict[str, tuple[tuple[str, ...], NDArray]]:
    """Dimensions and values of the arrays of a doubly periodic mesh, by their names in a file."""
    n_cells, height = columns * rows, 0.5 * np.sqrt(3.0) * dc
    row, column = np.divmod(np.arange(n_cells), columns)
    shift, size = row % 2, np.array([columns * dc, rows * height])

    def cell(east: NDArray, north: NDArray) -> NDArray:
        return (north % rows) * columns + east % columns

    west, east = cell(column - 1, row), cell(column + 1, row)
    south_west, south_east = cell(column - 1 + shift, row - 1), cell(column + shift, row - 1)
    north_west, north_east = cell(column - 1 + shift, row + 1), cell(column + shift, row + 1)
    own = np.arange(n_cells)
    across = np.column_stack([west, south_west, south_east, east, north_east, north_west])
    edges = np.column_stack([3 * own, 3 * own + 1, 3 * own + 2, 3 * east, 3 * north_east + 1, 3 * north_west + 2])
    # After the edge to the west comes the vertex to the south-west, and so on round the cell.
    corners = np.column_stack([2 * own, 2 * own + 1, 2 * east, 2 * north_east + 1, 2 * north_east, 2 * north_west + 1])
    cells_on_edge = np.stack([np.column_stack([own, other]) for other in (west, south_west, south_east)], 1)
    vertices_on_edge = np.stack(
        [np.column_stack(pair) for pair in ((corners[:, 5], corners[:, 0]), corners[:, :2].T, corners[:, 1:3].T)], 1
    )
    cells_on_vertex = np.stack(
        [np.column_stack([own, west, south_west]), np.column_stack([own, south_west, south_east])], 1
    )
    place = np.column_stack([(column + 0.5 + 0.5 * shift) * dc, (row + 1) * height])
    angles = np.array([np.pi, -2.0 * np.pi / 3.0, -np.pi / 3.0])
    at_edges = place[:, None] + 0.5 * dc * np.stack([np.cos(angles), np.sin(angles)], 1)
    at_vertices = place[:, None] + dc / np.sqrt(3.0) * np.array([[-0.5 * np.sqrt(3.0), -0.5], [0.0, -1.0]])
    arrays: dict[str, tuple[tuple[str, ...], NDArray]] = {}
    for name, places in (("Cell", place), ("Edge", at_edges.reshape(-1, 2)), ("Vertex", at_vertices.reshape(-1, 2))):
        dimension = ("nVertices" if name == "Vertex" else f"n{name}s",)
        inside = places % size
        inside[inside >= size] = 0.0
        values = (*inside.T, *np.zeros((3, len(places))))
        arrays |= {
            f"{each}{name}": (dimension, value)
            for each, value in zip(("x", "y", "z", "lat", "lon"), values, strict=True)
        }
    area, dv = dc * height, dc / np.sqrt(3.0)
    numbers = {
        "cellsOnCell": (("nCells", "maxEdges"), across),
        "edgesOnCell": (("nCells", "maxEdges"), edges),
        "verticesOnCell": (("nCells", "maxEdges"), corners),
        "cellsOnEdge": (("nEdges", "TWO"), cells_on_edge.reshape(-1, 2)),
        "verticesOnEdge": (("nEdges", "TWO"), vertices_on_edge.reshape(-1, 2)),
        "cellsOnVertex": (("nVertices", "vertexDegree"), cells_on_vertex.reshape(-1, 3)),
    }
    arrays |= {name: (dimensions, (values + 1).astype(np.int32)) for name, (dimensions, values) in numbers.items()}
    counts = {"nEdgesOnCell": ("nCells", 6), "nEdgesOnEdge": ("nEdges", 10)}
    arrays |= {
        name: ((of,), np.full(DIMENSIONS[of] * n_cells, count, np.int32)) for name, (of, count) in counts.items()
    }
    constants = {
        **{"areaCell": ("nCells", area), "areaTriangle": ("nVertices", 0.5 * area)},
        **{"dcEdge": ("nEdges", dc), "dvEdge": ("nEdges", dv), "meshDensity": ("nCells", 1.0)},
    }
    arrays |= {name: ((of,), np.full(DIMENSIONS[of] * n_cells, value)) for name, (of, value) in constants.items()}
    arrays["angleEdge"] = (("nEdges",), np.tile(angles, n_cells))
    arrays["kiteAreasOnVertex"] = (("nVertices", "vertexDegree"), np.full((2 * n_cells, 3), area / 6.0))
    return arrays


def write_planar_file(path: Path, columns: int, rows: int, dc: float) -> None:
    """Write the doubly periodic mesh of so many columns and rows of hexagons, `dc` metres apart."""
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({"on_a_sphere": "NO", "sphere_radius": 0.0, "is_periodic": "YES", "mesh_spec": "1.0"})
        file.setncatts({"x_period": columns * dc, "y_period": rows * dc * np.sqrt(3.0) / 2.0, "dc": dc})
        for name, (dimensions, values) in planar_arrays(columns, rows, dc).items():
            for dimension, size in zip(dimensions, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            file.createVariable(name, values.dtype, dimensions)[:] = values

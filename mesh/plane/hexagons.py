"""Regular hexagons on a plane: periodic in both directions, a channel along x, or a closed box.

Rows of cells run along x, each shifted by half a distance to those beside it. Walls follow the hexagons.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mesh.arrays import Array, Index
from mesh.discrete.build import validated
from mesh.discrete.metrics import compute_metrics
from mesh.discrete.topology import build_topology
from mesh.errors import MeshError
from mesh.geometry.plane import Plane
from mesh.parts.culling import culled
from mesh.plain import plain_count
from mesh.plane.domain import Rectangle, pair, rectangle
from mesh.validated import remember_validated
from mesh.voronoi_mesh import VoronoiMesh

ROW = 0.5 * math.sqrt(3.0)
"""Distance of neighbouring rows, in distances of neighbouring cells."""

FEWEST_COLUMNS, FEWEST_ROWS = 3, 4
"""Of periodic meshes: with fewer, two cells would be neighbours twice."""

ROUNDING = 1e-6
"""Relative difference by which a length of the plane, as typed, may miss that of its rows."""


def hexagon_mesh(plane: Sequence[float], hexagons: Sequence[int], periodic: str = "xy") -> VoronoiMesh:
    """The validated mesh of regular hexagons on a plane of LX by LY metres, NX of them in each of NY rows.

    Cells are LX / NX apart and their rows sqrt(3) / 2 of that, so LY must fit NY rows: `plane` is (LX, LY) and
    `hexagons` (NX, NY). The mesh is `periodic` in "xy" or in "x", or in no direction, "none". Without a period, the
    outermost cells reach beyond the plane by as much as they leave free of it. Raises `MeshError` where LY does not
    fit, or where there are too few cells.
    """
    lengths = rectangle(plane, periodic)
    columns, rows = _counts(hexagons, periodic)
    distance = _distance(lengths, columns, rows)
    if periodic == "xy":
        return _periodic(columns, rows, distance)
    # A wider periodic mesh is cut, so that no position of what is left has been wrapped where there is no period.
    wide = columns if periodic == "x" else columns + 2
    high = rows + 2 + rows % 2
    whole = _periodic(wide, high, distance)
    row, column = np.divmod(np.arange(whole.n_cells), wide)
    kept = (row > 0) & (row <= rows)
    if periodic == "none":
        kept &= (column > 0) & (column <= columns)
    part = culled(whole, kept)
    shifts = {"y": ROW * distance, "x": 0.0 if periodic == "x" else distance}
    moved = {
        f"{axis}_{place}": getattr(part, f"{axis}_{place}") - shift
        for axis, shift in shifts.items()
        for place in ("cell", "edge", "vertex")
        if shift
    }
    mesh = replace(part, **moved, x_period=part.x_period if periodic == "x" else 0.0, y_period=0.0)
    remember_validated(mesh)
    return mesh


def _counts(hexagons: Sequence[int], periodic: str) -> tuple[int, int]:
    columns, rows = (plain_count("the number of hexagons", count) for count in pair("hexagons", hexagons))
    fewest = (FEWEST_COLUMNS if "x" in periodic else 1, FEWEST_ROWS if "y" in periodic else 1)
    for what, count, least in zip(("a row", "a column"), (columns, rows), fewest, strict=True):
        if count < least:
            raise MeshError(f"{count} hexagons in {what} are too few; a plane periodic in {periodic} needs {least}")
    if "y" in periodic and rows % 2:
        raise MeshError(
            f"{rows} rows of hexagons cannot repeat themselves in y, as every other row is shifted; take {rows + 1}"
        )
    return columns, rows


def _distance(plane: Rectangle, columns: int, rows: int) -> float:
    """The distance of cells that fit the width; raise `MeshError` unless their rows fit the height."""
    width, height = plane.width, plane.height
    distance = width / columns
    if abs(ROW * distance * rows / height - 1.0) > ROUNDING:
        fitting = height / (ROW * distance)
        nearest = max(2 * round(0.5 * fitting), FEWEST_ROWS)
        raise MeshError(
            f"{rows} rows of hexagons {distance:.10g} m apart are {ROW * distance * rows:.10g} m high, not "
            f"{height:.10g} m; give that height, or near it {nearest} rows of {ROW * distance * nearest:.10g} m"
        )
    return distance


def _periodic(columns: int, rows: int, distance: float) -> VoronoiMesh:
    """The mesh of so many columns and rows, periodic in both directions."""
    plane = Plane(columns * distance, rows * ROW * distance)
    points = _points(columns, rows, distance)
    topology = build_topology(_triangles(columns, rows), len(points), plane.handles)
    periods = {"x_period": plane.x_period, "y_period": plane.y_period}
    metrics = compute_metrics(points, topology, surface=plane)
    return validated(topology, metrics, 0.0, mesh_density=np.ones(len(points)), density_name="uniform", **periods)


def _points(columns: int, rows: int, distance: float) -> Array:
    """Centres (n, 3) row by row, those of odd rows half a distance to the east of those of even ones."""
    row, column = np.divmod(np.arange(columns * rows), columns)
    x = (column + 0.25 + 0.5 * (row % 2)) * distance
    return np.column_stack([x, (row + 0.5) * (ROW * distance), np.zeros(len(x))])


def _triangles(columns: int, rows: int) -> Index:
    """Two counter-clockwise triangles for each cell: with its eastern and an upper neighbour, and with both upper."""
    row, column = np.divmod(np.arange(columns * rows), columns)

    def number(column: Index, row: Index) -> Index:
        return (row % rows) * columns + column % columns

    own, east = number(column, row), number(column + 1, row)
    upper_east = number(column + row % 2, row + 1)
    upper_west = number(column + row % 2 - 1, row + 1)
    return np.concatenate([np.column_stack([own, east, upper_east]), np.column_stack([own, upper_east, upper_west])])

"""A map of the blocks of a partition, no two neighbours in one colour."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.geometry.sphere import from_lonlat
from mesh.partition.cell_graph import CellGraph, block_graph
from mesh.partition.colouring import proper_colours
from mesh.partition.partition import Partition
from mesh.safe_files import AnyPath, written_aside
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.maps import CENTRAL_LONGITUDE, draw_mollweide_raster
from postprocess.figures.paper import Paper, paper_of
from postprocess.figures.projections import mollweide_raster

DOTS_PER_INCH = 150
COLOURS = ("#5b8fc7", "#f4c95d", "#d9695f", "#7db87d", "#b79bd2", "#efe9dc", "#a07c5a", "#7ccfc8", "#f2a6ba", "#666666")
"""Five are usual, and six the most on a sphere whose blocks are connected."""

LEAST_CELL_WIDTH = 4.0
"""Width of a cell, dots, from which on the outlines of cells are drawn."""

MOST_POLYGONS = 200_000
"""Larger meshes, whose cells are smaller than some dots, had better be drawn by pixels: less time and memory."""

ROWS, COLUMNS = 900, 1800
REACH = 0.7
"""How far a cell reaches, of the largest distance to a neighbour; in a regular hexagon 1 / sqrt(3), else a bit more."""


def block_figure(where: VoronoiMesh | Array, graph: CellGraph, partition: Partition) -> Figure:
    """All blocks, on both hemispheres or on the plane.

    Where only the generators (n_cells, 3) are given they are on the globe, by pixels.
    """
    colours = colours_of_cells(graph, partition)
    figure = _cell_by_cell(where, colours) if isinstance(where, VoronoiMesh) else _globe(graph, where, colours)
    figure.suptitle(f"{graph.n_cells} cells in {partition.n_blocks} blocks")
    return figure


def write_block_figure(where: VoronoiMesh | Array, graph: CellGraph, partition: Partition, path: AnyPath) -> Path:
    """Write `block_figure` as PNG; return its path. Raises `OSError` where it cannot be written."""
    figure = block_figure(where, graph, partition)
    with written_aside(Path(path)) as aside:
        figure.savefig(aside, format="png", dpi=DOTS_PER_INCH)
    return Path(path)


def colours_of_cells(graph: CellGraph, partition: Partition) -> Array:
    """The number (n_cells,) of the colour of each cell's block; blocks that share an edge differ."""
    blocks = partition.block_of_cell
    colours: Array = proper_colours(block_graph(graph, blocks, partition.n_blocks))[blocks].astype(np.float64)
    return colours


def _colour_options() -> dict[str, Any]:
    return {"cmap": ListedColormap(COLOURS), "norm": BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS))}


def _outlines(paper: Paper) -> dict[str, Any]:
    """Options of the sides of cells: thin lines where cells are large enough to be seen."""
    dots = paper.width_of_cell * DOTS_PER_INCH
    return {"edgecolors": "#404040", "linewidths": min(0.02 * dots, 0.5)} if dots >= LEAST_CELL_WIDTH else {}


def _cell_by_cell(mesh: VoronoiMesh, colours: Array) -> Figure:
    paper = paper_of(mesh)
    views = paper.sides
    figure = Figure(figsize=views.size, layout="constrained")
    options = {**_colour_options(), **_outlines(paper)}
    grid = np.atleast_1d(figure.subplots(1, len(views.draw), width_ratios=views.widths))
    for axes, draw in zip(grid, views.draw, strict=True):
        draw(axes, colours, options)
    return figure


def _globe(graph: CellGraph, points: Array, colours: Array) -> Figure:
    figure = Figure(figsize=(13.0, 7.0), layout="constrained")
    values = _at_pixels(graph, points, colours).reshape(ROWS, COLUMNS)
    draw_mollweide_raster(figure.subplots(), values, {**_colour_options(), "interpolation": "nearest"})
    return figure


def _at_pixels(graph: CellGraph, points: Array, values: Array) -> Array:
    """The value of the cell in which each pixel lies; NaN where cells are missing."""
    longitude, latitude = mollweide_raster(ROWS, COLUMNS)
    distance, nearest = cKDTree(points).query(from_lonlat(longitude + CENTRAL_LONGITUDE, latitude))
    if graph.n_edges == 3 * graph.n_cells - 6:  # Euler: the whole sphere
        return values[nearest]
    cells = np.unique(nearest)
    counts, neighbours = graph.rows_of(cells)
    owners = np.repeat(cells, counts)
    reach = np.zeros(len(points))
    np.maximum.at(reach, owners, REACH * np.linalg.norm(points[owners] - points[neighbours], axis=1))
    return np.where(distance <= reach[nearest], values[nearest], np.nan)

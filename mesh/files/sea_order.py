"""Connectivity of meshes with walls in any legal order, sorted into the order that `Topology` promises.

Where cells are missing, triangles do not tell all; the cells and the vertices of the edges do. As culled files have it,
rows round a vertex may have gaps anywhere, and `edgesOnEdge` may list edges that are gone.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.conventions import BY_NAME
from mesh.discrete.connectivity import MINIMUM_RING, validate_topology
from mesh.discrete.topology import FILL, edges_beside
from mesh.discrete.validate import check_orientation
from mesh.errors import MeshError, require
from mesh.files.arrange import Arrays, require_same_entities
from mesh.geometry.surface import Surface
from mesh.voronoi_mesh import Topology

NEEDED = ("cells_on_edge", "vertices_on_edge")
OF_TANGENTS = ("n_edges_on_edge", "edges_on_edge")
CORNERS = 3


def has_walls_in(arrays: Arrays) -> bool:
    """Whether the arrays of a file are those of a mesh with walls: cells are missing at edges and at vertices."""
    return all(name in arrays and (arrays[name] == FILL).any() for name in ("cells_on_edge", "cells_on_vertex"))


def arranged_sea(arrays: Arrays, points: Array, vertices: Array, surface: Surface) -> Topology:
    """The topology of a mesh with walls, rings at their lowest edges, of generators and vertices (n, 3) on a surface.

    Raises `MeshError` where edges form no rings, or where any other array holds other entities.
    """
    cells_on_edge, vertices_on_edge = _cells_first(arrays, len(points), len(vertices))
    edges_on_cell, counts = _edges_of_cells(cells_on_edge, len(points))
    closed = _chain(edges_on_cell, counts, vertices_on_edge, vertices_on_cell := np.full_like(edges_on_cell, FILL))
    require(closed, "cells", "the edges that cellsOnEdge gives to the cell form no ring by their verticesOnEdge")
    _turn_counter_clockwise(surface, points, vertices, edges_on_cell, vertices_on_cell, counts)
    ends = np.where(edges_on_cell[..., None] == FILL, FILL, cells_on_edge[edges_on_cell])
    own = np.arange(len(points))[:, None]
    cells_on_cell = np.where(ends[..., 0] == own, ends[..., 1], ends[..., 0])
    cells_on_vertex, edges_on_vertex, fits = _round_vertices(
        arrays["cells_on_vertex"], edges_on_cell, vertices_on_cell, counts
    )
    require(fits, "vertices", "cellsOnVertex holds other cells than those of the edges that end at the vertex")
    n_edges_on_edge, edges_on_edge = edges_beside(edges_on_cell, counts, cells_on_edge)
    topology = Topology(
        n_edges_on_cell=counts,
        cells_on_cell=cells_on_cell.astype(np.int32),
        edges_on_cell=edges_on_cell,
        vertices_on_cell=vertices_on_cell,
        n_edges_on_edge=n_edges_on_edge,
        edges_on_edge=edges_on_edge,
        cells_on_edge=cells_on_edge,
        vertices_on_edge=_along_tangents(cells_on_edge, edges_on_cell, vertices_on_cell, counts),
        cells_on_vertex=cells_on_vertex,
        edges_on_vertex=edges_on_vertex,
        boundary_vertex=(cells_on_vertex.min(axis=1) < 0).astype(np.int32),
    )
    if "n_edges_on_cell" in arrays:
        same = arrays["n_edges_on_cell"] == counts
        require(same, "cells", "nEdgesOnCell is not the number of edges that cellsOnEdge gives; correct or remove it")
    require_same_entities({name: arrays[name] for name in arrays if name not in OF_TANGENTS}, topology)
    validate_topology(topology, surface.handles)
    check_orientation(points, topology, surface)
    return topology


def arrange_sea_weights(weights: Array, arrays: Arrays, topology: Topology, exact: Array) -> Array:
    """Weights (n_edges, 2 max_edges) of a file in the order of `topology`; those from and to walls are `exact`.

    They act on no flow, and the culler leaves them as they were before normals were turned. Where the vertices of an
    edge stood against the tangent, its weights may be those of the tangent turned round: those of which the signs agree
    with `exact`, what the generators give, are meant.
    """
    result = exact.copy()
    inner = topology.cells_on_edge[:, 1] != FILL
    found = _take_weights(weights, arrays["edges_on_edge"], topology.edges_on_edge, inner, result)
    require(found, "edges", "edgesOnEdge lacks edges of the two cells; correct the file or remove its weightsOnEdge")
    turned = arrays["vertices_on_edge"][:, 0] != topology.vertices_on_edge[:, 0]
    with np.errstate(invalid="ignore"):  # what is not finite is refused later
        against = (result * exact).sum(axis=1) < 0.0
    result[inner & turned & against] *= -1.0
    return result


def _cells_first(arrays: Arrays, n_cells: int, n_vertices: int) -> tuple[Index, Index]:
    """Cells and vertices (n_edges, 2) of the edges, walls with their cell first."""
    missing = [BY_NAME[name].file_name for name in NEEDED if name not in arrays]
    if missing:
        raise MeshError(
            f"{' and '.join(missing)} missing: a mesh with walls must say which cells and vertices an edge has"
        )
    cells, vertices = (arrays[name] for name in NEEDED)
    for name, values, size, lowest in zip(NEEDED, (cells, vertices), (n_cells, n_vertices), (FILL, 0), strict=True):
        label = BY_NAME[name].file_name
        require((values >= lowest) & (values < size), "edges", f"{label} holds an index outside 1 to {size}")
        require(values[:, 0] != values[:, 1], "edges", f"{label} names one entity twice, or none")
    second = cells[:, :1] == FILL
    return np.where(second, cells[:, ::-1], cells), vertices


def _edges_of_cells(cells_on_edge: Index, n_cells: int) -> tuple[Index, Index]:
    """The edges (n_cells, width) of each cell, ascending, and their number (n_cells,)."""
    there = np.flatnonzero(cells_on_edge.ravel() != FILL)
    cells = cells_on_edge.ravel()[there]
    counts = np.bincount(cells, minlength=n_cells).astype(np.int32)
    require(counts >= MINIMUM_RING, "cells", f"cellsOnEdge gives the cell fewer than {MINIMUM_RING} edges")
    order = np.argsort(cells, kind="stable")
    place = np.arange(len(cells)) - np.repeat(np.cumsum(counts) - counts, counts)
    edges = np.full((n_cells, int(counts.max())), FILL, np.int32)
    edges[cells[order], place] = there[order] // 2
    return edges, counts


@numba.njit(cache=True)
def _chain(edges: Index, counts: Index, vertices_on_edge: Index, vertices: Index) -> NDArray[np.bool_]:
    """Put the `edges` of each cell in a ring from the first, vertices after them in `vertices`; whether it fits."""
    closed = np.ones(len(edges), np.bool_)
    for cell in range(len(edges)):
        at, count = vertices_on_edge[edges[cell, 0], 1], counts[cell]
        vertices[cell, 0] = at
        for place in range(1, count):
            other = place
            while (
                other < count
                and at != vertices_on_edge[edges[cell, other], 0]
                and (at != vertices_on_edge[edges[cell, other], 1])
            ):
                other += 1
            if other == count:
                closed[cell] = False
                break
            edge = edges[cell, other]
            edges[cell, other] = edges[cell, place]
            edges[cell, place] = edge
            at = vertices_on_edge[edge, 0] + vertices_on_edge[edge, 1] - at
            vertices[cell, place] = at
        closed[cell] &= at == vertices_on_edge[edges[cell, 0], 0]
    return closed


def _turn_counter_clockwise(
    surface: Surface, points: Array, corners: Array, edges: Index, vertices: Index, counts: Index
) -> None:
    """Turn the rings round, in place, whose vertices run clockwise round their generators; the first edge stays."""
    place = np.arange(edges.shape[1])
    used = place < counts[:, None]
    spokes = np.where(used[..., None], surface.shortest(corners[vertices] - points[:, None, :]), 0.0)
    before = np.where(place == 0, counts[:, None] - 1, place - 1)
    turn = np.cross(np.take_along_axis(spokes, before[..., None], axis=1), spokes).sum(axis=1)
    clockwise = np.flatnonzero((turn * surface.outward(points)).sum(axis=1) < 0.0)
    back = np.where(used, (counts[:, None] - place) % counts[:, None], place)[clockwise]
    edges[clockwise] = np.take_along_axis(edges[clockwise], back, axis=1)
    back = np.where(used, counts[:, None] - 1 - place, place)[clockwise]
    vertices[clockwise] = np.take_along_axis(vertices[clockwise], back, axis=1)


@numba.njit(cache=True)
def _along_tangents(cells_on_edge: Index, edges: Index, vertices: Index, counts: Index) -> Index:
    """Vertices (n_edges, 2) of the edges in the sense of the ring of their first cells."""
    ends = np.empty(cells_on_edge.shape, np.int32)
    for cell in range(len(edges)):
        for place in range(counts[cell]):
            edge = edges[cell, place]
            if cells_on_edge[edge, 0] == cell:
                ends[edge, 0] = vertices[cell, place - 1 if place > 0 else counts[cell] - 1]
                ends[edge, 1] = vertices[cell, place]
    return ends


@numba.njit(cache=True)
def _round_vertices(
    given: Index, edges: Index, vertices: Index, counts: Index
) -> tuple[Index, Index, NDArray[np.bool_]]:
    """Cells and edges (n_vertices, 3) round each vertex, the first cell where it is `given`; and whether all fit.

    The way round a vertex crosses a cell from the edge after the vertex in the ring to the edge before it.
    """
    n_vertices = len(given)
    number = np.zeros(n_vertices, np.int32)
    sectors = np.full((n_vertices, CORNERS, 3), FILL, np.int32)
    fits = np.ones(n_vertices, np.bool_)
    for cell in range(len(edges)):
        for place in range(counts[cell]):
            vertex = vertices[cell, place]
            if number[vertex] == CORNERS:
                fits[vertex] = False
                continue
            following = edges[cell, place + 1 if place + 1 < counts[cell] else 0]
            sector = sectors[vertex, number[vertex]]
            sector[0], sector[1], sector[2] = cell, following, edges[cell, place]
            number[vertex] += 1
    cells_on_vertex = np.full((n_vertices, CORNERS), FILL, np.int32)
    edges_on_vertex = np.full((n_vertices, CORNERS), FILL, np.int32)
    for vertex in range(n_vertices):
        placed = 0
        for corner in range(CORNERS):
            for sector in sectors[vertex]:
                if placed == 0 and sector[0] != FILL and sector[0] == given[vertex, corner]:
                    placed = _place(cells_on_vertex[vertex], edges_on_vertex[vertex], corner, sector)
        for _ in range(CORNERS):
            for corner in range(CORNERS):
                for sector in sectors[vertex]:
                    after = edges_on_vertex[vertex, (corner + 1) % CORNERS]
                    follows = after != FILL and after == sector[1]
                    precedes = edges_on_vertex[vertex, corner] != FILL and edges_on_vertex[vertex, corner] == sector[2]
                    beside = (corner + 1) % CORNERS if follows else (corner + CORNERS - 1) % CORNERS
                    if (follows or precedes) and sector[0] != FILL and cells_on_vertex[vertex, beside] == FILL:
                        placed += _place(cells_on_vertex[vertex], edges_on_vertex[vertex], beside, sector)
        fits[vertex] &= placed == number[vertex] and placed > 0
    return cells_on_vertex, edges_on_vertex, fits


@numba.njit(cache=True)
def _place(cells: Index, edges: Index, corner: int, sector: Index) -> int:
    """Put a cell and the edges on both sides of it into the rows of a vertex; one cell is placed."""
    cells[corner] = sector[0]
    edges[corner] = sector[1]
    edges[(corner + 1) % CORNERS] = sector[2]
    return 1


@numba.njit(cache=True)
def _take_weights(
    weights: Array, listed: Index, wanted: Index, inner: NDArray[np.bool_], result: Array
) -> NDArray[np.bool_]:
    """Put the weights of the edges `listed` where they are `wanted`, inner ones alone; whether all were found."""
    found = np.ones(len(wanted), np.bool_)
    for edge in range(len(wanted)):
        for place in range(wanted.shape[1]):
            other = wanted[edge, place]
            if not inner[edge] or other == FILL or not inner[other]:
                continue
            source = 0
            while source < listed.shape[1] and listed[edge, source] != other:
                source += 1
            if source == listed.shape[1]:
                found[edge] = False
            else:
                result[edge, place] = weights[edge, source]
    return found

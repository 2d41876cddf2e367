"""From triangles to consistently ordered cells, edges and vertices: the only place that sorts connectivity."""

import numba
import numpy as np

from mesh.arrays import Index
from mesh.errors import MeshError, require
from mesh.triangulation.half_edges import build_twins
from mesh.triangulation.ordering import sort_triangles
from mesh.voronoi_mesh import Topology

FILL = -1


def build_topology(triangles: Index, n_cells: int, handles: int = 0) -> Topology:
    """Connectivity of the Voronoi mesh that is dual to counter-clockwise `triangles` (n_vertices, 3).

    Vertices and edges are numbered after their lowest cells, whatever the order of the triangles, so the result
    depends on the triangulation alone. Raises `MeshError` where the triangles do not close a sphere, or a surface of so
    many `handles` (`mesh.geometry.surface`).
    """
    needed = 2 * n_cells - 4 + 4 * handles
    if len(triangles) != needed:
        closed = "the plane" if handles else "the sphere"
        raise MeshError(f"{n_cells} cells need {needed} triangles to close {closed}, not {len(triangles)}")
    for corner in (np.min(triangles), np.max(triangles)):
        if not 0 <= corner < n_cells:
            raise MeshError(f"a triangle has corner {corner}, but the generators are numbered 0 to {n_cells - 1}")
    triangles = sort_triangles(triangles)
    return connect(triangles, n_cells)


def connect(triangles: Index, n_cells: int, cells_on_edge: Index | None = None) -> Topology:
    """Connectivity of the mesh that is dual to these triangles, with vertices numbered as they stand.

    Edges have the numbers and directions of `cells_on_edge` (n_edges, 2) where that is given, else they are numbered
    after their lowest cells. Rings start at their lowest edge, and `triangles` must start at their lowest cell. Raises
    `MeshError` where the triangles do not close a sphere, or `cells_on_edge` does not list their sides.
    """
    triangles = _index(triangles)
    twins = build_twins(triangles, n_cells).ravel()
    if not _are_mutual(twins):
        raise MeshError("some side of a triangle lies between more than two triangles")
    if cells_on_edge is None:
        forward = _forward_half_edges(triangles, twins, n_cells)
        if 2 * len(forward) != len(twins):
            raise MeshError("some triangle has one generator at two of its corners")
    else:
        forward = _find_half_edges(triangles, twins, cells_on_edge)
    edge_of = _edge_of_half_edges(forward, twins)
    first, n_edges_on_cell = _ring_starts(triangles, twins, edge_of, n_cells)
    cells, edges, vertices = _rings(triangles, twins, edge_of, first, n_edges_on_cell, int(n_edges_on_cell.max()))
    cells_on_edge, vertices_on_edge = _ends(triangles, twins, forward)
    n_edges_on_edge, edges_on_edge = edges_beside(edges, n_edges_on_cell, cells_on_edge)
    return Topology(
        n_edges_on_cell=n_edges_on_cell,
        cells_on_cell=cells,
        edges_on_cell=edges,
        vertices_on_cell=vertices,
        n_edges_on_edge=n_edges_on_edge,
        edges_on_edge=edges_on_edge,
        cells_on_edge=cells_on_edge,
        vertices_on_edge=vertices_on_edge,
        cells_on_vertex=triangles,
        edges_on_vertex=_index(np.roll(edge_of.reshape(-1, 3), -1, axis=1)),
        boundary_vertex=np.zeros(len(triangles), dtype=np.int32),
    )


def _index(array: Index) -> Index:
    return np.ascontiguousarray(array, dtype=np.int32)


@numba.njit(cache=True)
def _start(triangles: Index, half_edge: int) -> int:
    """The cell that a half-edge leaves: it lies opposite to corner k and runs from corner k + 1."""
    triangle = half_edge // 3
    return triangles[triangle, (half_edge - 3 * triangle + 1) % 3]


@numba.njit(cache=True)
def _next_round_start(twins: Index, half_edge: int) -> int:
    """The half-edge that leaves the same cell next, counter-clockwise.

    The one before it in its triangle ends at that cell, so the twin of that one leaves it.
    """
    return twins[half_edge + 2 if half_edge % 3 == 0 else half_edge - 1]


@numba.njit(cache=True)
def _are_mutual(twins: Index) -> bool:
    """Whether every half-edge is the twin of its twin."""
    mutual = True
    for half_edge in range(len(twins)):
        mutual &= twins[twins[half_edge]] == half_edge
    return mutual


@numba.njit(cache=True)
def _forward_half_edges(triangles: Index, twins: Index, n_cells: int) -> Index:
    """Of every edge the half-edge from the lower to the higher cell, in the order of these.

    They are dealt out by their lower cell, and each is inserted where its higher cell belongs.
    """
    filled = np.zeros(n_cells + 1, np.int32)
    for half_edge in range(len(twins)):
        start = _start(triangles, half_edge)
        if start < _start(triangles, twins[half_edge]):
            filled[start + 1] += 1
    for cell in range(n_cells):
        filled[cell + 1] += filled[cell]
    firsts = filled.copy()
    forward = np.empty(firsts[n_cells], np.int32)
    for half_edge in range(len(twins)):
        start, end = _start(triangles, half_edge), _start(triangles, twins[half_edge])
        if start < end:
            slot = filled[start]
            while slot > firsts[start] and _start(triangles, twins[forward[slot - 1]]) > end:
                forward[slot] = forward[slot - 1]
                slot -= 1
            forward[slot] = half_edge
            filled[start] += 1
    return forward


def _find_half_edges(triangles: Index, twins: Index, cells_on_edge: Index) -> Index:
    """Of every edge the half-edge from its first to its second cell."""
    start = np.roll(triangles, -1, axis=1).ravel().astype(np.int64)  # squares of numbers of cells have 64 bits
    size = start.max() + 1
    keys = start * size + start[twins]
    order = np.argsort(keys)
    wanted = cells_on_edge[:, 0] * size + cells_on_edge[:, 1]
    place = np.minimum(np.searchsorted(keys[order], wanted), len(order) - 1)
    require(keys[order[place]] == wanted, "edges", "cellsOnEdge names two cells that share no side in cellsOnVertex")
    return _index(order[place])


def _edge_of_half_edges(forward: Index, twins: Index) -> Index:
    """Edge number of every half-edge, where `forward` has one of the two half-edges of each edge."""
    edge = np.arange(len(forward), dtype=np.int32)
    edge_of = np.empty(len(twins), dtype=np.int32)
    edge_of[forward] = edge
    edge_of[twins[forward]] = edge
    require(edge_of[forward] == edge, "edges", "cellsOnEdge names the same two cells as another edge")
    return edge_of


def _ring_starts(triangles: Index, twins: Index, edge_of: Index, n_cells: int) -> tuple[Index, Index]:
    """Of every cell the outgoing half-edge of its lowest edge (n_cells,), and the number of edges round it (n_cells,).

    Raises `MeshError` where there is none, or where the edges of a cell form more than one ring.
    """
    first = _lowest_half_edges(triangles, edge_of, n_cells)
    if np.any(first == FILL):
        raise MeshError(f"generators {np.flatnonzero(first == FILL)[:5].tolist()} belong to no triangle")
    counts = _ring_lengths(twins, first)
    if counts.sum() != len(twins):
        raise MeshError("the triangles round some generator do not form one closed ring")
    return first, counts


@numba.njit(cache=True)
def _lowest_half_edges(triangles: Index, edge_of: Index, n_cells: int) -> Index:
    """Of every cell the outgoing half-edge of its lowest edge, `FILL` where there is none."""
    first = np.full(n_cells, FILL, np.int32)
    for half_edge in range(len(edge_of)):
        cell = _start(triangles, half_edge)
        if first[cell] == FILL or edge_of[half_edge] < edge_of[first[cell]]:
            first[cell] = half_edge
    return first


@numba.njit(cache=True, parallel=True)
def _ring_lengths(twins: Index, first: Index) -> Index:
    """Number (n_cells,) of half-edges on the way round each cell from its first one back to that."""
    counts = np.empty(len(first), np.int32)
    for cell in numba.prange(len(first)):
        count, going = 1, _next_round_start(twins, first[cell])
        while going != first[cell]:
            going = _next_round_start(twins, going)
            count += 1
        counts[cell] = count
    return counts


@numba.njit(cache=True, parallel=True)
def _rings(
    triangles: Index, twins: Index, edge_of: Index, first: Index, counts: Index, width: int
) -> tuple[Index, Index, Index]:
    """Cells across, edges and vertices (n_cells, width) of each ring, counter-clockwise from its first half-edge."""
    cells = np.full((len(first), width), FILL, np.int32)
    edges = np.full((len(first), width), FILL, np.int32)
    vertices = np.full((len(first), width), FILL, np.int32)
    for cell in numba.prange(len(first)):
        going = first[cell]
        for place in range(counts[cell]):
            cells[cell, place] = _start(triangles, twins[going])
            edges[cell, place] = edge_of[going]
            vertices[cell, place] = going // 3
            going = _next_round_start(twins, going)
    return cells, edges, vertices


@numba.njit(cache=True, parallel=True)
def _ends(triangles: Index, twins: Index, forward: Index) -> tuple[Index, Index]:
    """Cells (n_edges, 2) at start and end of each forward half-edge, and vertices (n_edges, 2) right and left of it."""
    cells = np.empty((len(forward), 2), np.int32)
    vertices = np.empty((len(forward), 2), np.int32)
    for edge in numba.prange(len(forward)):
        twin = twins[forward[edge]]
        cells[edge, 0], cells[edge, 1] = _start(triangles, forward[edge]), _start(triangles, twin)
        vertices[edge, 0], vertices[edge, 1] = twin // 3, forward[edge] // 3
    return cells, vertices


@numba.njit(cache=True, parallel=True)
def edges_beside(edges_on_cell: Index, n_edges_on_cell: Index, cells_on_edge: Index) -> tuple[Index, Index]:
    """Number and list of the edges round the cells of each edge, `FILL` for one that is missing, but for the edge."""
    n_edges, max_edges = len(cells_on_edge), edges_on_cell.shape[1]
    counts = np.empty(n_edges, np.int32)
    result = np.full((n_edges, 2 * max_edges), FILL, np.int32)
    for edge in numba.prange(n_edges):
        count = 0
        for side in range(2):
            cell = cells_on_edge[edge, side]
            if cell == FILL:
                continue
            place = 0
            while edges_on_cell[cell, place] != edge:
                place += 1
            for _ in range(n_edges_on_cell[cell] - 1):
                place = place + 1 if place + 1 < n_edges_on_cell[cell] else 0
                result[edge, count] = edges_on_cell[cell, place]
                count += 1
        counts[edge] = count
    return counts, result

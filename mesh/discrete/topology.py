"""From triangles to consistently ordered cells, edges and vertices: the only place that sorts connectivity."""

import numpy as np

from mesh.arrays import Index
from mesh.errors import MeshError, require
from mesh.triangulation.half_edges import build_twins
from mesh.triangulation.ordering import sort_triangles
from mesh.voronoi_mesh import Topology

FILL = -1


def build_topology(triangles: Index, n_cells: int) -> Topology:
    """Connectivity of the Voronoi mesh that is dual to counter-clockwise `triangles` (n_vertices, 3).

    Vertices and edges are numbered after their lowest cells, whatever the order of the triangles, so the result
    depends on the triangulation alone. Raises `MeshError` where the triangles do not close a sphere.
    """
    triangles = sort_triangles(triangles)
    if len(triangles) != 2 * n_cells - 4:
        raise MeshError(f"{n_cells} cells need {2 * n_cells - 4} triangles to close the sphere, not {len(triangles)}")
    return connect(triangles, n_cells)


def connect(triangles: Index, n_cells: int, cells_on_edge: Index | None = None) -> Topology:
    """Connectivity of the mesh that is dual to these triangles, with vertices numbered as they stand.

    Edges have the numbers and directions of `cells_on_edge` (n_edges, 2) where that is given, else they are numbered
    after their lowest cells. Rings start at their lowest edge, and `triangles` must start at their lowest cell. Raises
    `MeshError` where the triangles do not close a sphere, or `cells_on_edge` does not list their sides.
    """
    twins = build_twins(triangles, n_cells).ravel()
    if not np.array_equal(twins[twins], np.arange(len(twins))):
        raise MeshError("some side of a triangle lies between more than two triangles")
    start = np.roll(triangles, -1, axis=1).ravel()
    end = start[twins]
    forward = _forward_half_edges(start, end) if cells_on_edge is None else _find_half_edges(start, end, cells_on_edge)
    edge_of = _edge_of_half_edges(forward, twins)
    left, right = forward // 3, twins[forward] // 3

    rings = _rings(start, twins, edge_of, n_cells)
    filled = rings != FILL
    edges_on_cell = np.where(filled, edge_of[rings], FILL)
    n_edges_on_cell = filled.sum(axis=1)
    cells_on_edge = np.stack([start[forward], end[forward]], axis=1)
    n_edges_on_edge, edges_on_edge = _edges_on_edge(edges_on_cell, n_edges_on_cell, cells_on_edge)
    return Topology(
        n_edges_on_cell=_index(n_edges_on_cell),
        cells_on_cell=_index(np.where(filled, end[rings], FILL)),
        edges_on_cell=_index(edges_on_cell),
        vertices_on_cell=_index(np.where(filled, rings // 3, FILL)),
        n_edges_on_edge=_index(n_edges_on_edge),
        edges_on_edge=_index(edges_on_edge),
        cells_on_edge=_index(cells_on_edge),
        vertices_on_edge=_index(np.stack([right, left], axis=1)),
        cells_on_vertex=_index(triangles),
        edges_on_vertex=_index(np.roll(edge_of.reshape(-1, 3), -1, axis=1)),
        boundary_vertex=np.zeros(len(triangles), dtype=np.int32),
    )


def _index(array: Index) -> Index:
    return np.ascontiguousarray(array, dtype=np.int32)


def _forward_half_edges(start: Index, end: Index) -> Index:
    """Of every edge the half-edge from the lower to the higher cell, in the order of these."""
    forward = np.flatnonzero(start < end)
    return forward[np.lexsort((end[forward], start[forward]))]


def _find_half_edges(start: Index, end: Index, cells_on_edge: Index) -> Index:
    """Of every edge the half-edge from its first to its second cell."""
    size = np.int64(start.max()) + 1
    keys = start * size + end
    order = np.argsort(keys)
    wanted = cells_on_edge[:, 0] * size + cells_on_edge[:, 1]
    place = np.minimum(np.searchsorted(keys[order], wanted), len(order) - 1)
    require(keys[order[place]] == wanted, "edges", "cellsOnEdge names two cells that share no side in cellsOnVertex")
    return order[place]


def _edge_of_half_edges(forward: Index, twins: Index) -> Index:
    """Edge number of every half-edge, where `forward` has one of the two half-edges of each edge."""
    edge = np.arange(len(forward))
    edge_of = np.empty(len(twins), dtype=np.int64)
    edge_of[forward] = edge
    edge_of[twins[forward]] = edge
    require(edge_of[forward] == edge, "edges", "cellsOnEdge names the same two cells as another edge")
    return edge_of


def _rings(start: Index, twins: Index, edge_of: Index, n_cells: int) -> Index:
    """Outgoing half-edges (n_cells, max_edges) of each cell, counter-clockwise from its lowest edge."""
    by_edge = np.argsort(edge_of, kind="stable")[::-1]
    first = np.full(n_cells, FILL, dtype=np.int64)
    first[start[by_edge]] = by_edge
    if np.any(first == FILL):
        raise MeshError(f"generators {np.flatnonzero(first == FILL)[:5].tolist()} belong to no triangle")
    half_edges = np.arange(len(start))
    # The half-edge before h in its triangle ends at the start of h, so its twin leaves that cell next in turn.
    following = twins[half_edges + np.where(half_edges % 3 == 0, 2, -1)]
    columns = [first]
    going = first
    while True:
        going = np.where(going == FILL, FILL, following[going])
        going = np.where(going == first, FILL, going)
        if np.all(going == FILL):
            break
        columns.append(going)
    rings = np.stack(columns, axis=1)
    if np.count_nonzero(rings != FILL) != len(start):
        raise MeshError("the triangles round some generator do not form one closed ring")
    return rings


def _edges_on_edge(edges_on_cell: Index, n_edges_on_cell: Index, cells_on_edge: Index) -> tuple[Index, Index]:
    """Number and list of the edges round both cells of each edge, the edge itself left out."""
    n_edges, max_edges = len(cells_on_edge), edges_on_cell.shape[1]
    edge = np.arange(n_edges)
    size = n_edges_on_cell[cells_on_edge]
    result = np.full((n_edges, 2 * max_edges), FILL, dtype=np.int64)
    for side in (0, 1):
        ring = edges_on_cell[cells_on_edge[:, side]]
        position = np.argmax(ring == edge[:, None], axis=1)
        offset = np.zeros(n_edges, dtype=np.int64) if side == 0 else size[:, 0] - 1
        for step in range(1, max_edges):
            inside = step < size[:, side]
            neighbour = ring[edge, (position + step) % size[:, side]]
            result[edge[inside], (offset + step - 1)[inside]] = neighbour[inside]
    return size.sum(axis=1) - 2, result

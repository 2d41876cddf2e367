"""Connectivity of the mesh of clipped cells: their portions of the coast are edges with one cell."""

import numpy as np

from mesh.arrays import Index
from mesh.coast.corners import COAST, Corners, corners_of, following_rows, preceding_rows
from mesh.coast.sea_cells import SeaCells
from mesh.discrete.topology import FILL, edges_beside
from mesh.voronoi_mesh import Topology


def sea_topology(sea: SeaCells) -> tuple[Topology, Index]:
    """The connectivity, and the places (n_vertices,) of its vertices among `SeaCells.circumcenters`.

    At a vertex on the coast meet the cell that the coast enters there, the cell that it leaves, and no third one; the
    edge between them and two edges of the coast. At a corner of the coast itself there is one cell. Vertices and edges
    are numbered after their lowest cells. Raises `MeshError` as `corners_of` does.
    """
    corners = corners_of(sea)
    places, cells_on_vertex, vertex_of = _vertices(sea, corners)
    return connected(corners, cells_on_vertex, vertex_of), places


def connected(corners: Corners, cells_on_vertex: Index, vertex_of: Index) -> Topology:
    """The connectivity of cells with these corners, whose vertices are `vertex_of` (n_corners,).

    `cells_on_vertex` (n_vertices, 3) are counter-clockwise; at the boundary they are the cell that it enters there,
    with the sea to its left, the one that it leaves, and none. Edges are numbered after their lowest cells.
    """
    cells_on_edge, edge_of = _edges(corners)
    cell_rings = _rings(corners, edge_of, vertex_of)
    sizes, across, edges, vertices = cell_rings
    n_edges_on_edge, edges_on_edge = edges_beside(edges, sizes, cells_on_edge)
    following = following_rows(corners.starts)
    first = np.zeros(len(cells_on_edge), np.int64)
    rows = np.flatnonzero(cells_on_edge[edge_of, 0] == corners.cells)
    first[edge_of[rows]] = rows
    return Topology(
        n_edges_on_cell=sizes,
        cells_on_cell=across,
        edges_on_cell=edges,
        vertices_on_cell=vertices,
        n_edges_on_edge=n_edges_on_edge,
        edges_on_edge=edges_on_edge,
        cells_on_edge=cells_on_edge,
        vertices_on_edge=np.stack([vertex_of[first], vertex_of[following[first]]], axis=1),
        cells_on_vertex=cells_on_vertex,
        edges_on_vertex=_edges_on_vertex(corners, cells_on_vertex, vertex_of, edge_of),
        boundary_vertex=(cells_on_vertex[:, 2] == FILL).astype(np.int32),
    )


def _vertices(sea: SeaCells, corners: Corners) -> tuple[Index, Index, Index]:
    """Places (n_vertices,) of the vertices, the cells (n_vertices, 3) at each, and the vertex of every corner."""
    used, first, inverse = np.unique(corners.places, return_index=True, return_inverse=True)
    inner, crossed = used < sea.n_triangles, used >= sea.n_triangles + sea.n_coast
    cells = np.full((len(used), 3), FILL, np.int32)
    triangles = sea.triangles[used[inner]]
    turn = np.argmin(triangles, axis=1)[:, None] + np.arange(3)
    cells[inner] = np.take_along_axis(triangles, turn % 3, axis=1)
    cells[crossed, :2] = sea.crossing_cells[used[crossed] - sea.n_triangles - sea.n_coast, ::-1]
    alone = ~(inner | crossed)
    cells[alone, 0] = corners.cells[first[alone]]
    lowest, second = np.sort(np.where(cells == FILL, sea.n_cells, cells), axis=1)[:, :2].T
    order = np.lexsort((used, second, lowest))
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return used[order], cells[order], rank[inverse]


def _edges(corners: Corners) -> tuple[Index, Index]:
    """Cells (n_edges, 2) of the edges, the lower one first and none last, and the edge of the side after each corner.

    Portions of the coast come last among the edges of their cell.
    """
    n_cells, rows = len(corners.starts) - 1, np.arange(len(corners.cells))
    coast = corners.neighbours == COAST
    other = np.where(coast, n_cells + rows, corners.neighbours)
    pairs = np.stack([np.minimum(corners.cells, other), np.maximum(corners.cells, other)], axis=1)
    keys = pairs[:, 0].astype(np.int64) * (n_cells + len(rows)) + pairs[:, 1]
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    cells = pairs[first].astype(np.int32)
    cells[cells >= n_cells] = FILL
    return cells, inverse.astype(np.int32)


def _rings(corners: Corners, edge_of: Index, vertex_of: Index) -> tuple[Index, Index, Index, Index]:
    """Sizes (n_cells,), and the cells across, edges and vertices (n_cells, max_edges), each from its lowest edge on."""
    sizes = np.diff(corners.starts).astype(np.int32)
    before = preceding_rows(corners.starts)
    lowest = np.minimum.reduceat(edge_of[before], corners.starts[:-1])
    begins = np.flatnonzero(edge_of[before] == np.repeat(lowest, sizes)) - corners.starts[:-1]
    place = np.arange(sizes.max())
    on_ring = place < sizes[:, None]
    turned = (begins[:, None] + place) % sizes[:, None]
    rows = np.where(on_ring, corners.starts[:-1, None] + turned, 0)
    across, edges, vertices = (
        np.where(on_ring, values[rows], FILL).astype(np.int32)
        for values in (corners.neighbours[before], edge_of[before], vertex_of)
    )
    return sizes, across, edges, vertices


def _edges_on_vertex(corners: Corners, cells_on_vertex: Index, vertex_of: Index, edge_of: Index) -> Index:
    """Edges (n_vertices, 3): the one that goes on round cell j of a vertex, then the one that came round it."""
    edges = np.full(cells_on_vertex.shape, FILL, np.int32)
    place = np.argmax(cells_on_vertex[vertex_of] == corners.cells[:, None], axis=1)
    edges[vertex_of, place] = edge_of
    edges[vertex_of, (place + 1) % 3] = edge_of[preceding_rows(corners.starts)]
    return edges

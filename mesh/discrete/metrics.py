"""Positions, lengths, areas and angles of a Voronoi mesh on the unit sphere."""

import numpy as np

from mesh.arrays import Array, Index, sum_by_index
from mesh.discrete.weights import tangential_weights
from mesh.geometry.sphere import (
    arc_length,
    circumcenter,
    dot,
    east_north,
    normalize,
    to_lonlat,
    triangle_area,
)
from mesh.voronoi_mesh import Metrics, Topology


def compute_metrics(points: Array, topology: Topology) -> Metrics:
    """All metrics of the mesh with generators `points` (n_cells, 3), unit vectors, and the given connectivity.

    Vertices are the circumcentres of the triangles; an edge's point is the midpoint of the arc between its
    cells, where the two arcs of the edge cross. Kites have signed areas, so that they sum to their triangle
    even where a circumcentre lies outside; the area of a cell is the sum of its kites.
    """
    vertices = circumcenter(*(points[topology.cells_on_vertex[:, k]] for k in range(3)))
    centers = points[topology.cells_on_edge]
    edges = normalize(centers[:, 0] + centers[:, 1])
    kites = kite_areas(points, edges, vertices, topology.cells_on_vertex, topology.edges_on_vertex)
    area_cell = sum_by_index(topology.cells_on_vertex, kites, len(points))
    dc_edge = arc_length(centers[:, 0], centers[:, 1])
    ends = vertices[topology.vertices_on_edge]
    dv_edge = arc_length(ends[:, 0], ends[:, 1])
    return Metrics(
        **_coordinates("cell", points),
        **_coordinates("edge", edges),
        **_coordinates("vertex", vertices),
        dc_edge=dc_edge,
        dv_edge=dv_edge,
        angle_edge=edge_angles(centers[:, 1] - centers[:, 0], *to_lonlat(edges)),
        area_cell=area_cell,
        area_triangle=kites.sum(axis=1),
        kite_areas_on_vertex=kites,
        weights_on_edge=tangential_weights(topology, kites, area_cell, dc_edge, dv_edge),
    )


def edge_angles(normal: Array, lon_edge: Array, lat_edge: Array) -> Array:
    """Angles (n_edges,) of normals (n_edges, 3), counter-clockwise from east at the given position, in [-pi, pi]."""
    east, north = east_north(lon_edge, lat_edge)
    return np.arctan2(dot(normal, north), dot(normal, east))


def kite_areas(points: Array, edges: Array, vertices: Array, cells_on_vertex: Index, edges_on_vertex: Index) -> Array:
    """Signed areas (n_vertices, 3) of the parts of triangle v in its three cells.

    Kite j runs counter-clockwise from the vertex to edge j, to cell j, to edge j + 1.
    """
    kites = np.empty((len(vertices), 3))
    for j in range(3):
        cell = points[cells_on_vertex[:, j]]
        before = edges[edges_on_vertex[:, j]]
        after = edges[edges_on_vertex[:, (j + 1) % 3]]
        kites[:, j] = triangle_area(cell, vertices, before) + triangle_area(cell, after, vertices)
    return kites


def _coordinates(place: str, points: Array) -> dict[str, Array]:
    """The five coordinate arrays of one kind of entity, by name."""
    lon, lat = to_lonlat(points)
    x, y, z = np.ascontiguousarray(points.T)
    return {f"x_{place}": x, f"y_{place}": y, f"z_{place}": z, f"lat_{place}": lat, f"lon_{place}": lon}

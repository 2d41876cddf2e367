"""Positions, lengths, areas and angles of a Voronoi mesh on the unit sphere."""

import numpy as np

from mesh.arrays import Array, Index, by_blocks, row_loop, sum_by_index
from mesh.discrete.weights import tangential_weights
from mesh.geometry.sphere import (
    arc_length,
    circumcenter,
    dot,
    east_north,
    normalize,
    to_lonlat,
)
from mesh.geometry.vectors import area_parts, vector_to
from mesh.voronoi_mesh import Metrics, Topology


def compute_metrics(points: Array, topology: Topology) -> Metrics:
    """All metrics of the mesh with generators `points` (n_cells, 3), unit vectors, and the given connectivity.

    Vertices are the circumcentres of the triangles; an edge's point is the midpoint of the arc between its
    cells, where the two arcs of the edge cross. Kites have signed areas, so that they sum to their triangle
    even where a circumcentre lies outside; the area of a cell is the sum of its kites.
    """
    vertices = by_blocks(lambda cells: circumcenter(*(points[cells[:, k]] for k in range(3))), topology.cells_on_vertex)
    edges = by_blocks(lambda cells: normalize(points[cells[:, 0]] + points[cells[:, 1]]), topology.cells_on_edge)
    kites = kite_areas(points, edges, vertices, topology.cells_on_vertex, topology.edges_on_vertex)
    area_cell = sum_by_index(topology.cells_on_vertex, kites, len(points))
    dc_edge = _lengths(points, topology.cells_on_edge)
    dv_edge = _lengths(vertices, topology.vertices_on_edge)
    at_edge, at_vertex = _coordinates("edge", edges), _coordinates("vertex", vertices)
    del edges, vertices  # the weights need the room
    return Metrics(
        **_coordinates("cell", points),
        **at_edge,
        **at_vertex,
        dc_edge=dc_edge,
        dv_edge=dv_edge,
        angle_edge=edge_angles(points, topology.cells_on_edge, at_edge["lon_edge"], at_edge["lat_edge"]),
        area_cell=area_cell,
        area_triangle=kites.sum(axis=1),
        kite_areas_on_vertex=kites,
        weights_on_edge=tangential_weights(topology, kites, area_cell, dc_edge, dv_edge),
    )


def _lengths(points: Array, ends: Index) -> Array:
    """Lengths (n,) of the arcs between pairs of points, given by their numbers (n, 2)."""
    return by_blocks(lambda pairs: arc_length(points[pairs[:, 0]], points[pairs[:, 1]]), ends)


def edge_angles(points: Array, cells_on_edge: Index, lon_edge: Array, lat_edge: Array) -> Array:
    """Angles (n_edges,) of the normals of edges, counter-clockwise from east at the given position, in [-pi, pi].

    Normals are the differences of the generators `points` (n_cells, 3).
    """

    def angles(cells: Index, longitude: Array, latitude: Array) -> Array:
        normal = points[cells[:, 1]] - points[cells[:, 0]]
        east, north = east_north(longitude, latitude)
        return np.arctan2(dot(normal, north), dot(normal, east))

    return by_blocks(angles, cells_on_edge, lon_edge, lat_edge)


def kite_areas(points: Array, edges: Array, vertices: Array, cells_on_vertex: Index, edges_on_vertex: Index) -> Array:
    """Signed areas (n_vertices, 3) of the parts of triangle v in its three cells.

    Kite j runs counter-clockwise from the vertex to edge j, to cell j, to edge j + 1.
    """

    def kites(cells: Index, sides: Index, corners: Array) -> Array:
        triples, denominators = _halves_of_kites(points, edges, cells, sides, corners)
        halves = 2.0 * np.arctan2(triples, denominators)
        return halves[:, 0::2] + halves[:, 1::2]

    return by_blocks(kites, cells_on_vertex, edges_on_vertex, vertices)


@row_loop
def _halves_of_kites(points: Array, edges: Array, cells: Index, sides: Index, corners: Array) -> tuple[Array, Array]:
    """Numerators and denominators (n, 6) of `mesh.geometry.sphere.triangle_area`, two triangles for each kite."""
    triples, denominators = np.empty((len(cells), 6)), np.empty((len(cells), 6))
    for row in range(len(cells)):
        corner = vector_to(corners, row)
        for j in range(3):
            cell = vector_to(points, cells[row, j])
            before, after = vector_to(edges, sides[row, j]), vector_to(edges, sides[row, (j + 1) % 3])
            triples[row, 2 * j], denominators[row, 2 * j] = area_parts(cell, corner, before)
            triples[row, 2 * j + 1], denominators[row, 2 * j + 1] = area_parts(cell, after, corner)
    return triples, denominators


def _coordinates(place: str, points: Array) -> dict[str, Array]:
    """The five coordinate arrays of one kind of entity, by name."""
    lon, lat = np.ascontiguousarray(by_blocks(lambda rows: np.stack(to_lonlat(rows), axis=1), points).T)
    x, y, z = np.ascontiguousarray(points.T)
    return {f"x_{place}": x, f"y_{place}": y, f"z_{place}": z, f"lat_{place}": lat, f"lon_{place}": lon}

"""Positions, lengths, areas and angles of a Voronoi mesh on the unit sphere or in a plane."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array, Index, by_blocks, sum_by_index
from mesh.discrete.walls import boundary_vertices, has_walls
from mesh.discrete.weights import tangential_weights
from mesh.geometry.sphere import dot
from mesh.geometry.surface import UNIT_SPHERE, Surface, surface_of
from mesh.voronoi_mesh import Metrics, Topology, VoronoiMesh

SHORT = 1e-6
"""Of the way from its cell: a wall that is shorter has no direction of its own."""


@dataclass(frozen=True, eq=False)
class AtWalls:
    """What generators do not give where a mesh has walls, in lengths of its unit; other rows mean nothing.

    `vertices` (n_vertices, 3) and their `kites` (n_vertices, 3) count at the boundary; without `kites` those of a cell
    reach to the points of its edges there. `edges` (n_edges, 3) are the points of walls, and `dc_edge` (n_edges,) the
    distances at which the missing cells stand.
    """

    vertices: Array
    edges: Array
    dc_edge: Array
    kites: Array | None


def at_walls_of(mesh: VoronoiMesh) -> AtWalls | None:
    """What a mesh has at its walls, None if it has none."""
    if not has_walls(mesh):
        return None
    unit, surface = mesh.length_unit, surface_of(mesh)
    kites = mesh.kite_areas_on_vertex / unit**2
    return AtWalls(surface.onto(mesh.vertex_points), surface.onto(mesh.edge_points), mesh.dc_edge / unit, kites)


def compute_metrics(
    points: Array, topology: Topology, at_walls: AtWalls | None = None, surface: Surface = UNIT_SPHERE
) -> Metrics:
    """All metrics of the mesh with generators `points` (n_cells, 3) on a surface, and the given connectivity.

    Vertices are the circumcentres of the triangles; an edge's point is the midpoint of the way between its
    cells, where the two arcs of the edge cross. Kites have signed areas, so that they sum to their triangle
    even where a circumcentre lies outside; the area of a cell is the sum of its kites. A mesh with walls needs to be
    told what is `at_walls`.
    """
    vertices = _vertices(surface, points, topology.cells_on_vertex, at_walls)
    edges = _edges(surface, points, topology.cells_on_edge, at_walls)
    dc_edge = _lengths(surface, points, topology.cells_on_edge)
    kites = surface.kite_areas(points, edges, topology.cells_on_vertex, topology.edges_on_vertex, vertices)
    if at_walls is not None:
        dc_edge = np.where(topology.cells_on_edge[:, 1] < 0, at_walls.dc_edge, dc_edge)
        if at_walls.kites is not None:
            kites = np.where(boundary_vertices(topology)[:, None], at_walls.kites, kites)
        kites = np.where(topology.cells_on_vertex < 0, 0.0, kites)
    area_cell = sum_by_index(np.maximum(topology.cells_on_vertex, 0), kites, len(points))
    dv_edge = _lengths(surface, vertices, topology.vertices_on_edge)
    at_edge, at_vertex = _coordinates(surface, "edge", edges), _coordinates(surface, "vertex", vertices)
    angle_edge = edge_angles(surface, points, edges, vertices, topology, at_edge["lon_edge"], at_edge["lat_edge"])
    del edges, vertices  # the weights need the room
    return Metrics(
        **_coordinates(surface, "cell", points),
        **at_edge,
        **at_vertex,
        dc_edge=dc_edge,
        dv_edge=dv_edge,
        angle_edge=angle_edge,
        area_cell=area_cell,
        area_triangle=kites.sum(axis=1),
        kite_areas_on_vertex=kites,
        weights_on_edge=tangential_weights(topology, kites, area_cell, dc_edge, dv_edge),
    )


def _vertices(surface: Surface, points: Array, triangles: Index, at_walls: AtWalls | None) -> Array:
    """Circumcentres (n_vertices, 3) of triangles, and the vertices at walls."""
    if at_walls is None:
        return by_blocks(lambda cells: surface.circumcenter(*(points[cells[:, k]] for k in range(3))), triangles)
    vertices, inner = at_walls.vertices.copy(), triangles.min(axis=1) >= 0
    vertices[inner] = _vertices(surface, points, triangles[inner], None)
    return vertices


def _edges(surface: Surface, points: Array, cells_on_edge: Index, at_walls: AtWalls | None) -> Array:
    """Points (n_edges, 3) midway between cells, and those at walls."""
    if at_walls is None:
        return by_blocks(lambda cells: surface.midpoint(points[cells[:, 0]], points[cells[:, 1]]), cells_on_edge)
    edges, inner = at_walls.edges.copy(), cells_on_edge[:, 1] >= 0
    edges[inner] = _edges(surface, points, cells_on_edge[inner], None)
    return edges


def _lengths(surface: Surface, points: Array, ends: Index) -> Array:
    """Lengths (n,) of the ways between pairs of points, given by their numbers (n, 2)."""
    return by_blocks(lambda pairs: surface.distance(points[pairs[:, 0]], points[pairs[:, 1]]), ends)


def edge_angles(
    surface: Surface,
    points: Array,
    edges: Array,
    vertices: Array,
    topology: Topology,
    lon_edge: Array,
    lat_edge: Array,
) -> Array:
    """Angles (n_edges,) of the normals of edges, counter-clockwise from east at the given position, in [-pi, pi].

    Normals are the differences of the generators `points` (n_cells, 3); at walls they are square to the way from one of
    the `vertices` (n_vertices, 3) to the other, or lead from the cell to the point of the edge, of `edges`
    (n_edges, 3), where these coincide.
    """

    def angles(cells: Index, ends: Index, middles: Array, longitude: Array, latitude: Array) -> Array:
        normal = surface.shortest(points[cells[:, 1]] - points[cells[:, 0]])
        wall = np.flatnonzero(cells[:, 1] < 0)
        if len(wall):
            tail, head = (vertices[ends[wall, k]] for k in range(2))
            outward = surface.shortest(middles[wall] - points[cells[wall, 0]])
            along = surface.shortest(head - tail)
            short = dot(along, along) < SHORT**2 * dot(outward, outward)
            normal[wall] = np.where(short[:, None], outward, surface.right_of(tail, head))
        east, north = surface.axes(longitude, latitude)
        return np.arctan2(dot(normal, north), dot(normal, east))

    return by_blocks(angles, topology.cells_on_edge, topology.vertices_on_edge, edges, lon_edge, lat_edge)


def _coordinates(surface: Surface, place: str, points: Array) -> dict[str, Array]:
    """The five coordinate arrays of one kind of entity, by name."""
    lon, lat = np.ascontiguousarray(by_blocks(lambda rows: np.stack(surface.angles(rows), axis=1), points).T)
    x, y, z = np.ascontiguousarray(points.T)
    return {f"x_{place}": x, f"y_{place}": y, f"z_{place}": z, f"lat_{place}": lat, f"lon_{place}": lon}

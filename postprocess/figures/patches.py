"""Polygons on the sphere that show values: Voronoi cells, Delaunay triangles, and the quadrilaterals round edges."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.discrete.walls import has_walls
from mesh.geometry.sphere import dot, from_lonlat, normalize, to_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError


@dataclass(frozen=True, eq=False)
class Patches:
    """Polygons on the unit sphere, counter-clockwise from outside.

    `corners` (n, k, 3) has the last corner repeated where a polygon has fewer than k; `counts` (n,) says how many there
    are, and `longitude` (n,), rad, lies within each polygon.
    """

    corners: Array
    counts: Index
    longitude: Array

    def taken(self, kept: Index) -> "Patches":
        """Those of the indices `kept`."""
        return Patches(self.corners[kept], self.counts[kept], self.longitude[kept])

    def near(self, longitude: float, latitude: float, distance: float) -> NDArray[np.bool_]:
        """Which (n,) may reach within `distance` of a place; all angles in radians."""
        middle = normalize(self.corners.mean(axis=1))
        reach = np.arccos(np.clip(dot(self.corners, middle[:, None, :]), -1.0, 1.0)).max(axis=1)
        place = from_lonlat(np.array(longitude), np.array(latitude))
        return np.arccos(np.clip(middle @ place, -1.0, 1.0)) <= distance + reach


def patches_for(mesh: VoronoiMesh, values: Array) -> Patches:
    """The polygons that show `values` (n,), which are as many as `require_place` wants."""
    require_place(mesh, values)
    if len(values) == mesh.n_cells:
        return cell_patches(mesh)
    return edge_patches(mesh) if len(values) == mesh.n_edges else triangle_patches(mesh)


def require_place(mesh: VoronoiMesh, values: Array) -> None:
    """Raise `InputError` unless there is one value for each cell, edge or vertex."""
    if values.ndim != 1 or len(values) not in (mesh.n_cells, mesh.n_edges, mesh.n_vertices):
        raise InputError(
            f"values of shape {values.shape} are on no part of a mesh of {mesh.n_cells} cells, {mesh.n_edges} edges "
            f"and {mesh.n_vertices} vertices; give one value for each cell, edge or vertex"
        )


def cell_patches(mesh: VoronoiMesh) -> Patches:
    """Voronoi cells."""
    mesh.require_sphere("maps are drawn")
    columns = np.minimum(np.arange(mesh.max_edges), mesh.n_edges_on_cell[:, None] - 1)
    rings = np.take_along_axis(mesh.vertices_on_cell, columns, axis=1)
    return Patches(normalize(mesh.vertex_points)[rings], mesh.n_edges_on_cell, mesh.lon_cell)


def triangle_patches(mesh: VoronoiMesh) -> Patches:
    """Delaunay triangles, one for each vertex; of those at the boundary what lies in the cells that are there."""
    mesh.require_sphere("maps are drawn")
    if has_walls(mesh):
        return _kites(mesh)
    return _of_equal_counts(normalize(mesh.cell_points)[mesh.cells_on_vertex])


def _kites(mesh: VoronoiMesh) -> Patches:
    """The kites round each vertex, from edge to cell to edge, with the vertex in the place of what is missing."""
    cells, edges = normalize(mesh.cell_points), normalize(mesh.edge_points)
    vertices = np.repeat(normalize(mesh.vertex_points)[:, None, :], 3, axis=1)
    corners = np.empty((mesh.n_vertices, 6, 3))
    for first, points, around in ((0, edges, mesh.edges_on_vertex), (1, cells, mesh.cells_on_vertex)):
        corners[:, first::2] = np.where(around[..., None] < 0, vertices, points[around])
    return _of_equal_counts(corners)


def edge_patches(mesh: VoronoiMesh) -> Patches:
    """The quadrilateral of the two cell centres and the two vertices of each edge; at a wall half of it."""
    mesh.require_sphere("maps are drawn")
    centres, vertices = normalize(mesh.cell_points)[mesh.cells_on_edge], normalize(mesh.vertex_points)
    if has_walls(mesh):
        centres = np.where(mesh.cells_on_edge[..., None] < 0, normalize(mesh.edge_points)[:, None, :], centres)
    ends = vertices[mesh.vertices_on_edge]
    return _of_equal_counts(np.stack([centres[:, 0], ends[:, 0], centres[:, 1], ends[:, 1]], axis=1))


def _of_equal_counts(corners: Array) -> Patches:
    longitude, _ = to_lonlat(normalize(corners.mean(axis=1)))
    return Patches(corners, np.full(len(corners), corners.shape[1], dtype=np.int32), longitude)

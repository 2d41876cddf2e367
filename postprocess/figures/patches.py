"""Polygons that show values: Voronoi cells, Delaunay triangles, and the quadrilaterals round edges.

They are on the unit sphere or on a plane.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.discrete.walls import has_walls
from mesh.geometry.sphere import dot, from_lonlat, normalize
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError


@dataclass(frozen=True, eq=False)
class Patches:
    """Polygons on the unit sphere, counter-clockwise from outside, or on a plane, in metres.

    `corners` (n, k, 3) has the last corner repeated where a polygon has fewer than k; `counts` (n,) says how many there
    are, and `longitude` (n,), rad, lies within each polygon; on a plane it is zero. On a plane that repeats itself each
    polygon is whole: its corners are those images that belong together.
    """

    corners: Array
    counts: Index
    longitude: Array

    def taken(self, kept: Index) -> "Patches":
        """Those of the indices `kept`."""
        return Patches(self.corners[kept], self.counts[kept], self.longitude[kept])

    def near(self, longitude: float, latitude: float, distance: float) -> NDArray[np.bool_]:
        """Which (n,) may reach within `distance` of a place on the sphere; all angles in radians."""
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
    columns = np.minimum(np.arange(mesh.max_edges), mesh.n_edges_on_cell[:, None] - 1)
    rings = np.take_along_axis(mesh.vertices_on_cell, columns, axis=1)
    corners = _joined(mesh, _on_surface(mesh, mesh.vertex_points)[rings])
    return Patches(corners, mesh.n_edges_on_cell, mesh.lon_cell)


def triangle_patches(mesh: VoronoiMesh) -> Patches:
    """Delaunay triangles, one for each vertex; of those at the boundary what lies in the cells that are there."""
    if has_walls(mesh):
        return _kites(mesh)
    return _of_equal_counts(mesh, _on_surface(mesh, mesh.cell_points)[mesh.cells_on_vertex])


def _kites(mesh: VoronoiMesh) -> Patches:
    """The kites round each vertex, from edge to cell to edge, with the vertex in the place of what is missing."""
    cells, edges = _on_surface(mesh, mesh.cell_points), _on_surface(mesh, mesh.edge_points)
    vertices = np.repeat(_on_surface(mesh, mesh.vertex_points)[:, None, :], 3, axis=1)
    corners = np.empty((mesh.n_vertices, 6, 3))
    for first, points, around in ((0, edges, mesh.edges_on_vertex), (1, cells, mesh.cells_on_vertex)):
        corners[:, first::2] = np.where(around[..., None] < 0, vertices, points[around])
    return _of_equal_counts(mesh, corners)


def edge_patches(mesh: VoronoiMesh) -> Patches:
    """The quadrilateral of the two cell centres and the two vertices of each edge; at a wall half of it."""
    centres = _on_surface(mesh, mesh.cell_points)[mesh.cells_on_edge]
    if has_walls(mesh):
        middles = _on_surface(mesh, mesh.edge_points)
        centres = np.where(mesh.cells_on_edge[..., None] < 0, middles[:, None, :], centres)
    ends = _on_surface(mesh, mesh.vertex_points)[mesh.vertices_on_edge]
    return _of_equal_counts(mesh, np.stack([centres[:, 0], ends[:, 0], centres[:, 1], ends[:, 1]], axis=1))


def _of_equal_counts(mesh: VoronoiMesh, corners: Array) -> Patches:
    corners = _joined(mesh, corners)
    longitude, _ = surface_of(mesh).angles(_on_surface(mesh, corners.mean(axis=1)))
    return Patches(corners, np.full(len(corners), corners.shape[1], dtype=np.int32), longitude)


def _on_surface(mesh: VoronoiMesh, points: Array) -> Array:
    """Points (n, 3) of a mesh as unit vectors; those of a plane as they are."""
    return surface_of(mesh).onto(points)


def _joined(mesh: VoronoiMesh, corners: Array) -> Array:
    """The corners (n, k, 3) of polygons, on a plane the images nearest to the first of each."""
    surface = surface_of(mesh)
    return corners[:, :1] + surface.shortest(corners - corners[:, :1]) if surface.is_flat else corners

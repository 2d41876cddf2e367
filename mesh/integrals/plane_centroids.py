"""Centroids of the cells of a mesh on a plane."""

import numpy as np

from mesh.arrays import Array
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh


def plane_centroids(mesh: VoronoiMesh) -> Array:
    """Centroids (n_cells, 3), metres, of the polygons of the vertices of each cell, under uniform density.

    They lie near their generators, beyond the seams of a periodic plane if need be.
    """
    centers = mesh.cell_points
    # What a short ring leaves over becomes its first vertex, which closes it; triangles beyond have no area.
    ring = np.where(mesh.on_ring, mesh.vertices_on_cell, mesh.vertices_on_cell[:, :1])
    corners = surface_of(mesh).shortest(mesh.vertex_points[ring] - centers[:, None])[..., :2]
    following = np.roll(corners, -1, axis=1)
    turns = corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0]
    moments = (turns[..., None] * (corners + following)).sum(axis=1) / 3.0
    centers[:, :2] += moments / turns.sum(axis=1)[:, None]
    return centers

"""The sides of each cell in its own tangent plane: where its neighbours lie, and the middles of its Voronoi edges."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import closed_mesh
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh


@dataclass(frozen=True, eq=False)
class Sides:
    """The sides of every cell, in the plane of the eastward and northward directions at its centre.

    `normal` (n_cells, max_edges, 2) is the unit vector towards the neighbour, along the great circle. The middle of the
    Voronoi edge, as seen along the great circle to it, lies `offset` (n_cells, max_edges) to the left of that line, in
    the units of the radius. Both are zero beyond the last side of a cell, and at walls; `distance` (n_cells, max_edges)
    to the neighbour is not.
    """

    normal: Array
    offset: Array
    distance: Array

    @property
    def middle(self) -> Array:
        """Vectors (n_cells, max_edges, 2) from the centre to the middle of every side.

        As in the plane, they reach half the way to the neighbour.
        """
        left = np.stack([-self.normal[..., 1], self.normal[..., 0]], axis=-1)
        return 0.5 * self.distance[..., None] * self.normal + self.offset[..., None] * left


def sides_of_cells(mesh: VoronoiMesh) -> Sides:
    """The sides of the cells of `mesh`."""
    there, mesh, unit = mesh.edge_signs_on_cell != 0, closed_mesh(mesh), mesh.length_unit
    surface = surface_of(mesh)
    centers, vertices = mesh.cell_points / unit, mesh.vertex_points / unit
    tail, head = (vertices[mesh.vertices_on_edge[:, k]] for k in range(2))
    middles = surface.midpoint(tail, head)[np.where(there, mesh.edges_on_cell, 0)]
    neighbours = centers[np.where(there, mesh.cells_on_cell, 0)]
    axes = np.stack(surface.axes(mesh.lon_cell, mesh.lat_cell), axis=1)
    normal, _ = surface.seen_from(centers, axes, neighbours)
    direction, arc = surface.seen_from(centers, axes, middles)
    left = normal[..., 0] * direction[..., 1] - normal[..., 1] * direction[..., 0]
    return Sides(normal * there[..., None], unit * arc * left * there, mesh.dc_edge[mesh.edges_on_cell])

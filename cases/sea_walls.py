"""Whether the walls of a mesh stand where those of a case do."""

import numpy as np

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh


def stray_wall(mesh: VoronoiMesh, away: Array, most: float) -> int | None:
    """A vertex at a wall that is too far from the walls of the case, or None.

    `away` (n_vertices,) are the distances from these, in the unit of the mesh; up to `most` roots of the area of the
    largest cell are allowed. The rim of a part of a mesh is no wall: only what the whole mesh calls its boundary is.
    """
    stray = np.flatnonzero((mesh.boundary_vertex == 1) & (away > most * np.sqrt(mesh.area_cell.max())))
    return int(stray[0]) if len(stray) else None

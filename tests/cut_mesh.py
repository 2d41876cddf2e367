"""Meshes with a coast, for tests."""

import numpy as np

from mesh.parts.cutting import without_cells
from mesh.voronoi_mesh import VoronoiMesh


def without_cap(mesh: VoronoiMesh, latitude: float = 0.6) -> VoronoiMesh:
    """`mesh` without the cells whose centres are north of `latitude`, radians, and without a single one elsewhere."""
    missing = mesh.lat_cell > latitude
    missing[np.argmin(mesh.lat_cell)] = True
    return without_cells(mesh, missing)

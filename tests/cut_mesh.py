"""Meshes with a coast, for tests."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mesh.geometry.sphere import normalize
from mesh.parts.cutting import without_cells
from mesh.voronoi_mesh import VoronoiMesh


def without_cap(mesh: VoronoiMesh, latitude: float = 0.6) -> VoronoiMesh:
    """`mesh` without the cells whose centres are north of `latitude`, radians, and without a single one elsewhere."""
    missing = mesh.lat_cell > latitude
    missing[np.argmin(mesh.lat_cell)] = True
    return without_cells(mesh, missing)


def random_sea(mesh: VoronoiMesh, seed: int = 0, islands: int = 12) -> VoronoiMesh:
    """`mesh` without round islands of random sizes and one cell in fifty elsewhere, the largest sea that is left."""
    random = np.random.default_rng(seed)
    centres = normalize(random.normal(size=(islands, 3)))
    nearness = normalize(mesh.cell_points) @ centres.T
    missing = (nearness > np.cos(random.uniform(0.1, 0.5, islands))).any(axis=1) | (random.random(mesh.n_cells) < 0.02)
    first, second = mesh.cells_on_edge[~missing[mesh.cells_on_edge].any(axis=1)].T
    touching = coo_array((np.ones(len(first)), (first, second)), shape=(mesh.n_cells, mesh.n_cells))
    _, seas = connected_components(touching, directed=False)
    return without_cells(mesh, seas != np.bincount(seas[~missing]).argmax())

"""Geometry of a page: its points, and the rings of them that outline cells, triangles and edges.

Points are numbered vertices first, then cells, then edges.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.discrete.walls import has_walls, wall_edges
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.view.packing import packed_list
from postprocess.view.places import packed_places
from swe.diagnostics.outputs import CELLS, EDGES, VERTICES

NUMBER_BITS = 24
"""Of the numbers of points."""


def packed_outlines(mesh: VoronoiMesh, places: set[str]) -> dict[str, Any]:
    """Points, rings of each of the `places` that fields live at, and the coast, as the page reads them."""
    return {
        **packed_places(mesh, with_edges=has_walls(mesh) or EDGES in places),
        "numberBits": NUMBER_BITS,
        "cellPoints": [mesh.n_vertices, mesh.n_cells],
        "closed": not has_walls(mesh),
        "coast": _packed_coast(mesh),
        "places": {place: _packed_rings(*rings_of(mesh, place)) for place in sorted(places)},
    }


def rings_of(mesh: VoronoiMesh, place: str) -> tuple[NDArray[np.int64], Index]:
    """Points one ring after another, counter-clockwise from outside, and how many each ring has.

    As in `postprocess.figures.patches`: Voronoi cells; Delaunay triangles or, beside walls, the kites that are there;
    the quadrilaterals of the two cells and the two vertices of each edge, at a wall half of it.
    """
    if place == CELLS:
        return mesh.vertices_on_cell[mesh.on_ring].astype(np.int64), mesh.n_edges_on_cell
    rings = {VERTICES: _triangles, EDGES: _quadrilaterals}[place](mesh)
    return rings.ravel(), np.full(len(rings), rings.shape[1], dtype=np.int32)


def _triangles(mesh: VoronoiMesh) -> NDArray[np.int64]:
    if not has_walls(mesh):
        return mesh.n_vertices + mesh.cells_on_vertex.astype(np.int64)
    rings = np.empty((mesh.n_vertices, 6), dtype=np.int64)
    vertices = np.arange(mesh.n_vertices)[:, None]
    first_edge = mesh.n_vertices + mesh.n_cells
    for first, start, around in ((0, first_edge, mesh.edges_on_vertex), (1, mesh.n_vertices, mesh.cells_on_vertex)):
        rings[:, first::2] = np.where(around < 0, vertices, start + around)
    return rings


def _quadrilaterals(mesh: VoronoiMesh) -> NDArray[np.int64]:
    edges = mesh.n_vertices + mesh.n_cells + np.arange(mesh.n_edges)[:, None]
    centres = np.where(mesh.cells_on_edge < 0, edges, mesh.n_vertices + mesh.cells_on_edge.astype(np.int64))
    ends = mesh.vertices_on_edge
    return np.stack([centres[:, 0], ends[:, 0], centres[:, 1], ends[:, 1]], axis=1)


def _packed_rings(points: NDArray[np.int64], counts: Index) -> dict[str, Any]:
    return {
        "count": len(counts),
        "corners": len(points),
        "counts": packed_list(counts.astype(np.int64), 8),
        "rings": packed_list(points, NUMBER_BITS),
    }


def _packed_coast(mesh: VoronoiMesh) -> dict[str, Any]:
    """Both vertices of each wall, one after the other."""
    ends = mesh.vertices_on_edge[wall_edges(mesh)].astype(np.int64).ravel()
    return {"count": len(ends), "ends": packed_list(ends, NUMBER_BITS)}

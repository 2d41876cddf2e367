"""Meshes in which neighbours are missing: edges between a cell and none are walls, through which nothing flows.

A missing cell, or a missing edge of a vertex, is -1 in `cells_on_edge`, `cells_on_cell`, `cells_on_vertex` and
`edges_on_vertex`; both vertices of every edge and all edges and vertices of every cell are there. `area_triangle` is
the sum of the kites that are there.
"""

from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, Signs
from mesh.graphs import count_seas_and_coasts
from mesh.voronoi_mesh import Topology, VoronoiMesh


def wall_edges(mesh: VoronoiMesh) -> Index:
    """Edges at which a cell is missing."""
    return np.flatnonzero((mesh.cells_on_edge < 0).any(axis=1))


def has_walls(mesh: Topology) -> bool:
    """Whether any edge lacks a cell."""
    return bool(mesh.cells_on_edge.min(initial=0) < 0)


def boundary_vertices(mesh: Topology) -> NDArray[np.bool_]:
    """Mask (n_vertices,) of the vertices at which a cell is missing."""
    at_boundary: NDArray[np.bool_] = mesh.cells_on_vertex.min(axis=1) < 0
    return at_boundary


def seas_and_coasts(mesh: Topology) -> tuple[int, int]:
    """How many connected seas the cells of a mesh form, and how many closed coasts the walls do."""
    return count_seas_and_coasts(mesh.n_cells, mesh.cells_on_edge, mesh.vertices_on_edge, boundary_vertices(mesh))


def shares_of_circulation(mesh: VoronoiMesh, wall_slip: float) -> Array:
    """The share (n_vertices,) of the circulation round each vertex that is vorticity of the fluid.

    All of it inside; 1 - `wall_slip` where a cell is missing, from 1 (no slip) to 0 (free slip). See `docs/scheme.md`.
    """
    return np.where(boundary_vertices(mesh), 1.0 - wall_slip, 1.0)


def circulation_signs(mesh: VoronoiMesh, wall_slip: float) -> Signs | Array:
    """Factors (n_vertices, 3) of d u in the circulations that are vorticity: signs times `shares_of_circulation`.

    Without slip they are `edge_signs_on_vertex` themselves.
    """
    signs = mesh.edge_signs_on_vertex
    return signs if wall_slip == 0.0 else signs * shares_of_circulation(mesh, wall_slip)[:, None]


def closed_mesh(mesh: VoronoiMesh) -> VoronoiMesh:
    """`mesh` as loops read it, without -1: what is missing is an entity that is there, of no size.

    The missing cell of a wall is its other one, so that differences across vanish; no tangential velocity is made at
    walls, nor from the flow through them; kites of missing cells have no area. Signs of edges (`edge_signs_on_cell`,
    `edge_signs_on_vertex`), which vanish at walls and for missing edges, are those of `mesh`, not of what is given.
    `mesh` itself where nothing is missing. Made once for each mesh, as model, scheme, terms and tiles all ask for it.
    """
    if mesh not in _closed:
        closed = _made_closed(mesh)
        if closed is mesh:
            return mesh
        _closed[mesh] = closed
    return _closed[mesh]


_closed: WeakKeyDictionary[VoronoiMesh, VoronoiMesh] = WeakKeyDictionary()


def _made_closed(mesh: VoronoiMesh) -> VoronoiMesh:
    walls = wall_edges(mesh)
    no_cell = mesh.cells_on_vertex < 0
    if not (len(walls) or no_cell.any() or (mesh.edges_on_vertex < 0).any()):
        return mesh
    is_wall = np.zeros(mesh.n_edges, np.bool_)
    is_wall[walls] = True
    own = np.arange(mesh.n_cells)[:, None]
    return replace(
        mesh,
        cells_on_edge=_filled(mesh.cells_on_edge),
        cells_on_cell=np.where(mesh.on_ring & (mesh.cells_on_cell < 0), own, mesh.cells_on_cell).astype(np.int32),
        cells_on_vertex=_filled(mesh.cells_on_vertex),
        edges_on_vertex=_filled(mesh.edges_on_vertex),
        kite_areas_on_vertex=np.where(no_cell, 0.0, mesh.kite_areas_on_vertex),
        n_edges_on_edge=np.where(is_wall, 0, mesh.n_edges_on_edge).astype(np.int32),
        weights_on_edge=np.where(is_wall[mesh.edges_on_edge], 0.0, mesh.weights_on_edge),
    )


def _filled(neighbours: Index) -> Index:
    """Rows of neighbours with one that is there in the place of those that are missing."""
    return np.where(neighbours < 0, neighbours.max(axis=1, keepdims=True), neighbours).astype(np.int32)

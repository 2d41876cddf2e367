"""Checks that the connectivity arrays of a mesh agree with each other and have the order of `Topology`.

Everything is checked exactly. Errors name the first offending entities, counted from 0. A mesh may have walls
(`mesh.discrete.walls`), if these have their cell first.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index, by_blocks, row_loop
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.discrete.topology import FILL
from mesh.discrete.walls import boundary_vertices, has_walls, seas_and_coasts
from mesh.errors import MeshError, require
from mesh.voronoi_mesh import Topology

MINIMUM_RING = 3

Faults = NDArray[np.uint8]
"""One number for each row: bit k says that sentence k of a list is true of it."""

CELL_FAULTS = (
    "edgesOnCell lists an edge that cellsOnEdge gives to other cells",
    "cellsOnCell is not the cell across edgesOnCell",
    "verticesOnCell does not lie between one edge and the next in edgesOnCell",
)
VERTEX_FAULTS = (
    "edgesOnVertex lists an edge that verticesOnEdge gives to other vertices",
    "cellsOnVertex does not lie between one edge and the next in edgesOnVertex",
)
BOUNDARY_FAULT = "boundaryVertex is not 1 where cellsOnVertex lacks a cell, and 0 where it has all three"
WITH_GAPS = frozenset({"cells_on_cell", "cells_on_edge", "cells_on_vertex", "edges_on_vertex"})
"""Arrays in which an entity may be missing beside a wall."""

EDGE_FAULTS = (
    "verticesOnEdge does not run along the tangent, 90 degrees left of the normal given by cellsOnEdge",
    "edgesOnEdge does not go counter-clockwise round the first cell, then round the second",
)


def validate_topology(mesh: Topology, handles: int = 0) -> None:
    """Check shapes, index ranges, and that rings, pairs and triangles agree and are in order.

    The mesh lies on a sphere, or on a surface of so many `handles` (`mesh.geometry.surface`). Raises `MeshError`.
    """
    _check_shapes(mesh, handles)
    _check_ranges(mesh)
    _check_rings(mesh)
    _check_vertices(mesh)
    _check_edges(mesh)
    if has_walls(mesh):
        _require_part_of_surface(mesh, handles)


def require_closed(n_cells: int, n_edges: int, n_vertices: int, handles: int = 0) -> None:
    """Raise `MeshError` unless these numbers of cells, edges and vertices close a surface with triangles.

    That is a sphere, or one with so many `handles`.
    """
    edges, vertices = 3 * n_cells - 6 + 6 * handles, 2 * n_cells - 4 + 4 * handles
    if n_vertices != vertices or n_edges != edges:
        closed = "periodic plane" if handles else "sphere"
        raise MeshError(
            f"{n_cells} cells, {n_edges} edges and {n_vertices} vertices do not close a {closed}: "
            f"{n_cells} cells need {edges} edges and {vertices} vertices; "
            "only meshes with walls, which cellsOnEdge and cellsOnVertex mark by 0, may have others"
        )


def _require_part_of_surface(mesh: Topology, handles: int) -> None:
    """Raise `MeshError` unless a mesh with walls, of which all else is right, has no more than so many `handles`."""
    seas, coasts = seas_and_coasts(mesh)
    beyond = 2 * seas - coasts - (mesh.n_vertices - mesh.n_edges + mesh.n_cells)
    if beyond % 2 or not 0 <= beyond <= 2 * handles:
        surface = "periodic plane" if handles else "sphere"
        raise MeshError(
            f"{mesh.n_cells} cells, {mesh.n_edges} edges and {mesh.n_vertices} vertices are no part of a {surface}: on "
            f"one, {seas} separate seas with {coasts} coasts have "
            f"{2 * seas - coasts + mesh.n_edges - mesh.n_cells} vertices; correct the file"
        )


def _check_shapes(mesh: Topology, handles: int) -> None:
    sizes = dimension_sizes(mesh)
    for variable in MESH_VARIABLES:
        if variable.integer:
            expected = tuple(sizes[dimension] for dimension in variable.dimensions)
            shape = getattr(mesh, variable.name).shape
            if shape != expected:
                raise MeshError(f"{variable.file_name} has shape {shape} instead of {expected}")
    if not has_walls(mesh):
        require_closed(mesh.n_cells, mesh.n_edges, mesh.n_vertices, handles)


def _check_ranges(mesh: Topology) -> None:
    sizes = dimension_sizes(mesh)
    counts = {"max_edges": mesh.n_edges_on_cell, "max_edges_2": mesh.n_edges_on_edge}
    require(
        (mesh.n_edges_on_cell >= MINIMUM_RING) & (mesh.n_edges_on_cell <= mesh.max_edges),
        "cells",
        f"nEdgesOnCell is not between {MINIMUM_RING} and {mesh.max_edges}",
    )
    walls = has_walls(mesh)
    require(
        by_blocks(partial(_are_counts, mesh.n_edges_on_cell), mesh.cells_on_edge, mesh.n_edges_on_edge),
        "edges",
        "nEdgesOnEdge is not the number of other edges of the two cells",
    )
    if walls:
        require(mesh.cells_on_edge[:, 0] >= 0, "edges", "cellsOnEdge has no first cell; an edge at a wall has it first")
        require(boundary_vertices(mesh) == mesh.boundary_vertex, "vertices", BOUNDARY_FAULT)
    else:
        require(mesh.boundary_vertex == 0, "vertices", "boundaryVertex is not 0, but a global mesh has no boundary")
    for variable in MESH_VARIABLES:
        if variable.of is None:
            continue
        values, size = getattr(mesh, variable.name), sizes[variable.of]
        used = counts.get(variable.dimensions[1])
        if used is None:
            used = np.full(len(values), values.shape[1], np.int32)
        lowest = FILL if walls and variable.name in WITH_GAPS else 0
        valid = by_blocks(partial(_are_indices, lowest, size), values, used)
        require(valid, variable.dimensions[0][2:], f"{variable.file_name} holds an index outside 1 to {size}")


def _are_counts(n_edges_on_cell: Index, cells: Index, counts: Index) -> NDArray[np.bool_]:
    """Whether each of the `counts` (n,) is the number of edges, but for their own, of the `cells` (n, 2) there are."""
    sizes = n_edges_on_cell[np.clip(cells, 0, len(n_edges_on_cell) - 1)] - 1
    fits: NDArray[np.bool_] = counts == np.where(cells == FILL, 0, sizes).sum(axis=1)
    return fits


@row_loop
def _are_indices(lowest: int, size: int, rows: Index, counts: Index) -> NDArray[np.bool_]:
    """Whether each row has numbers, from `lowest` to below `size`, up to its count, and fill beyond it."""
    valid = np.ones(len(rows), np.bool_)
    for row in range(len(rows)):
        for place in range(rows.shape[1]):
            value = rows[row, place]
            if place < counts[row]:
                valid[row] &= lowest <= value < size
            else:
                valid[row] &= value == FILL
    return valid


def _check_rings(mesh: Topology) -> None:
    """Every cell's edges, neighbours and vertices agree with those of the edges, each edge in the ring of its cells."""
    faults = by_blocks(
        partial(_faults_of_cells, mesh.cells_on_edge, mesh.vertices_on_edge),
        *(np.arange(mesh.n_cells), mesh.n_edges_on_cell),
        *(mesh.edges_on_cell, mesh.cells_on_cell, mesh.vertices_on_cell),
    )
    *of_edges, of_vertices = CELL_FAULTS
    _require_none(faults, "cells", *of_edges)
    uses = np.bincount(mesh.edges_on_cell[mesh.on_ring], minlength=mesh.n_edges)
    cells = np.count_nonzero(mesh.cells_on_edge != FILL, axis=1)
    require(uses == cells, "edges", "edgesOnCell does not list the edge in exactly two cells, or one at a wall")
    _require_none(faults >> len(of_edges), "cells", of_vertices)


@row_loop
def _faults_of_cells(
    cells_on_edge: Index,
    vertices_on_edge: Index,
    cells: Index,
    counts: Index,
    edges: Index,
    across: Index,
    vertices: Index,
) -> Faults:
    """Faults (n,) of the rings of these cells: bit k is sentence k of `CELL_FAULTS`."""
    faults = np.zeros(len(cells), np.uint8)
    for row in range(len(cells)):
        for place in range(counts[row]):
            edge, cell, vertex = edges[row, place], cells[row], vertices[row, place]
            following = edges[row, place + 1 if place + 1 < counts[row] else 0]
            first, second = cells_on_edge[edge, 0], cells_on_edge[edge, 1]
            if (first == cell) == (second == cell):
                faults[row] |= 1
            if first + second - cell != across[row, place]:
                faults[row] |= 2
            for end in (edge, following):
                if vertices_on_edge[end, 0] != vertex and vertices_on_edge[end, 1] != vertex:
                    faults[row] |= 4
    return faults


def _check_vertices(mesh: Topology) -> None:
    """Every vertex's edges and cells agree with the cells and vertices of the edges."""
    faults = by_blocks(
        partial(_faults_of_vertices, mesh.cells_on_edge, mesh.vertices_on_edge),
        *(np.arange(mesh.n_vertices), mesh.edges_on_vertex, mesh.cells_on_vertex),
    )
    of_edges, of_cells = VERTEX_FAULTS
    if has_walls(mesh):
        require(mesh.cells_on_vertex.max(axis=1) != FILL, "vertices", "cellsOnVertex names no cell")
    _require_none(faults, "vertices", of_edges)
    edges = mesh.edges_on_vertex
    uses = np.bincount(edges[edges != FILL], minlength=mesh.n_edges)
    require(uses == 2, "edges", "edgesOnVertex does not list the edge at exactly two vertices")
    _require_none(faults >> 1, "vertices", of_cells)


@row_loop
def _faults_of_vertices(
    cells_on_edge: Index, vertices_on_edge: Index, vertices: Index, edges: Index, cells: Index
) -> Faults:
    """Faults (n,) of these vertices: bit k is sentence k of `VERTEX_FAULTS`."""
    faults = np.zeros(len(vertices), np.uint8)
    for row in range(len(vertices)):
        for corner in range(3):
            edge, vertex = edges[row, corner], vertices[row]
            before, after = cells[row, (corner + 2) % 3], cells[row, corner]
            if edge == FILL:
                if before != FILL or after != FILL:
                    faults[row] |= 2
                continue
            if (vertices_on_edge[edge, 0] == vertex) == (vertices_on_edge[edge, 1] == vertex):
                faults[row] |= 1
            first, second = cells_on_edge[edge, 0], cells_on_edge[edge, 1]
            if not ((first == before and second == after) or (first == after and second == before)):
                faults[row] |= 2
    return faults


def _check_edges(mesh: Topology) -> None:
    """The tangent runs counter-clockwise round the first cell; `edges_on_edge` goes round both cells from the edge."""
    faults = by_blocks(
        partial(_faults_of_edges, mesh.n_edges_on_cell, mesh.edges_on_cell, mesh.vertices_on_cell),
        *(np.arange(mesh.n_edges), mesh.cells_on_edge, mesh.vertices_on_edge, mesh.edges_on_edge),
    )
    _require_none(faults, "edges", *EDGE_FAULTS)


@row_loop
def _faults_of_edges(
    n_edges_on_cell: Index,
    edges_on_cell: Index,
    vertices_on_cell: Index,
    edges: Index,
    cells: Index,
    vertices: Index,
    edges_on_edge: Index,
) -> Faults:
    """Faults (n,) of these edges: bit k is sentence k of `EDGE_FAULTS`."""
    faults = np.zeros(len(edges), np.uint8)
    for row in range(len(edges)):
        entry = 0
        for side in range(2):
            cell = cells[row, side]
            if cell == FILL:
                continue
            count = n_edges_on_cell[cell]
            start = 0  # the ring of the cell holds the edge, as has been checked
            while start < count - 1 and edges_on_cell[cell, start] != edges[row]:
                start += 1
            before = start - 1 if start > 0 else count - 1
            along = vertices[row, 0] == vertices_on_cell[cell, before]
            along &= vertices[row, 1] == vertices_on_cell[cell, start]
            if side == 0 and not along:
                faults[row] |= 1
            for step in range(1, count):
                place = start + step if start + step < count else start + step - count
                if edges_on_edge[row, entry] != edges_on_cell[cell, place]:
                    faults[row] |= 2
                entry += 1
    return faults


def _require_none(faults: Index, place: str, *sentences: str) -> None:
    """Raise `MeshError` with the first of the `sentences` whose bit is set in any of the faults (n,)."""
    for number, sentence in enumerate(sentences):
        require((faults >> number) & 1 == 0, place, sentence)

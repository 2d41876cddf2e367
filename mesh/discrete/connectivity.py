"""Checks that the connectivity arrays of a mesh agree with each other and have the order of `Topology`.

Everything is checked exactly. Errors name the first offending entities, counted from 0.
"""

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index, by_blocks
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.discrete.topology import FILL
from mesh.errors import MeshError, require
from mesh.voronoi_mesh import Topology

MINIMUM_RING = 3


def validate_topology(mesh: Topology) -> None:
    """Check shapes, index ranges, and that rings, pairs and triangles agree and are in order.

    Raises `MeshError`.
    """
    _check_shapes(mesh)
    _check_ranges(mesh)
    _check_rings(mesh)
    _check_vertices(mesh)
    _check_edges(mesh)


def require_closed(n_cells: int, n_edges: int, n_vertices: int) -> None:
    """Raise `MeshError` unless these numbers of cells, edges and vertices close a sphere with triangles."""
    if n_vertices != 2 * n_cells - 4 or n_edges != 3 * n_cells - 6:
        raise MeshError(
            f"{n_cells} cells, {n_edges} edges and {n_vertices} vertices do not close a sphere: "
            f"{n_cells} cells need {3 * n_cells - 6} edges and {2 * n_cells - 4} vertices; "
            "only global meshes are supported"
        )


def _check_shapes(mesh: Topology) -> None:
    sizes = dimension_sizes(mesh)
    for variable in MESH_VARIABLES:
        if variable.integer:
            expected = tuple(sizes[dimension] for dimension in variable.dimensions)
            shape = getattr(mesh, variable.name).shape
            if shape != expected:
                raise MeshError(f"{variable.file_name} has shape {shape} instead of {expected}")
    require_closed(mesh.n_cells, mesh.n_edges, mesh.n_vertices)


def _check_ranges(mesh: Topology) -> None:
    sizes = dimension_sizes(mesh)
    counts = {"max_edges": mesh.n_edges_on_cell, "max_edges_2": mesh.n_edges_on_edge}
    require(
        (mesh.n_edges_on_cell >= MINIMUM_RING) & (mesh.n_edges_on_cell <= mesh.max_edges),
        "cells",
        f"nEdgesOnCell is not between {MINIMUM_RING} and {mesh.max_edges}",
    )
    require(
        mesh.n_edges_on_edge == mesh.n_edges_on_cell[np.clip(mesh.cells_on_edge, 0, mesh.n_cells - 1)].sum(1) - 2,
        "edges",
        "nEdgesOnEdge is not the number of other edges of the two cells",
    )
    require(mesh.boundary_vertex == 0, "vertices", "boundaryVertex is not 0, but a global mesh has no boundary")
    for variable in MESH_VARIABLES:
        if variable.of is None:
            continue
        values, size = getattr(mesh, variable.name), sizes[variable.of]
        width = variable.dimensions[1]
        used = np.ones(values.shape, dtype=bool)
        if width in counts:
            used = np.arange(values.shape[1]) < counts[width][:, None]
        valid = np.where(used, (values >= 0) & (values < size), values == FILL)
        require(valid, variable.dimensions[0][2:], f"{variable.file_name} holds an index outside 1 to {size}")


def _check_rings(mesh: Topology) -> None:
    """Every cell's edges and neighbours agree with the cells of the edges, each edge in exactly two rings."""

    def of_own_edges(cells: Index, edges: Index, counts: Index) -> NDArray[np.bool_]:
        inside = np.arange(mesh.max_edges) < counts[:, None]
        ends = mesh.cells_on_edge[np.where(inside, edges, 0)]
        return ((ends == cells[:, None, None]).sum(axis=2) == 1) | ~inside

    def of_cells_across(cells: Index, edges: Index, counts: Index, across: Index) -> NDArray[np.bool_]:
        inside = np.arange(mesh.max_edges) < counts[:, None]
        ends = mesh.cells_on_edge[np.where(inside, edges, 0)]
        return (ends.sum(axis=2) - cells[:, None] == across) | ~inside

    rings = np.arange(mesh.n_cells), mesh.edges_on_cell, mesh.n_edges_on_cell
    require(by_blocks(of_own_edges, *rings), "cells", "edgesOnCell lists an edge that cellsOnEdge gives to other cells")
    require(
        by_blocks(of_cells_across, *rings, mesh.cells_on_cell),
        "cells",
        "cellsOnCell is not the cell across edgesOnCell",
    )
    inside = mesh.on_ring
    uses = np.bincount(mesh.edges_on_cell[inside], minlength=mesh.n_edges)
    require(uses == 2, "edges", "edgesOnCell does not list the edge in exactly two cells")
    require(
        by_blocks(
            lambda *rings: _in_both(mesh.vertices_on_edge, *rings),
            *(mesh.edges_on_cell, mesh.vertices_on_cell, inside, mesh.n_edges_on_cell),
        ),
        "cells",
        "verticesOnCell does not lie between one edge and the next in edgesOnCell",
    )


def _in_both(
    vertices_on_edge: NDArray, edges: NDArray, vertices: NDArray, inside: NDArray, counts: NDArray
) -> NDArray[np.bool_]:
    """Whether vertex j of each ring is an end of edges j and j + 1."""
    following = (np.arange(edges.shape[1]) + 1) % counts[:, None]
    after = np.take_along_axis(edges, following, axis=1)
    ends = [vertices_on_edge[np.where(inside, ring, 0)] for ring in (edges, after)]
    return np.logical_and(*((end == vertices[:, :, None]).any(axis=2) for end in ends)) | ~inside


def _check_vertices(mesh: Topology) -> None:
    """Every vertex's edges and cells agree with the cells and vertices of the edges."""
    vertex = np.arange(mesh.n_vertices)[:, None]
    ends = mesh.vertices_on_edge[mesh.edges_on_vertex]
    require(
        (ends == vertex[:, :, None]).sum(axis=2) == 1,
        "vertices",
        "edgesOnVertex lists an edge that verticesOnEdge gives to other vertices",
    )
    uses = np.bincount(mesh.edges_on_vertex.ravel(), minlength=mesh.n_edges)
    require(uses == 2, "edges", "edgesOnVertex does not list the edge at exactly two vertices")
    before, after = np.roll(mesh.cells_on_vertex, 1, axis=1), mesh.cells_on_vertex
    first, second = mesh.cells_on_edge.T[:, mesh.edges_on_vertex]
    require(
        ((first == before) & (second == after)) | ((first == after) & (second == before)),
        "vertices",
        "cellsOnVertex does not lie between one edge and the next in edgesOnVertex",
    )


def _check_edges(mesh: Topology) -> None:
    """The tangent runs counter-clockwise round the first cell; `edges_on_edge` goes round both cells from the edge."""

    def along_tangent(edges: Index, cells: Index, vertices: Index) -> NDArray[np.bool_]:
        first = cells[:, 0]
        position = _positions(mesh, edges, first)
        before = np.where(position == 0, mesh.n_edges_on_cell[first], position) - 1
        ring = mesh.vertices_on_cell
        right: NDArray[np.bool_] = (vertices[:, 0] == ring[first, before]) & (vertices[:, 1] == ring[first, position])
        return right

    def round_both_cells(edges: Index, cells: Index, edges_on_edge: Index) -> NDArray[np.bool_]:
        right, row = np.ones(len(edges), np.bool_), np.arange(len(edges))
        size = mesh.n_edges_on_cell[cells]
        for side in (0, 1):
            position, count = _positions(mesh, edges, cells[:, side]), size[:, side]
            offset = 0 if side == 0 else size[:, 0] - 1
            for step in range(1, mesh.max_edges):
                inside, place = step < count, position + step
                expected = mesh.edges_on_cell[cells[:, side], np.where(place < count, place, place - count)]
                right &= (edges_on_edge[row, np.where(inside, offset + step - 1, 0)] == expected) | ~inside
        return right

    edges = np.arange(mesh.n_edges)
    require(
        by_blocks(along_tangent, edges, mesh.cells_on_edge, mesh.vertices_on_edge),
        "edges",
        "verticesOnEdge does not run along the tangent, 90 degrees left of the normal given by cellsOnEdge",
    )
    require(
        by_blocks(round_both_cells, edges, mesh.cells_on_edge, mesh.edges_on_edge),
        "edges",
        "edgesOnEdge does not go counter-clockwise round the first cell, then round the second",
    )


def _positions(mesh: Topology, edges: Index, cells: Index) -> Index:
    """Where each edge stands in the ring of its cell."""
    return np.argmax(mesh.edges_on_cell[cells] == edges[:, None], axis=1)

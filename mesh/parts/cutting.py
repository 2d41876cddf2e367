"""A mesh without some of its cells: a mesh in which neighbours are missing (`mesh.discrete.walls`).

Entities keep their order, and every cell the order of its ring, so that sums round a cell come out the same. Of the
whole only rows are asked for (`mesh.parts.mesh_rows`), so that it need not be in memory.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import BLOCK, Array, Index
from mesh.conventions import MESH_VARIABLES
from mesh.parts.mesh_rows import MeshRows, RowsInMemory
from mesh.voronoi_mesh import VoronoiMesh

FILL = -1

WEIGHTS = ("n_edges_on_edge", "edges_on_edge", "weights_on_edge")
"""Arrays of the tangential velocity, of which edges beside a missing cell keep those of the other cell alone."""


@dataclass(frozen=True, eq=False)
class Kept:
    """Numbers, in ascending order, of the cells, edges and vertices of a mesh that a part of it keeps."""

    cells: Index
    edges: Index
    vertices: Index


def around(whole: MeshRows, name: str, cells: Index) -> Index:
    """Numbers, in ascending order, of what stands in the rings `name` of the `cells` (n,), in ascending order too."""
    rings, counts = whole.rows(name, cells), whole.rows("n_edges_on_cell", cells)
    on_ring = np.arange(rings.shape[1]) < counts[:, None]
    return np.unique(rings[on_ring & (rings >= 0)]).astype(np.intp)


def kept_with(whole: MeshRows, cells: Index) -> Kept:
    """The `cells` (n,), in ascending order, and what touches them."""
    return Kept(cells, around(whole, "edges_on_cell", cells), around(whole, "vertices_on_cell", cells))


def without_cells(mesh: VoronoiMesh, missing: NDArray[np.bool_]) -> VoronoiMesh:
    """`mesh` without the cells that `missing` (n_cells,) marks, nor edges and vertices that touch none of the rest."""
    whole = RowsInMemory(mesh)
    return reduced(whole, kept_with(whole, np.flatnonzero(~missing)))


def reduced(whole: MeshRows, kept: Kept) -> VoronoiMesh:
    """The mesh of what is `kept` of the whole alone."""
    numbers = {"n_cells": kept.cells, "n_edges": kept.edges, "n_vertices": kept.vertices}
    arrays = {}
    for variable in MESH_VARIABLES:
        if variable.name in WEIGHTS:
            continue
        values = whole.rows(variable.name, numbers[variable.dimensions[0]])
        if variable.of is not None:
            values = _renumbered(values, numbers[variable.of])
        arrays[variable.name] = values
    gone = (whole.rows("cells_on_vertex", kept.vertices) >= 0) & (arrays["cells_on_vertex"] < 0)
    kites = np.where(gone, 0.0, arrays["kite_areas_on_vertex"])
    area = np.where(gone.any(axis=1), kites.sum(axis=1), arrays["area_triangle"])
    arrays |= {"kite_areas_on_vertex": kites, "area_triangle": area}
    arrays |= dict(zip(WEIGHTS, _weights(whole, kept, arrays["cells_on_edge"] >= 0), strict=True))
    return whole.with_arrays(arrays, kept.cells)


def _weights(whole: MeshRows, kept: Kept, stays: NDArray[np.bool_]) -> tuple[Index, Index, Array]:
    """`WEIGHTS` of the kept edges, where only those of their cells count that `stays` (n, 2) marks."""
    cells = whole.rows("cells_on_edge", kept.edges)
    beside = np.unique(cells[cells >= 0])
    sizes_beside = np.append(whole.rows("n_edges_on_cell", beside), 0)
    edges, weights = whole.rows("edges_on_edge", kept.edges).astype(np.int32), whole.rows("weights_on_edge", kept.edges)
    counts = np.empty(len(edges), np.int32)
    for low in range(0, len(edges), BLOCK):  # what is between takes several times the memory of the rows
        rows = slice(low, low + BLOCK)
        sizes = np.where(cells[rows] >= 0, sizes_beside[_renumbered(cells[rows], beside)] - 1, 0)
        used = _of_those_that_stay(sizes, stays[rows], edges.shape[1])
        order = np.argsort(~used, axis=1, kind="stable")
        counts[rows] = used.sum(axis=1)
        numbers = np.where(used, _renumbered(edges[rows], kept.edges), FILL)
        edges[rows] = np.take_along_axis(numbers, order, axis=1)
        weights[rows] = np.take_along_axis(np.where(used, weights[rows], 0.0), order, axis=1)
    return counts, edges, weights


def _of_those_that_stay(sizes: Index, stays: NDArray[np.bool_], width: int) -> NDArray[np.bool_]:
    """Which entries (n, width) of the weights belong to a cell that stays, where both (n, 2) cells have `sizes`."""
    place = np.arange(width)
    of_first = place < sizes[:, :1]
    return (place < sizes.sum(axis=1, keepdims=True)) & np.where(of_first, stays[:, :1], stays[:, 1:])


def _renumbered(values: Index, kept: Index) -> Index:
    """The places, int32, of `values` among the `kept` numbers, in ascending order; -1 for those that are not there."""
    if not kept.size:
        return np.full(values.shape, FILL, np.int32)
    kept = kept.astype(values.dtype)  # so that no wider copy of the values is made
    place = np.searchsorted(kept, values).astype(np.int32)
    found = kept[np.minimum(place, len(kept) - 1)] == values
    return np.where(found, place, np.int32(FILL))

"""A mesh without some of its cells: a mesh in which neighbours are missing (`mesh.discrete.walls`).

Entities keep their order, and every cell the order of its ring, so that sums round a cell come out the same.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.conventions import MESH_VARIABLES
from mesh.voronoi_mesh import VoronoiMesh

FILL = -1

PLACES = ("n_cells", "n_edges", "n_vertices")

WEIGHTS = ("n_edges_on_edge", "edges_on_edge", "weights_on_edge")
"""Arrays of the tangential velocity, of which edges beside a missing cell keep those of the other cell alone."""


@dataclass(frozen=True, eq=False)
class Kept:
    """Numbers, in ascending order, of the cells, edges and vertices of a mesh that a part of it keeps."""

    cells: Index
    edges: Index
    vertices: Index


def beside(marked: NDArray[np.bool_], neighbours: Index) -> NDArray[np.bool_]:
    """Which of the `neighbours` (n, k) are there and `marked`."""
    return np.append(marked, False)[neighbours]


def kept_with(mesh: VoronoiMesh, cells: NDArray[np.bool_]) -> Kept:
    """The marked `cells` (n_cells,) and what touches them."""
    return Kept(
        np.flatnonzero(cells),
        np.flatnonzero(beside(cells, mesh.cells_on_edge).any(axis=1)),
        np.flatnonzero(beside(cells, mesh.cells_on_vertex).any(axis=1)),
    )


def without_cells(mesh: VoronoiMesh, missing: NDArray[np.bool_]) -> VoronoiMesh:
    """`mesh` without the cells that `missing` (n_cells,) marks, nor edges and vertices that touch none of the rest."""
    return _reduced(mesh, kept_with(mesh, ~missing), ~missing)


def _reduced(mesh: VoronoiMesh, kept: Kept, there: NDArray[np.bool_]) -> VoronoiMesh:
    """`mesh` with what is `kept` alone; `there` (n_cells,) marks its cells."""
    numbers = dict(zip(PLACES, (kept.cells, kept.edges, kept.vertices), strict=True))
    renumbering = {place: _renumbering(chosen, getattr(mesh, place)) for place, chosen in numbers.items()}
    arrays = {}
    for variable in MESH_VARIABLES:
        if variable.name in WEIGHTS or getattr(mesh, variable.name) is None:
            continue
        values = getattr(mesh, variable.name)[numbers[variable.dimensions[0]]]
        if variable.of is not None:
            values = renumbering[variable.of][values].astype(np.int32)
        arrays[variable.name] = values
    cells = mesh.cells_on_vertex[kept.vertices]
    gone = (cells >= 0) & ~beside(there, cells)
    kites = np.where(gone, 0.0, arrays["kite_areas_on_vertex"])
    area = np.where(gone.any(axis=1), kites.sum(axis=1), arrays["area_triangle"])
    arrays |= {"kite_areas_on_vertex": kites, "area_triangle": area}
    arrays |= dict(zip(WEIGHTS, _weights(mesh, kept.edges, there, renumbering["n_edges"]), strict=True))
    fixed = None if mesh.fixed_cells is None else mesh.fixed_cells[kept.cells]
    return replace(mesh, **{**arrays, "fixed_cells": fixed})


def _weights(
    mesh: VoronoiMesh, edges: Index, there: NDArray[np.bool_], renumbering: Index
) -> tuple[Index, Index, Array]:
    """`WEIGHTS` of the `edges`, where only the cells that are `there` count."""
    cells = mesh.cells_on_edge[edges]
    sizes = np.where(cells >= 0, mesh.n_edges_on_cell[cells] - 1, 0)
    place, stays = np.arange(mesh.edges_on_edge.shape[1]), beside(there, cells)
    of_first = place < sizes[:, :1]
    used = (place < sizes.sum(axis=1, keepdims=True)) & np.where(of_first, stays[:, :1], stays[:, 1:])
    order = np.argsort(~used, axis=1, kind="stable")
    around = np.where(used, renumbering[mesh.edges_on_edge[edges]], FILL)
    weights = np.where(used, mesh.weights_on_edge[edges], 0.0)
    return (
        used.sum(axis=1).astype(np.int32),
        np.take_along_axis(around, order, axis=1).astype(np.int32),
        np.take_along_axis(weights, order, axis=1),
    )


def _renumbering(kept: Index, size: int) -> Index:
    """New numbers of `size` entities, and of the missing one, which is the last."""
    numbers = np.full(size + 1, FILL)
    numbers[kept] = np.arange(len(kept))
    return numbers

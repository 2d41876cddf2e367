"""A part of a mesh: cells taken out, and what then has no cell beside it taken out or left without a neighbour."""

from dataclasses import fields, replace

import numpy as np

from mesh.arrays import Index
from mesh.voronoi_mesh import VoronoiMesh

FILL = -1


def without_cells(mesh: VoronoiMesh, missing: np.ndarray) -> VoronoiMesh:
    """`mesh` without the cells that `missing` (n_cells,) marks, nor edges and vertices that touch none of the rest."""
    cells = np.flatnonzero(~missing)
    edges = np.flatnonzero(~missing[mesh.cells_on_edge].all(axis=1))
    vertices = np.flatnonzero(~missing[mesh.cells_on_vertex].all(axis=1))
    cell, edge, vertex = (
        renumbering(kept, size)
        for kept, size in ((cells, mesh.n_cells), (edges, mesh.n_edges), (vertices, mesh.n_vertices))
    )
    kept = {"n_cells": cells, "n_edges": edges, "n_vertices": vertices}
    arrays = {
        field.name: values[kept[place]]
        for field in fields(VoronoiMesh)
        if isinstance(values := getattr(mesh, field.name), np.ndarray)
        for place in [next(name for name in kept if len(values) == getattr(mesh, name))]
    }
    on_ring = np.arange(mesh.max_edges) < arrays["n_edges_on_cell"][:, None]
    kites = np.where(missing[arrays["cells_on_vertex"]], 0.0, arrays["kite_areas_on_vertex"])
    # Edges beside a missing cell keep the weights of the other cell alone.
    there = ~missing[arrays["cells_on_edge"]]
    sizes = mesh.n_edges_on_cell[arrays["cells_on_edge"]] - 1
    place = np.arange(mesh.edges_on_edge.shape[1])
    of_first = place < sizes[:, :1]
    used = (place < sizes.sum(axis=1, keepdims=True)) & np.where(of_first, there[:, :1], there[:, 1:])
    order = np.argsort(~used, axis=1, kind="stable")
    return replace(
        mesh,
        **{
            **arrays,
            "cells_on_edge": renumbered(cell, arrays["cells_on_edge"]),
            "cells_on_vertex": renumbered(cell, arrays["cells_on_vertex"]),
            "edges_on_vertex": renumbered(edge, arrays["edges_on_vertex"]),
            "vertices_on_edge": renumbered(vertex, arrays["vertices_on_edge"]),
            "cells_on_cell": np.where(on_ring, renumbered(cell, arrays["cells_on_cell"]), FILL).astype(np.int32),
            "edges_on_cell": np.where(on_ring, renumbered(edge, arrays["edges_on_cell"]), FILL).astype(np.int32),
            "vertices_on_cell": np.where(on_ring, renumbered(vertex, arrays["vertices_on_cell"]), FILL).astype(
                np.int32
            ),
            "n_edges_on_edge": used.sum(axis=1).astype(np.int32),
            "edges_on_edge": np.take_along_axis(
                np.where(used, renumbered(edge, arrays["edges_on_edge"]), FILL), order, axis=1
            ).astype(np.int32),
            "weights_on_edge": np.take_along_axis(np.where(used, arrays["weights_on_edge"], 0.0), order, axis=1),
            "kite_areas_on_vertex": kites,
            "area_triangle": np.where(
                missing[arrays["cells_on_vertex"]].any(axis=1), kites.sum(axis=1), arrays["area_triangle"]
            ),
        },
    )


def without_cap(mesh: VoronoiMesh, latitude: float = 0.6) -> VoronoiMesh:
    """`mesh` without the cells whose centres are north of `latitude`, radians, and without a single one elsewhere."""
    missing = mesh.lat_cell > latitude
    missing[np.argmin(mesh.lat_cell)] = True
    return without_cells(mesh, missing)


def renumbering(kept: Index, size: int) -> Index:
    numbers = np.full(size, FILL)
    numbers[kept] = np.arange(len(kept))
    return numbers


def renumbered(numbers: Index, old: Index) -> Index:
    return np.where(old >= 0, numbers[old], FILL).astype(np.int32)

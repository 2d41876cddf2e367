"""The TRiSK weights that reconstruct tangential from normal velocities."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.voronoi_mesh import Topology


def tangential_weights(topology: Topology, kites: Array, area_cell: Array, dc_edge: Array, dv_edge: Array) -> Array:
    """Weights (n_edges, 2 max_edges) of the normal velocities at `edges_on_edge` in the tangential velocity.

    Thuburn et al. (2009), equation (33), with the lengths dv_e'/dc_e of Ringler et al. (2010), equation (24),
    multiplied in. The order follows `edges_on_edge`; entries beyond `n_edges_on_edge` are zero. An edge at a wall has
    the part of its one cell alone.
    """
    return _tangential_weights(
        topology.n_edges_on_cell,
        topology.edges_on_cell,
        topology.vertices_on_cell,
        topology.cells_on_edge,
        topology.cells_on_vertex,
        kites,
        area_cell,
        dc_edge,
        dv_edge,
    )


@numba.njit(cache=True, parallel=True)
def _tangential_weights(
    n_edges_on_cell: Index,
    edges_on_cell: Index,
    vertices_on_cell: Index,
    cells_on_edge: Index,
    cells_on_vertex: Index,
    kites: Array,
    area_cell: Array,
    dc_edge: Array,
    dv_edge: Array,
) -> Array:
    n_edges = cells_on_edge.shape[0]
    weights = np.zeros((n_edges, 2 * edges_on_cell.shape[1]))
    for e in numba.prange(n_edges):
        k = 0
        for side in range(2):
            c = cells_on_edge[e, side]
            if c < 0:
                continue
            n = n_edges_on_cell[c]
            # The edge's tangent runs counter-clockwise round its first cell and clockwise round its second.
            turn = 1.0 if side == 0 else -1.0
            position = 0
            while edges_on_cell[c, position] != e:
                position += 1
            passed = 0.0  # fraction of the cell's area in the kites between edge e and the present edge
            for step in range(1, n):
                v = vertices_on_cell[c, (position + step - 1) % n]
                for j in range(3):
                    if cells_on_vertex[v, j] == c:
                        passed += kites[v, j] / area_cell[c]
                other = edges_on_cell[c, (position + step) % n]
                outward = 1.0 if cells_on_edge[other, 0] == c else -1.0
                weights[e, k] = turn * outward * (0.5 - passed) * dv_edge[other] / dc_edge[e]
                k += 1
    return weights

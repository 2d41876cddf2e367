"""Compiled loops of the ready terms over edges; meshes are closed (`mesh.discrete.walls.closed_mesh`)."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.equations.kernels import compiled


@compiled
def over_thickness(values: Array, h: Array, cells_on_edge: Index, result: Array) -> None:
    """values_e / h_e at edges, with h_e the mean of the two cells."""
    for e in numba.prange(result.size):
        result[e] = 2.0 * values[e] / (h[cells_on_edge[e, 0]] + h[cells_on_edge[e, 1]])


@compiled
def quadratic_drag(coefficient: float, h: Array, u: Array, K: Array, cells_on_edge: Index, result: Array) -> None:
    """-C sqrt(K_1 + K_2) u_e / h_e at edges: the square of the speed there is twice the mean of K of the two cells."""
    for e in numba.prange(result.size):
        i, j = cells_on_edge[e, 0], cells_on_edge[e, 1]
        result[e] = -2.0 * coefficient * np.sqrt(K[i] + K[j]) * u[e] / (h[i] + h[j])

"""Numbering along a space-filling curve, so that neighbours lie close in memory."""

from collections.abc import Iterable

import numba
import numpy as np

from mesh.arrays import Array, Index

HILBERT_BITS = 20
"""Each face of the cube has 2^20 by 2^20 places on its curve."""

DISORDER = 1.5
"""A mesh keeps its own numbering unless it separates this many times as many neighbours as a Hilbert curve does."""


def keeps_neighbours(by_number: Index, by_curve: Index, edges: Iterable[Index]) -> bool:
    """Whether a mesh is divided along its own numbering about as well as along a curve.

    That is judged by the neighbours that stand apart in groups (n_cells,) made by either. `edges` gives some rows
    (n, 2) at a time of its cells on edges, negative where none is.
    """
    parted = np.zeros(2, np.int64)
    for ends in edges:
        first, second = ends[(ends >= 0).all(axis=1)].T
        parted += [np.count_nonzero(groups[first] != groups[second]) for groups in (by_number, by_curve)]
    return bool(parted[0] <= DISORDER * parted[1])


def renumber(points: Array, triangles: Index) -> tuple[Array, Index]:
    """Points (n, 3) along the curve, and their triangles (m, 3), sorted by their lowest corner."""
    order = hilbert_order(points)
    rank = inverse_order(order)
    return np.ascontiguousarray(points[order]), sort_triangles(rank[triangles])


def hilbert_order(points: Array) -> Index:
    """Permutation (n,) that numbers unit vectors (n, 3) along Hilbert curves on the six faces of a cube."""
    return np.argsort(hilbert_keys(points), kind="stable")


def inverse_order(order: Index) -> Index:
    """Place (n,), int32, of every entity in the permutation `order` (n,)."""
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return rank


def sort_triangles(triangles: Index) -> Index:
    """Triangles (m, 3), int32, turned so that the lowest corner comes first, and sorted."""
    turned = turn_triangles(triangles)
    keys = (turned[:, 0].astype(np.int64) << 32) + turned[:, 1]
    return turned[np.argsort(keys, kind="stable")]


def turn_triangles(triangles: Index) -> Index:
    """Triangles (m, 3), int32, turned so that the lowest corner comes first."""
    return _turned(np.ascontiguousarray(triangles, dtype=np.int32))


@numba.njit(cache=True)
def _turned(triangles: Index) -> Index:
    turned = np.empty_like(triangles)
    for triangle in range(len(triangles)):
        a, b, c = triangles[triangle]
        if b < a and b <= c:
            a, b, c = b, c, a
        elif c < a:
            a, b, c = c, a, b
        turned[triangle, 0], turned[triangle, 1], turned[triangle, 2] = a, b, c
    return turned


@numba.njit(parallel=True, cache=True)
def hilbert_keys(points: Array) -> Index:
    """Places (n,), int64, of unit vectors (n, 3) along the curves of `hilbert_order`."""
    keys = np.empty(len(points), np.int64)
    for point in numba.prange(len(points)):
        axis = 0
        for candidate in range(1, 3):
            if abs(points[point, candidate]) > abs(points[point, axis]):
                axis = candidate
        height = points[point, axis]
        scale = 0.5 * ((1 << HILBERT_BITS) - 1)
        column = int((points[point, (axis + 1) % 3] / abs(height) + 1.0) * scale + 0.5)
        row = int((points[point, (axis + 2) % 3] / abs(height) + 1.0) * scale + 0.5)
        face = 2 * axis + (1 if height < 0.0 else 0)
        keys[point] = (face << (2 * HILBERT_BITS)) + _hilbert_position(column, row)
    return keys


@numba.njit(cache=True)
def _hilbert_position(column: int, row: int) -> int:
    """Place of a square of the grid along the plane Hilbert curve."""
    position = 0
    size = 1 << HILBERT_BITS
    half = size >> 1
    while half > 0:
        right = 1 if column & half else 0
        upper = 1 if row & half else 0
        position = 4 * position + ((3 * right) ^ upper)
        if upper == 0:
            if right == 1:
                column = size - 1 - column
                row = size - 1 - row
            column, row = row, column
        half >>= 1
    return position

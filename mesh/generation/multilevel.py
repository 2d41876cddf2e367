"""A multilevel preconditioner for the clustering energy, additive after Bramble, Pasciak and Xu (1990).

In Lloyd-scaled variables (`mesh.generation.lbfgs`) the second derivative of the energy acts on smooth displacements of
wave number k like (k h)^2, h the spacing, so that iterations with a diagonal preconditioner grow like 1/h. Here

    B = I + gain * sum over levels of P_l P_l^T,

where P_l interpolates linearly from an icosahedral grid of level l, which does not depend on the mesh, to the points.
In two dimensions a hat function of any width has about the same energy, so one gain serves all levels. B is symmetric,
positive definite, and costs a tenth of an evaluation of the gradient.
"""

from collections.abc import Sequence

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.generation.generators import bisect, icosahedral_mesh
from mesh.geometry.vectors import triple_product, vector_to
from mesh.triangulation.ordering import hilbert_order, inverse_order

Single = NDArray[np.float32]

ROW_BLOCK = 1024
"""Rows that one thread handles at a time."""

SERIAL_LIMIT = 4096
"""With fewer rows than this, one thread is faster."""

SMALLEST_WEIGHT = 1.0e-6
"""Weights below this are left out of an interpolation."""

CELLS_PER_GRID_POINT = 4.0
"""Mesh points per point of the finest grid, about."""


@numba.njit(cache=True)
def _transpose(targets: Index, weights: Single, n_coarse: int) -> tuple[Index, Index, Single]:
    """Rows of the transpose of a sparse matrix given by (n, k) targets, weights.

    Returns starts (n_coarse + 1,), sources and their weights; sources ascend within a row.
    """
    starts = np.zeros(n_coarse + 1, np.int32)
    for source in range(targets.shape[0]):
        for k in range(targets.shape[1]):
            if weights[source, k] != 0.0:
                starts[targets[source, k] + 1] += 1
    for target in range(n_coarse):
        starts[target + 1] += starts[target]
    filled = starts[:-1].copy()
    sources = np.empty(starts[-1], np.int32)
    values = np.empty(starts[-1], np.float32)
    for source in range(targets.shape[0]):
        for k in range(targets.shape[1]):
            if weights[source, k] != 0.0:
                slot = filled[targets[source, k]]
                sources[slot] = source
                values[slot] = weights[source, k]
                filled[targets[source, k]] += 1
    return starts, sources, values


@numba.njit(cache=True)
def _restrict_rows(
    fine: Array, starts: Index, sources: Index, values: Single, coarse: Array, first: int, last: int
) -> None:
    """Rows first ... last - 1 of coarse = transposed interpolation of fine."""
    for target in range(first, last):
        x, y, z = 0.0, 0.0, 0.0
        for slot in range(starts[target], starts[target + 1]):
            source, value = sources[slot], values[slot]
            x += value * fine[source, 0]
            y += value * fine[source, 1]
            z += value * fine[source, 2]
        coarse[target, 0], coarse[target, 1], coarse[target, 2] = x, y, z


@numba.njit(cache=True)
def _prolong_rows(
    coarse: Array, targets: Index, weights: Single, fine: Array, scale: float, result: Array, first: int, last: int
) -> None:
    """Rows first ... last - 1 of result = scale * fine + interpolation of coarse."""
    for source in range(first, last):
        x, y, z = scale * fine[source, 0], scale * fine[source, 1], scale * fine[source, 2]
        for k in range(targets.shape[1]):
            target, value = targets[source, k], weights[source, k]
            x += value * coarse[target, 0]
            y += value * coarse[target, 1]
            z += value * coarse[target, 2]
        result[source, 0], result[source, 1], result[source, 2] = x, y, z


@numba.njit(parallel=True, cache=True)
def _restrict_parallel(fine: Array, starts: Index, sources: Index, values: Single, coarse: Array) -> None:
    """All rows of coarse = transposed interpolation of fine, by blocks."""
    for block in numba.prange((len(coarse) + ROW_BLOCK - 1) // ROW_BLOCK):
        _restrict_rows(
            fine, starts, sources, values, coarse, block * ROW_BLOCK, min((block + 1) * ROW_BLOCK, len(coarse))
        )


@numba.njit(parallel=True, cache=True)
def _prolong_parallel(coarse: Array, targets: Index, weights: Single, fine: Array, scale: float, result: Array) -> None:
    """All rows of result = scale * fine + interpolation of coarse, by blocks."""
    for block in numba.prange((len(fine) + ROW_BLOCK - 1) // ROW_BLOCK):
        _prolong_rows(
            coarse, targets, weights, fine, scale, result, block * ROW_BLOCK, min((block + 1) * ROW_BLOCK, len(fine))
        )


@numba.njit(cache=True)
def _side_of(points: Array, point: int, grid: Array, a: int, b: int) -> float:
    """det(a, b, point), positive to the left of the arc a -> b."""
    return triple_product(vector_to(points, point), vector_to(grid, a), vector_to(grid, b))


@numba.njit(parallel=True, cache=True)
def _locate(points: Array, grid: Array, triangles: Index, hints: Index, families: bool) -> Index:
    """Triangle (n,) of the grid that contains each point.

    With `families`, the four children of the triangle of the coarser grid in `hints`; else all triangles are tried.
    """
    found = np.empty(len(points), np.int32)
    for point in numba.prange(len(points)):
        start, stop = 0, len(triangles)
        if families:
            start, stop = 4 * hints[point], 4 * hints[point] + 4
        best, best_margin = start, -1.0e300
        for triangle in range(start, stop):
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            margin = min(
                _side_of(points, point, grid, a, b),
                _side_of(points, point, grid, b, c),
                _side_of(points, point, grid, c, a),
            )
            if margin > best_margin:
                best, best_margin = triangle, margin
        found[point] = best
    return found


@numba.njit(parallel=True, cache=True)
def _interpolation_weights(points: Array, grid: Array, triangles: Index, located: Index) -> tuple[Index, Single]:
    """Corners (n, 3) int32 and weights (n, 3) float32 in the located triangles."""
    targets = np.empty((len(points), 3), np.int32)
    weights = np.empty((len(points), 3), np.float32)
    for point in numba.prange(len(points)):
        triangle = located[point]
        total = 0.0
        shares = np.empty(3)
        for k in range(3):
            a, b = triangles[triangle, (k + 1) % 3], triangles[triangle, (k + 2) % 3]
            shares[k] = max(_side_of(points, point, grid, a, b), 0.0)
            total += shares[k]
        for k in range(3):
            targets[point, k] = triangles[triangle, k]
            share = shares[k] / total
            weights[point, k] = share if share > SMALLEST_WEIGHT else 0.0
    return targets, weights


class Transfer:
    """Linear interpolation from a coarse grid (m points) to finer points (n), and its transpose.

    Fine point i is the sum over k of `weights[i, k]` times coarse point `targets[i, k]`. At coarse points on walls the
    component across them is held at zero: `held` gives those points for each component.
    """

    def __init__(self, targets: Index, weights: Single, n_coarse: int, held: Sequence[Index] = ()) -> None:
        self._held = held
        self._targets = np.ascontiguousarray(targets, dtype=np.int32)
        self._weights = np.ascontiguousarray(weights, dtype=np.float32)
        self._transpose = _transpose(self._targets, self._weights, n_coarse)
        self._coarse = np.empty((n_coarse, 3))

    def restrict(self, fine: Array) -> Array:
        """Transposed interpolation (m, 3) of `fine` (n, 3), in a buffer that the next call overwrites."""
        if len(self._coarse) < SERIAL_LIMIT:
            _restrict_rows(fine, *self._transpose, self._coarse, 0, len(self._coarse))
        else:
            _restrict_parallel(fine, *self._transpose, self._coarse)
        for component, points in enumerate(self._held):
            self._coarse[points, component] = 0.0
        return self._coarse

    def prolong_add(self, coarse: Array, fine: Array, scale: float, result: Array) -> None:
        """Write scale * fine + interpolation of `coarse` (m, 3) to `result` (n, 3), which may be `fine`."""
        if len(fine) < SERIAL_LIMIT:
            _prolong_rows(coarse, self._targets, self._weights, fine, scale, result, 0, len(fine))
        else:
            _prolong_parallel(coarse, self._targets, self._weights, fine, scale, result)


class MultilevelPreconditioner:
    """B = I + gain * sum P_l P_l^T for points that stay near where they were when it was made."""

    def __init__(self, transfers: Sequence[Transfer], gain: float) -> None:
        """Take the transfers from the finest grid to the points, then from each grid to the next finer one."""
        self._gain, self._transfers = gain, transfers

    def apply(self, vector: Array, result: Array) -> None:
        """Write B times `vector` (n, 3) to `result`."""
        restricted = [vector]
        for transfer in self._transfers:
            restricted.append(transfer.restrict(restricted[-1]))
        total = restricted.pop()
        total *= self._gain
        for transfer, fine in zip(self._transfers[:0:-1], restricted[:0:-1], strict=True):
            transfer.prolong_add(total, fine, self._gain, fine)
            total = fine
        self._transfers[0].prolong_add(total, vector, 1.0, result)


def preconditioner_on_sphere(points: Array, gain: float) -> MultilevelPreconditioner:
    """The preconditioner for unit vectors `points` (n, 3)."""
    return MultilevelPreconditioner(_transfers(points), gain)


def _transfers(points: Array) -> list[Transfer]:
    """Transfers from the finest grid to `points`, then from each grid to the next finer one, finest first."""
    grid, triangles = icosahedral_mesh(0)
    located = _locate(points, grid, triangles, np.zeros(1, np.int32), False)
    between: list[Transfer] = []
    rank: Index = np.arange(len(grid), dtype=np.int32)
    while CELLS_PER_GRID_POINT * (4 * len(grid) - 6) <= 1.2 * len(points):
        coarse_rank, n_coarse = rank, len(grid)
        grid, triangles, ends = bisect(grid, triangles)
        located = _locate(points, grid, triangles, located, True)
        order = hilbert_order(grid)
        rank = inverse_order(order)
        kept = np.repeat(np.arange(n_coarse, dtype=np.int32)[:, None], 2, axis=1)
        parents = np.concatenate([kept, ends])[order]
        between.append(Transfer(coarse_rank[parents], np.full(parents.shape, 0.5), n_coarse))
    targets, weights = _interpolation_weights(points, grid, triangles, located)
    return [Transfer(rank[targets], weights, len(grid)), *between[::-1]]

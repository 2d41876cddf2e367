"""Well-centred meshes: give up a little centroidality for triangles without right or obtuse angles.

A Delaunay triangle with an obtuse angle has its circumcentre, a vertex of the mesh, outside; then edges of the C-grid
do not cross. With q the quality of `mesh.triangulation.triangle_quality`, minimised, by L-BFGS on a fixed
triangulation, is

    sum over cells of weight_i |x_i - c_i|^2 + sum over triangles of max(0, goal - q)^2.

Settling leaves the first sum out and moves only the cells near triangles below the goal; in between, sides are turned
where that improves the worse of their two triangles. Relaxing is Lloyd's method under the penalty: the c_i are the
centroids of the cells, and become those of the new cells after each round.
"""

import time
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from mesh.arrays import Array, Index
from mesh.density.named import Density, uniform
from mesh.geometry.sphere import dot, mean_spacing, normalize
from mesh.geometry.vectors import chord
from mesh.integrals.weighted_moments import WeightedCells, centroid_distances
from mesh.triangulation.half_edges import build_twins, first_corners
from mesh.triangulation.moving import Triangulation
from mesh.triangulation.repair import flip
from mesh.triangulation.triangle_quality import near_bad_triangles, qualities, quality_of_triangle

GOAL = 0.86
"""Least quality asked for; above 0.8285 no angle is right or obtuse."""

GOAL_MARGIN = 0.004
"""While cells relax, the penalty starts this far above the goal, because it is soft."""

ANCHOR = 0.003
"""Weight of the clustering energy against the penalty."""

SETTLE_RINGS, RELAX_RINGS = 4, 6
SETTLE_ROUNDS, RELAX_ROUNDS = 20, 20
SETTLE_ITERATIONS, RELAX_ITERATIONS = 300, 20

WORTHWHILE = 0.97
"""Relaxing ends after a round that leaves more than this fraction of the largest residual."""

SMALLEST_GAIN = 1e-9
"""Sides are turned only for a larger gain in quality than this."""


@dataclass(frozen=True)
class WellCentered:
    """A mesh with better angles: points (n, 3), their Delaunay triangles, and the residual that was given up.

    Residuals are the largest distances to the centroids, in mean spacings, before and after. Reaching the goal is not
    guaranteed: look at `least_quality`.
    """

    points: Array
    triangles: Index
    least_quality: float
    residual_before: float
    residual: float


def well_center(
    points: Array,
    triangles: Index,
    density: Density = uniform,
    fixed: NDArray[np.bool_] | None = None,
    goal: float = GOAL,
    seconds: float = float("inf"),
) -> WellCentered:
    """Raise the least quality of a converged mesh of unit vectors `points` (n, 3) to the `goal`.

    Generators that are `fixed` (n,) stay, and so do those far from triangles below the goal. No round begins after
    `seconds`; unless they run out, the result is deterministic.
    """
    work = _Work(points, triangles, density, fixed, time.perf_counter() + seconds)
    before = residual = work.residual()
    free = work.near(goal + GOAL_MARGIN, RELAX_RINGS)
    work.settle(goal)
    free |= work.near(goal + GOAL_MARGIN, RELAX_RINGS)
    if free.any():
        residual = work.residual()
        for _ in range(RELAX_ROUNDS):
            if work.is_late():
                break
            work.relax(free, goal + GOAL_MARGIN)
            previous, residual = residual, work.residual()
            if residual > WORTHWHILE * previous:
                break
        work.settle(goal)
    final = work.delaunay().triangles
    return WellCentered(work.points, final, float(qualities(work.points, final).min()), before, work.residual())


class _Work:
    """Moving points, and the triangles whose quality counts."""

    def __init__(
        self, points: Array, triangles: Index, density: Density, fixed: NDArray[np.bool_] | None, deadline: float
    ) -> None:
        n = len(points)
        self.points = points.copy()
        self._triangles = np.array(triangles, np.int32, order="C")
        self._twins = build_twins(self._triangles, n)
        self._first_corner, self._degrees = first_corners(self._triangles, n)
        self._fixed = np.zeros(n, bool) if fixed is None else fixed
        self._cells = WeightedCells(density, n, fixed)
        self._deadline = deadline

    def is_late(self) -> bool:
        """Whether the time has run out."""
        return time.perf_counter() >= self._deadline

    def delaunay(self) -> Triangulation:
        """The Delaunay triangulation of the points: the present one where that is well-centred."""
        return Triangulation(self.points, self._triangles)

    def near(self, wanted: float, rings: int) -> NDArray[np.bool_]:
        """Mask (n,) of the free cells within so many rings of a triangle below a quality."""
        return near_bad_triangles(self.points, self._triangles, wanted, rings) & ~self._fixed

    def residual(self) -> float:
        """Largest distance of a free generator from its centroid, in mean spacings."""
        return float(centroid_distances(self._integrals())[~self._fixed].max()) / mean_spacing(len(self.points))

    def settle(self, goal: float) -> None:
        """Raise the qualities below the goal, regardless of centroids."""
        for _ in range(SETTLE_ROUNDS):
            free = self.near(goal, SETTLE_RINGS)
            if not free.any() or self.is_late():
                return
            self._minimize(free, self.points[free], np.zeros(np.count_nonzero(free)), goal, SETTLE_ITERATIONS)
            arrays = (self._triangles, self._twins, self._first_corner, self._degrees)
            if not _turn_if_better(self.points, *arrays, goal):
                return

    def relax(self, free: NDArray[np.bool_], goal: float) -> None:
        """One round of Lloyd's method under the penalty for a mask (n,) of cells."""
        sums = self._integrals()
        centroids = normalize(self.points * sums[:, 4:5] + sums[:, 1:4])
        weights = ANCHOR * sums[free, 0] / sums[free, 5].mean()
        self._minimize(free, centroids[free], weights, goal, RELAX_ITERATIONS)

    def _integrals(self) -> Array:
        cells = self.delaunay()
        return self._cells.integrate(self.points, cells.circumcenters, cells.ring_starts, cells.rings)

    def _minimize(self, free: NDArray[np.bool_], anchors: Array, weights: Array, goal: float, iterations: int) -> None:
        """Move the free cells (n,); `anchors` and `weights` have one row for each of them."""
        rows = np.flatnonzero(free[self._triangles].any(axis=1))
        cells, local = np.unique(self._triangles[rows], return_inverse=True)
        patch = self.points[cells]
        _minimize_patch(patch, local.reshape(-1, 3), np.flatnonzero(free[cells]), anchors, weights, goal, iterations)
        self.points[cells] = patch


def _minimize_patch(
    points: Array, triangles: Index, free: Index, anchors: Array, weights: Array, goal: float, iterations: int
) -> None:
    """Minimise the objective over points[free], in place, on a fixed list of triangles."""
    gradient, slope = np.zeros_like(points), np.empty(3 * len(free))

    def objective(unknowns: Array) -> tuple[float, Array]:
        value = _objective(unknowns, points, free, triangles, anchors, weights, goal, gradient, slope)
        return value, slope.copy()

    # In units of the width of a triangle, steps of length one are sensible.
    sides = points[triangles[:, 0]] - points[triangles[:, 1]]
    width = float(np.sqrt(dot(sides, sides)).mean())
    options = {"maxiter": iterations, "maxcor": 10, "ftol": 1e-10, "gtol": 1e-7}
    solution = minimize(objective, points[free].ravel() / width, jac=True, method="L-BFGS-B", options=options)
    objective(solution.x)


@numba.njit(cache=True)
def _objective(
    unknowns: Array,
    points: Array,
    free: Index,
    triangles: Index,
    anchors: Array,
    weights: Array,
    goal: float,
    gradient: Array,
    result: Array,
) -> float:
    """Value of the objective at `unknowns` (3 * free,), positions before normalisation, which are written to points.

    `result` gets its gradient; `gradient` (n, 3) is a buffer.
    """
    gradient[:] = 0.0
    for index in range(len(free)):
        x, y, z = unknowns[3 * index], unknowns[3 * index + 1], unknowns[3 * index + 2]
        factor = 1.0 / np.sqrt(x * x + y * y + z * z)
        cell = free[index]
        points[cell, 0], points[cell, 1], points[cell, 2] = factor * x, factor * y, factor * z
    value = _penalty(points, triangles, goal, gradient)
    for index in range(len(free)):
        cell = free[index]
        size, radial = 0.0, 0.0
        for axis in range(3):
            away = points[cell, axis] - anchors[index, axis]
            value += weights[index] * away * away
            gradient[cell, axis] += 2.0 * weights[index] * away
            size += unknowns[3 * index + axis] * points[cell, axis]
            radial += gradient[cell, axis] * points[cell, axis]
        for axis in range(3):
            result[3 * index + axis] = (gradient[cell, axis] - radial * points[cell, axis]) / size
    return value


@numba.njit(cache=True, error_model="numpy")
def _penalty(points: Array, triangles: Index, goal: float, gradient: Array) -> float:
    """Sum of max(0, goal - q)^2; its gradient is added to `gradient` (n, 3)."""
    total = 0.0
    for triangle in range(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        q = quality_of_triangle(points, a, b, c)
        if q >= goal:
            continue
        total += (goal - q) ** 2
        u, v, w = chord(points, b, c), chord(points, c, a), chord(points, a, b)
        first, second, third = 1.0 / (v + w - u), 1.0 / (w + u - v), 1.0 / (u + v - w)
        factor = -2.0 * (goal - q) * q
        _pull(points, b, c, u, factor * (second + third - first - 1.0 / u), gradient)
        _pull(points, c, a, v, factor * (third + first - second - 1.0 / v), gradient)
        _pull(points, a, b, w, factor * (first + second - third - 1.0 / w), gradient)
    return total


@numba.njit(cache=True)
def _pull(points: Array, a: int, b: int, length: float, force: float, gradient: Array) -> None:
    """Add `force` times the gradient of the length of the chord from a to b."""
    for axis in range(3):
        part = force * (points[a, axis] - points[b, axis]) / length
        gradient[a, axis] += part
        gradient[b, axis] -= part


@numba.njit(cache=True)
def _turn_if_better(
    points: Array, triangles: Index, twins: Index, first_corner: Index, degrees: Index, goal: float
) -> int:
    """Turn each side of a triangle below the goal where that makes the worse of its two triangles better; how many."""
    turned = 0
    corners, flat = triangles.ravel(), twins.ravel()
    for half_edge in range(triangles.size):
        t, k = half_edge // 3, half_edge % 3
        a, b, c = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3], triangles[t, k]
        before = quality_of_triangle(points, a, b, c)
        if before >= goal:
            continue
        twin = flat[half_edge]
        d = corners[twin]
        before = min(before, quality_of_triangle(points, b, a, d))
        after = min(quality_of_triangle(points, c, a, d), quality_of_triangle(points, d, b, c))
        if after > before + SMALLEST_GAIN:
            flip(triangles, twins, first_corner, degrees, half_edge, twin)
            turned += 1
    return turned

"""The probabilistic generalized Lloyd method of Ju, Du and Gunzburger (2002), with MacQueen's method as a special case.

Each iteration draws samples from the density, assigns each to its nearest generator, and moves every generator x_i that
got any, with mean u_i, to

    ((alpha_1 j_i + beta_1) x_i + (alpha_2 j_i + beta_2) u_i) / (j_i + 1),

back on the sphere, where j_i = 1, 2, ... counts its updates, alpha_1 + alpha_2 = 1 and beta_1 + beta_2 = 1. One sample
an iteration with alpha_1 = beta_2 = 1 is MacQueen's method; many samples with alpha_2 = beta_2 = 1 are Lloyd's method
by sampling. Steps are random: the residual falls like the root of the number of samples at best. Once it
stops falling, the sampling error is reached; then steps are halved, which averages over twice as many samples, so
that any residual is reached in the end. Without alpha_2, as in MacQueen's method, means are over all samples anyway.
"""

import time
from dataclasses import dataclass

import numba
import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index, sum_by_index
from mesh.density.named import Density
from mesh.errors import MeshError
from mesh.generation.generators import random_points
from mesh.generation.optimizer import Callback, History, Iterate, Limits, ScvtResult
from mesh.geometry.sphere import mean_spacing, normalize
from mesh.integrals.weighted_moments import WeightedCells, centroid_distances
from mesh.triangulation.moving import Triangulation


@dataclass(frozen=True)
class Blend:
    """Number of samples an iteration, and alpha_2 and beta_2, the weights of their means (see the module)."""

    samples: int = 100_000
    alpha: float = 0.5
    beta: float = 0.5

    def __post_init__(self) -> None:
        if not (self.samples >= 1 and 0.0 <= self.alpha <= 1.0 and 0.0 <= self.beta <= 1.0):
            raise MeshError(
                f"the probabilistic method cannot take {self.samples} samples with weights {self.alpha:g} and "
                f"{self.beta:g}; it needs at least one sample and weights between 0 and 1"
            )


MACQUEEN = Blend(samples=1, alpha=0.0, beta=1.0)
"""MacQueen's method: each generator is the mean of all its samples so far."""

PATIENCE = 10
"""Entries of the history without a new smallest residual after which steps are halved."""


def probabilistic_lloyd(
    points: Array,
    density: Density,
    blend: Blend,
    seed: int,
    limits: Limits,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move unit vectors `points` (n, 3) by random samples of `density` until one of the `limits` is reached.

    Energy and residual are measured once in as many samples as there are generators; this counts as an iteration of
    the history and the limits.
    """
    generator = np.random.default_rng(seed)
    mover = _Mover(points, density, blend, generator)
    triangulation, cells = Triangulation(points), WeightedCells(density, len(points))
    history, begin = History(), time.perf_counter()
    last_change = 0
    while True:
        triangulation.update(mover.points)
        sums = cells.integrate(
            mover.points, triangulation.circumcenters, triangulation.ring_starts, triangulation.rings
        )
        history.energy.append(float(sums[:, 5].sum()))
        history.residual.append(float(centroid_distances(sums).max()) / mean_spacing(len(points)))
        history.seconds.append(time.perf_counter() - begin)
        if callback is not None:
            callback(Iterate(history.iterations, history.residual[-1], history.energy[-1], mover.points))
        reason = limits.reason_to_stop(history)
        if reason is not None:
            return ScvtResult(mover.points, triangulation.triangles, history, reason)
        if blend.alpha > 0.0 and _stands_still(history.residual[last_change:]):
            mover.halve_steps()
            last_change = len(history.residual)
        mover.sweep()


def _stands_still(residuals: list[float]) -> bool:
    """Whether none of the last residuals was a new smallest one."""
    return len(residuals) > PATIENCE and min(residuals[-PATIENCE:]) >= min(residuals[:-PATIENCE])


class _Mover:
    """Generators with the number of their updates."""

    def __init__(self, points: Array, density: Density, blend: Blend, generator: np.random.Generator) -> None:
        self.points = points.copy()
        self._updates = np.ones(len(points))
        self._density, self._blend, self._generator = density, blend, generator
        self._damping = 1.0

    def halve_steps(self) -> None:
        """From now on, go half as far towards the mean of the samples."""
        self._damping *= 0.5

    def sweep(self) -> None:
        """Enough iterations to draw at least as many samples as there are generators."""
        iterations = -(-len(self.points) // self._blend.samples)
        drawn = random_points(iterations * self._blend.samples, self._density, self._generator)
        if self._blend.samples == 1:
            _follow(self.points, drawn, self._updates, self._blend.alpha, self._blend.beta, self._damping)
            return
        for samples in np.split(drawn, iterations):
            self._update(samples, cKDTree(self.points).query(samples)[1])

    def _update(self, samples: Array, nearest: Index) -> None:
        counts = np.bincount(nearest, minlength=len(self.points))
        totals = np.stack([sum_by_index(nearest, part, len(self.points)) for part in samples.T], axis=1)
        moved = counts > 0
        means = totals[moved] / counts[moved, None]
        updates = self._updates[moved, None]
        share = self._damping * (self._blend.alpha * updates + self._blend.beta) / (updates + 1.0)
        self.points[moved] = normalize((1.0 - share) * self.points[moved] + share * means)
        self._updates[moved] += 1.0


@numba.njit(cache=True)
def _follow(points: Array, samples: Array, updates: Array, alpha: float, beta: float, damping: float) -> None:
    """Move the nearest of the points (n, 3) after each of the samples (m, 3); counts the updates (n,)."""
    for sample in range(len(samples)):
        x, y, z = samples[sample, 0], samples[sample, 1], samples[sample, 2]
        nearest, largest = 0, -2.0
        for point in range(len(points)):
            cosine = points[point, 0] * x + points[point, 1] * y + points[point, 2] * z
            if cosine > largest:
                nearest, largest = point, cosine
        share = damping * (alpha * updates[nearest] + beta) / (updates[nearest] + 1.0)
        x = (1.0 - share) * points[nearest, 0] + share * x
        y = (1.0 - share) * points[nearest, 1] + share * y
        z = (1.0 - share) * points[nearest, 2] + share * z
        length = np.sqrt(x * x + y * y + z * z)
        points[nearest, 0], points[nearest, 1], points[nearest, 2] = x / length, y / length, z / length
        updates[nearest] += 1.0

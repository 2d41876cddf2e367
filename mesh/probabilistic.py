"""The probabilistic generalized Lloyd method of Ju, Du and Gunzburger (2002), with MacQueen's method as a special case.

Each iteration draws samples from the density, gives each to its nearest generator, and moves a generator x_i that got
some, with mean u_i, to

    ((alpha_1 j_i + beta_1) x_i + (alpha_2 j_i + beta_2) u_i) / (j_i + 1),

back on the sphere, where j_i = 1, 2, ... counts its updates, alpha_1 + alpha_2 = 1 and beta_1 + beta_2 = 1. One sample
an iteration with alpha_1 = beta_2 = 1 is MacQueen's method; many samples with alpha_2 = beta_2 = 1 are Lloyd's method
by chance. Steps are random: the residual falls like the root of the number of samples at best.
"""

import time
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index, sum_by_index
from mesh.density import Density
from mesh.errors import MeshError
from mesh.generators import random_points
from mesh.moments import mean_spacing
from mesh.optimizer import Callback, History, Iterate, Limits, ScvtResult
from mesh.sphere import normalize
from mesh.triangulation import Triangulation
from mesh.weighted_moments import WeightedCells, centroid_distances


@dataclass(frozen=True)
class Weights:
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


MACQUEEN = Weights(samples=1, alpha=0.0, beta=1.0)
"""MacQueen's method: each generator is the mean of all samples that it ever got."""


def probabilistic_lloyd(
    points: Array,
    density: Density,
    weights: Weights,
    seed: int,
    limits: Limits,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move unit vectors `points` (n, 3) by random samples of `density` until one of the `limits` is reached.

    Energy and residual are measured once in as many samples as there are generators; this counts as an iteration of
    the history and the limits.
    """
    generator = np.random.default_rng(seed)
    mover = _Mover(points, density, weights, generator)
    triangulation, cells = Triangulation(points), WeightedCells(density, len(points))
    history, begin = History(), time.perf_counter()
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
        mover.sweep()


class _Mover:
    """Generators with the number of their updates."""

    def __init__(self, points: Array, density: Density, weights: Weights, generator: np.random.Generator) -> None:
        self.points = points.copy()
        self._updates = np.ones(len(points))
        self._density, self._weights, self._generator = density, weights, generator

    def sweep(self) -> None:
        """As many iterations as take at least as many samples as there are generators."""
        iterations = -(-len(self.points) // self._weights.samples)
        drawn = random_points(iterations * self._weights.samples, self._density, self._generator)
        for samples in np.split(drawn, iterations):
            self._update(samples, self._nearest(samples))

    def _nearest(self, samples: Array) -> Index:
        """The generator nearest to each sample."""
        if len(samples) == 1:  # one pass over the generators is quicker than a tree that serves once
            return np.argmax(self.points @ samples[0], keepdims=True)
        return cKDTree(self.points).query(samples)[1]

    def _update(self, samples: Array, nearest: Index) -> None:
        counts = np.bincount(nearest, minlength=len(self.points))
        totals = np.stack([sum_by_index(nearest, part, len(self.points)) for part in samples.T], axis=1)
        moved = counts > 0
        means = totals[moved] / counts[moved, None]
        updates = self._updates[moved, None]
        share = (self._weights.alpha * updates + self._weights.beta) / (updates + 1.0)
        self.points[moved] = normalize((1.0 - share) * self.points[moved] + share * means)
        self._updates[moved] += 1.0

"""Nested meshes: refine a part of a converged mesh and keep the rest as it is.

After section 4.1.3 of Ju, Ringler and Gunzburger (2011): generators are added where the density is above its lowest
value, all generators beyond the transition are held fixed, and the others move under the density. Cells of the fixed
part keep their width, and fine ones get that width over the fourth root of the density's ratio; the number of points
that gives just this is `natural_number`.
"""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.density.named import Density, density_at
from mesh.density.scaling import within_range
from mesh.errors import MeshError
from mesh.generation.generators import DEFAULT_SEED, MAXIMUM_CELLS
from mesh.generation.optimizer import Callback, Limits, Optimizer, ScvtResult
from mesh.generation.reseed import reseed
from mesh.generation.scvt import check_converged
from mesh.geometry.sphere import fibonacci_points, normalize
from mesh.triangulation.ordering import hilbert_order

PROBES = 20_000
"""Number of points over which the root of the density is averaged."""

BISECTED_ABOVE, TRISECTED_ABOVE = 1.3, 2.2
"""Edges are divided in two or three where cells should be narrower by at least this ratio."""

OUTSIDE = 1.0 + 1e-9
"""Where the ratio of widths is below this, nothing is refined and generators are fixed."""

SEARCH_STEPS = 60

WANTED_QUALITY = 0.72
RESEEDINGS = 8
"""How often, at most, the surroundings of triangles below the wanted quality are shaken and converged again."""


def nested_scvt(
    points: Array,
    triangles: Index,
    density: Density,
    cells: int | None = None,
    limits: Limits | None = None,
    callback: Callback | None = None,
    seed: int = DEFAULT_SEED,
) -> ScvtResult:
    """Refine the tessellation of unit vectors `points` (n, 3) with `triangles` where `density` is above its lowest.

    `cells` is the final number of generators; by default the one that keeps cell widths in proportion to those of the
    fixed cells. `seed` is for the shaking that removes bad triangles. The seconds of the `limits` are for the whole
    call. Raises `MeshError` for a number of cells that the region cannot take, or if the tolerance is not reached.
    """
    begin = time.perf_counter()
    limits = Limits() if limits is None else limits
    density = within_range(density)
    values = density_at(density, points)
    if not values.min() > 0.0:
        raise MeshError("the density is zero at a generator of the mesh to refine; give it a floor above zero")
    ratio = _Refinement(density, float(values.min()))
    cells = ratio.natural_number(len(points)) if cells is None else cells
    if cells <= len(points):
        raise MeshError(
            f"a nested mesh of {cells} cells cannot refine a mesh of {len(points)}; ask for more cells than that"
        )
    added = _subdivided_points(points, triangles, ratio, cells - len(points))
    everything = np.concatenate([points, added])
    fixed = np.concatenate([ratio(points) <= OUTSIDE, np.zeros(len(added), bool)])
    order = hilbert_order(everything)
    start = np.ascontiguousarray(everything[order])
    fixed = fixed[order]

    def converge(points: Array) -> ScvtResult:
        return Optimizer(points, density=density, fixed=fixed).run(limits.since(begin), callback)

    result = reseed(converge(start), converge, WANTED_QUALITY, RESEEDINGS, seed, fixed)
    check_converged(result, limits)
    return result


@dataclass(frozen=True)
class _Refinement:
    """Ratio of the coarse cell width to that wanted, the fourth root of density over its `lowest` value."""

    density: Density
    lowest: float

    def __call__(self, points: Array) -> Array:
        return (density_at(self.density, points) / self.lowest) ** 0.25

    def natural_number(self, n_coarse: int) -> int:
        """Number of points that gives the wanted widths: the coarse number times the mean squared ratio.

        Raises `MeshError` if that is more than a mesh can have.
        """
        number = n_coarse * float(np.mean(self(fibonacci_points(PROBES)) ** 2))
        if not number <= MAXIMUM_CELLS:
            raise MeshError(
                f"the density falls to {self.lowest:g} of its largest value, which asks for {number:.1e} cells; "
                "give it a floor"
            )
        return round(number)


@dataclass(frozen=True)
class _Candidates:
    """Points that subdivision of edges and triangles may add, (m, 3), and the ratios that decide.

    A point is taken where its ratio is at least `lower` and below `upper` times a scale common to all.
    """

    points: Array
    ratio: Array
    lower: Array
    upper: Array

    def chosen(self, scale: float) -> NDArray[np.bool_]:
        """Which points (m,) are taken for this scale."""
        return (self.ratio >= self.lower * scale) & (self.ratio < self.upper * scale)


def _candidates(points: Array, triangles: Index, ratio: _Refinement) -> _Candidates:
    """Midpoints of edges that are to be bisected; thirds of edges and midpoints of triangles to be trisected."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    start, end = points[sides[sides[:, 0] < sides[:, 1]].T]
    middles, centers = normalize(start + end), normalize(points[triangles].sum(axis=1))
    parts = [
        (middles, middles, BISECTED_ABOVE, TRISECTED_ABOVE),
        (normalize(2.0 * start + end), middles, TRISECTED_ABOVE, np.inf),
        (normalize(start + 2.0 * end), middles, TRISECTED_ABOVE, np.inf),
        (centers, centers, TRISECTED_ABOVE, np.inf),
    ]
    return _Candidates(
        points=np.concatenate([added for added, *_ in parts]),
        ratio=np.concatenate([ratio(deciding) for _, deciding, *_ in parts]),
        lower=np.concatenate([np.full(len(added), lower) for added, _, lower, _ in parts]),
        upper=np.concatenate([np.full(len(added), upper) for added, _, _, upper in parts]),
    )


def _subdivided_points(points: Array, triangles: Index, ratio: _Refinement, count: int) -> Array:
    """Points (count, 3) to add: bisects for the scale that gives just enough, and drops those of least ratio."""
    candidates = _candidates(points, triangles, ratio)
    low, high = 1.0 / BISECTED_ABOVE + OUTSIDE - 1.0, 2.0 * float(candidates.ratio.max())
    if np.count_nonzero(candidates.chosen(low)) < count:
        raise MeshError(
            f"subdivision of the refined region yields fewer than {count} new cells; ask for fewer cells, or start "
            "from a finer mesh"
        )
    for _ in range(SEARCH_STEPS):
        middle = 0.5 * (low + high)
        if np.count_nonzero(candidates.chosen(middle)) >= count:
            low = middle
        else:
            high = middle
    taken = np.flatnonzero(candidates.chosen(low))
    by_ratio = np.argsort(-candidates.ratio[taken], kind="stable")
    return candidates.points[taken[by_ratio[:count]]]

"""Coast meshes without short edges: shake their surroundings and converge again.

Where four generators nearly lie on a circle, mostly beside a dislocation of the lattice, an edge has hardly any length,
and the mesh is still a local minimum of the energy: smaller displacements lead back to it. So the cells within two
rings of such an edge are displaced at random by half a spacing, and the mesh is converged again, loosely, until no edge
is short; then to its tolerance. Cells far from there hardly move, and the result is as centroidal as any other.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, sum_by_index
from mesh.coast.corners import COAST, corners_of, following_rows
from mesh.coast.sea_cells import SeaCells, SeaResult
from mesh.errors import MeshError, MeshWarning
from mesh.generation.generators import DEFAULT_SEED
from mesh.geometry.sphere import arc_length, hexagon_spacing, normalize, triangle_area

INNER_EDGE, COASTAL_EDGE = 0.12, 0.32
"""Least lengths, in local spacings, of edges away from the coast, and of those along it or with an end there."""

LOOSE_TOLERANCE = 1e-4
"""Residual, in mean spacings, at which lengths of edges are known to some thousandths of a spacing."""

ATTEMPTS = 3
"""How often the mesh is converged to its tolerance again."""

SHAKES = 6
"""How often, in an attempt, the surroundings of short edges are displaced."""

SHAKEN_RINGS = 2
"""Rings of cells, around those of a short edge, that are displaced: fewer mostly fall back to where they were."""

AMPLITUDE = 0.5
"""Standard deviation of displacements in each direction, in local spacings."""

Converge = Callable[[Array, float], SeaResult]
"""Converges points (n, 3) to a tolerance in mean spacings."""


@dataclass(frozen=True, eq=False)
class SideLengths:
    """Sides (n_corners,) of clipped cells: their cells, their lengths, and whether they lie or end at the coast.

    `lengths` are in local spacings, those of hexagons as large as the cells on both sides in the mean, or as the one
    cell at the coast. `spacings` (n_cells,) are those of the cells, in radians.
    """

    cells: Index
    lengths: Array
    at_coast: NDArray[np.bool_]
    spacings: Array

    @property
    def shortfalls(self) -> Array:
        """By which part (n_corners,) of the least length a side is too short; zero if it is not."""
        return np.maximum(0.0, 1.0 - self.lengths / np.where(self.at_coast, COASTAL_EDGE, INNER_EDGE))

    @property
    def lacking(self) -> float:
        """Sum of the shortfalls: zero if no side is too short."""
        return float(self.shortfalls.sum())


def side_lengths(sea: SeaCells, points: Array) -> SideLengths:
    """The lengths of the sides of the clipped cells of generators `points` (n, 3).

    Raises `MeshError` as `corners_of` does.
    """
    corners = corners_of(sea)
    following = corners.places[following_rows(corners.starts)]
    spacings = hexagon_spacing(_areas(sea, points))
    own = spacings[corners.cells]
    other = np.where(corners.neighbours == COAST, own, spacings[corners.neighbours])
    lengths = arc_length(sea.circumcenters[corners.places], sea.circumcenters[following])
    at_coast = np.maximum(corners.places, following) >= sea.n_triangles
    return SideLengths(corners.cells, lengths / (0.5 * (own + other)), at_coast, spacings)


def without_short_edges(found: SeaResult, converge: Converge, tolerance: float, seed: int = DEFAULT_SEED) -> SeaResult:
    """The converged mesh that was `found`, or one near it without short edges, or with fewer.

    It is as centroidal, or to the `tolerance`, in mean spacings, and depends on the `seed` only, unless `converge` runs
    out of time. Warns with `MeshWarning`, which tells the shortest edges, where some are left. Raises `MeshError` as
    `corners_of` does for the mesh that was found.
    """
    generator = np.random.default_rng(seed)
    allowed = max(tolerance, found.result.history.residual[-1])
    loose = max(allowed, LOOSE_TOLERANCE)
    best = _Tried(found, side_lengths(found.sea, found.result.points))
    for _ in range(ATTEMPTS):
        going = best
        for _ in range(SHAKES):
            if going.lengths.lacking > 0.0:
                going = _better(going, _shaken(going, generator), converge, loose, loose)
        if going is not best:
            best = _better(best, going.found.result.points, converge, tolerance, allowed)
    if best.lengths.lacking > 0.0:
        _warn(best.lengths)
    return best.found


@dataclass(frozen=True, eq=False)
class _Tried:
    """A mesh, and the lengths of its edges."""

    found: SeaResult
    lengths: SideLengths


def _better(best: _Tried, points: Array, converge: Converge, tolerance: float, allowed: float) -> _Tried:
    """What `points` (n, 3) converge to if that lacks less than the `best` at an `allowed` residual, else the best."""
    try:
        found = converge(points, tolerance)
        tried = _Tried(found, side_lengths(found.sea, found.result.points))
    except MeshError:  # displaced cells may end in several parts, or with two sides
        return best
    # A generator on land is refused later.
    converged = found.result.history.residual[-1] <= allowed and found.sea.coastline.contains(found.result.points).all()
    return tried if converged and tried.lengths.lacking < best.lengths.lacking else best


def _shaken(tried: _Tried, generator: np.random.Generator) -> Array:
    """The generators (n, 3), displaced at random near edges that are too short, but not onto land."""
    sea, points = tried.found.sea, tried.found.result.points
    near = _near_short_edges(sea, tried.lengths)
    size = AMPLITUDE * tried.lengths.spacings[near, None]
    moved = normalize(points[near] + size * generator.normal(size=(len(near), 3)))
    shaken = points.copy()
    shaken[near] = np.where(sea.coastline.contains(moved)[:, None], moved, points[near])
    return shaken


def _near_short_edges(sea: SeaCells, lengths: SideLengths) -> Index:
    """Cells within `SHAKEN_RINGS` of those beside an edge that is too short; an inner edge has a row for each cell."""
    triangles = sea.triangles
    marked = np.zeros(triangles.max() + 1, bool)
    marked[lengths.cells[lengths.shortfalls > 0.0]] = True
    for _ in range(SHAKEN_RINGS):
        marked[triangles[marked[triangles].any(axis=1)]] = True
    return np.flatnonzero(marked[: sea.n_cells])


def _areas(sea: SeaCells, points: Array) -> Array:
    """Areas (n,) of the clipped cells."""
    rings = sea.rings[: sea.ring_starts[-1]]
    cells = np.repeat(np.arange(sea.n_cells), np.diff(sea.ring_starts))
    places = sea.circumcenters
    parts = triangle_area(points[cells], places[rings], places[rings[following_rows(sea.ring_starts)]])
    return sum_by_index(cells, parts, sea.n_cells)


def _warn(lengths: SideLengths) -> None:
    inner, coastal = (lengths.lengths[at].min(initial=np.inf) for at in (~lengths.at_coast, lengths.at_coast))
    warnings.warn(
        f"the shortest edge has {inner:.3f} local spacings away from the coast and "
        f"{coastal:.3f} at the coast, below {INNER_EDGE} or {COASTAL_EDGE}, after {ATTEMPTS} attempts to mend the "
        f"mesh of {len(lengths.spacings)} cells; try another seed or number of cells",
        MeshWarning,
        stacklevel=3,
    )

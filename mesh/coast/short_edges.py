"""Coast meshes without short edges: shake their surroundings and converge these again.

Where four generators nearly lie on a circle, mostly beside a dislocation of the lattice, an edge has hardly any length,
and the mesh is still a local minimum of the energy: smaller displacements lead back to it. So the cells within two
rings of such an edge are displaced at random by half a spacing, and converged again, loosely, together with those of
some more rings, while all others are held. What moves about an edge is a patch; patches that do not touch are tried all
at once, in one descent on their cells and a few held ones round them, and are taken or refused one by one. So a try
costs what its patches cost, not the sea. When no edge is short, or tries are used up, cells whose residual is too large
now, mostly just outside of patches, are converged in the same way, with those near them, and at last the whole sea is,
to its tolerance. Cells far from patches hardly move, and the result is as centroidal as any other.
"""

import warnings
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mesh.arrays import Array, Index, sum_by_index
from mesh.coast.corners import COAST, Corners, corners_and_faults, corners_of, following_rows
from mesh.coast.sea_cells import SeaCells, SeaResult
from mesh.coast.start import sea_spacing
from mesh.errors import MeshError, MeshWarning
from mesh.generation.generators import DEFAULT_SEED
from mesh.geometry.sphere import arc_length, hexagon_spacing, normalize, triangle_area

INNER_EDGE, COASTAL_EDGE = 0.12, 0.32
"""Least lengths, in local spacings, of edges away from the coast, and of those along it or with an end there."""

LOOSE_TOLERANCE = 1e-4
"""Residual, in mean spacings, at which lengths of edges are known to some thousandths of a spacing."""

ATTEMPTS = 12
"""How often the whole sea is converged to its tolerance again."""

SHAKES = 12
"""How often, in an attempt, the surroundings of short edges are displaced."""

SHAKEN_RINGS = 2
"""Rings of cells, around those of a short edge, that are displaced: fewer mostly fall back to where they were."""

MOVING_RINGS = 8
"""Rings of cells, around those of a short edge, that converge again."""

HELD_RINGS = 2
"""Rings of held cells round a patch whose energy is computed: its neighbours, and theirs, which tell their sizes."""

AROUND_RINGS = 3
"""Rings of generators round those, without which their cells would not be what they are."""

ELSEWHERE = 1000
"""Generators of the rest of the sea, about, that are kept to surround the sphere."""

SETTLED_RINGS = 10
"""Rings of cells, around those whose residual is too large, that converge again after patches were mended."""

SETTLINGS = 10
"""How often, in an attempt, such cells are sought: mostly one to four times find all."""

AMPLITUDE = 0.5
"""Standard deviation of displacements in each direction, in local spacings."""

NO_PATCH = -1


@dataclass(frozen=True, eq=False)
class Part:
    """Cells of a sea that are enough to move some of them.

    `cells` (k,) are their rows in the whole, `held` (k,) marks those that stay, `fillers` (m, 3) complete the
    triangulation, and `spacing` is the mean one of the whole sea, in radians. `patches` (k,) are the patches that the
    cells move in or are the next neighbours of, `NO_PATCH` for other cells.
    """

    cells: Index
    held: NDArray[np.bool_]
    fillers: Array
    spacing: float
    patches: Index


class Descent(Protocol):
    """Converges generators at sea; tolerances and residuals are in mean spacings. All raise `MeshError`."""

    def whole(self, points: Array, tolerance: float) -> SeaResult:
        """What all generators (n, 3) converge to."""

    def part(self, points: Array, tolerance: float, part: Part) -> SeaResult:
        """What the generators (k, 3) of a part converge to."""

    def residuals(self, points: Array) -> Array:
        """Distances (n,) of all generators (n, 3) from the centroids of their cells."""


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

    def lacking_of(self, patches: Index, count: int) -> Array:
        """Sums (count,) of the shortfalls by the `patches` (n_cells,) of the cells."""
        of_sides = patches[self.cells]
        inside = of_sides != NO_PATCH
        return sum_by_index(of_sides[inside], self.shortfalls[inside], count)


def side_lengths(sea: SeaCells, points: Array) -> SideLengths:
    """The lengths of the sides of the clipped cells of generators `points` (n, 3).

    Raises `MeshError` as `corners_of` does.
    """
    return _lengths_between(corners_of(sea), sea, points)


def _lengths_between(corners: Corners, sea: SeaCells, points: Array) -> SideLengths:
    """The lengths of the sides from corner to corner; beside fillers the cell itself gives the spacing."""
    following = corners.places[following_rows(corners.starts)]
    spacings = hexagon_spacing(_areas(sea, points))
    own = spacings[corners.cells]
    between = (corners.neighbours != COAST) & (corners.neighbours < sea.n_cells)
    other = np.where(between, spacings[np.where(between, corners.neighbours, 0)], own)
    lengths = arc_length(sea.circumcenters[corners.places], sea.circumcenters[following])
    at_coast = np.maximum(corners.places, following) >= sea.n_triangles
    return SideLengths(corners.cells, lengths / (0.5 * (own + other)), at_coast, spacings)


def without_short_edges(found: SeaResult, descent: Descent, tolerance: float, seed: int = DEFAULT_SEED) -> SeaResult:
    """The converged mesh that was `found`, or one near it without short edges, or with fewer.

    It is as centroidal, or to the `tolerance`, in mean spacings, and depends on the `seed` only, unless `descent` runs
    out of time. Warns with `MeshWarning`, which tells the shortest edges, where some are left. Raises `MeshError` as
    `corners_of` does for the mesh that was found.
    """
    generator = np.random.default_rng(seed)
    allowed = max(tolerance, found.result.history.residual[-1])
    loose = max(allowed, LOOSE_TOLERANCE)
    best, lengths = found, side_lengths(found.sea, found.result.points)
    for _ in range(ATTEMPTS):
        if lengths.lacking == 0.0:
            break
        points = mended_points(best, lengths, descent, loose, generator)
        if points is None:
            continue
        try:
            tried = descent.whole(_settled(best.sea, points, descent, loose), tolerance)
            of_tried = side_lengths(tried.sea, tried.result.points)
        except MeshError:  # cells may end in several parts, or with two sides
            continue
        # A generator on land is refused later.
        sound = tried.result.history.residual[-1] <= allowed and _at_sea(tried).all()
        if sound and of_tried.lacking < lengths.lacking:
            best, lengths = tried, of_tried
    if lengths.lacking > 0.0:
        _warn(lengths)
    return best


def mended_points(
    found: SeaResult, lengths: SideLengths, descent: Descent, tolerance: float, generator: np.random.Generator
) -> Array | None:
    """Generators (n, 3) that differ from those `found` in patches about short edges, where they lack less.

    In patches they are converged to the `tolerance`, with all others held. None where no patch could be bettered.
    """
    sea, points = found.sea, found.result.points.copy()
    moving, patches = _patches_about(sea, lengths)
    lacking = lengths.lacking_of(patches, patches.max() + 1)
    bettered = np.zeros(len(lacking), bool)
    for _ in range(SHAKES):
        if not lacking.any():
            break
        open_cells = (patches != NO_PATCH) & (lacking[patches] > 0.0)
        part = _part_of(sea, points, moving & open_cells, np.where(open_cells, patches, NO_PATCH))
        try:
            tried = descent.part(_shaken(sea, points[part.cells], part, generator), tolerance, part)
        except MeshError:  # displaced generators may coincide
            continue
        left = _lacking_in(part, tried, len(lacking))
        better = (left < lacking) & (tried.result.history.residual[-1] <= tolerance)
        taken = (part.patches != NO_PATCH) & better[part.patches]
        points[part.cells[taken]] = tried.result.points[taken]
        lacking, bettered = np.where(better, left, lacking), bettered | better
    return points if bettered.any() else None


def _settled(sea: SeaCells, points: Array, descent: Descent, tolerance: float) -> Array:
    """Points (n, 3) of a sea whose residuals are, or nearly are, at most the `tolerance`, from such as have few above.

    Half of it is aimed at, so that what is held does not exceed it for what moves beside it.
    """
    for _ in range(SETTLINGS):
        residuals = descent.residuals(points)
        if residuals.max() <= tolerance:
            break
        moving = _widened(sea, residuals > tolerance, SETTLED_RINGS)
        part = _part_of(sea, points, moving, np.full(sea.n_cells, NO_PATCH))
        points = points.copy()
        points[part.cells] = descent.part(points[part.cells], 0.5 * tolerance, part).result.points
    return points


def _patches_about(sea: SeaCells, lengths: SideLengths) -> tuple[NDArray[np.bool_], Index]:
    """Which cells (n,) may move, those near a short edge, and the patch (n,) of each and of its next neighbours."""
    short = np.zeros(sea.n_cells, bool)
    short[lengths.cells[lengths.shortfalls > 0.0]] = True
    moving = _widened(sea, short, MOVING_RINGS)
    members = _widened(sea, moving, 1)
    sides = sea.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    sides = sides[(sides < sea.n_cells).all(axis=1)]
    sides = sides[members[sides].all(axis=1)]
    linked = coo_array((np.ones(len(sides), bool), (sides[:, 0], sides[:, 1])), (sea.n_cells, sea.n_cells))
    _, component = connected_components(linked, directed=False)
    patches = np.full(sea.n_cells, NO_PATCH, np.int32)
    patches[members] = np.unique(component[members], return_inverse=True)[1]
    return moving, patches


def _part_of(sea: SeaCells, points: Array, moving: NDArray[np.bool_], patches: Index) -> Part:
    """What of a sea with generators `points` (n, 3) is enough where only those `moving` (n,) move.

    That generators have moved in some patches changes next to nothing in which of them are near others.
    """
    whole = _widened(sea, moving, HELD_RINGS)
    near = _widened(sea, whole, AROUND_RINGS)
    elsewhere = points[~near]
    some = elsewhere[:: max(1, len(elsewhere) // ELSEWHERE)]
    cells = np.flatnonzero(whole)
    fillers = np.concatenate([points[near & ~whole], some, sea.fillers])
    return Part(cells, ~moving[cells], fillers, sea_spacing(sea.coastline, sea.n_cells), patches[cells])


def _widened(sea: SeaCells, marked: NDArray[np.bool_], rings: int) -> NDArray[np.bool_]:
    """The `marked` cells (n,) and those within so many rings of them; land with fillers is not crossed."""
    wide = np.zeros(sea.triangles.max() + 1, bool)
    wide[: sea.n_cells] = marked
    for _ in range(rings):
        wide[sea.triangles[wide[sea.triangles].any(axis=1)]] = True
        wide[sea.n_cells :] = False
    return wide[: sea.n_cells]


def _shaken(sea: SeaCells, points: Array, part: Part, generator: np.random.Generator) -> Array:
    """The generators (k, 3) of a part, displaced at random near edges that are too short, but not onto land."""
    cells = SeaCells(points, sea.coastline, part.fillers)
    lengths = _lengths_between(corners_and_faults(cells)[0], cells, points)
    short = np.zeros(len(points), bool)
    short[lengths.cells[lengths.shortfalls > 0.0]] = True
    short &= part.patches != NO_PATCH
    near = np.flatnonzero(_widened(cells, short, SHAKEN_RINGS) & ~part.held)
    size = AMPLITUDE * lengths.spacings[near, None]
    moved = normalize(points[near] + size * generator.normal(size=(len(near), 3)))
    shaken = points.copy()
    shaken[near] = np.where(sea.coastline.contains(moved)[:, None], moved, points[near])
    return shaken


def _lacking_in(part: Part, tried: SeaResult, count: int) -> Array:
    """What each of `count` patches lacks in a part that was tried; infinite where it is no mesh at all."""
    corners, faulty = corners_and_faults(tried.sea)
    lacking = _lengths_between(corners, tried.sea, tried.result.points).lacking_of(part.patches, count)
    wrong = part.patches[(faulty | ~_at_sea(tried)) & (part.patches != NO_PATCH)]
    lacking[wrong] = np.inf
    return lacking


def _at_sea(found: SeaResult) -> NDArray[np.bool_]:
    """Which generators (n,) are at sea."""
    return found.sea.coastline.contains(found.result.points)


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

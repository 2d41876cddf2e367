"""Points spread over a part of the sphere as a density asks, without chance in how many stand where.

Patches of the sphere (`mesh.geometry.cube`) are cut in four, again and again, where they would hold more than a share
of a point. Points are then dealt out along a space-filling curve through the squares, one whenever enough has been
passed. Their number in any area is right but for its rim, so that a descent has nothing to carry over long ways, as it
has from points drawn at random.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.density.named import Density, density_at
from mesh.errors import MeshError
from mesh.geometry.cube import points_in_patches
from mesh.geometry.sphere import normalize
from mesh.triangulation.ordering import hilbert_order

LARGEST_SHARE = 0.25
"""Of a point, that a square may hold, about: larger squares would show in where points stand."""

FIRST_SQUARES = 4.0
"""Squares on the whole sphere per point before any is cut: peaks of the density narrower than them may be missed."""

MOST_CUTS = 10

ZERO_DENSITY = (
    "the density is zero wherever it was tried at sea; give one that is positive there, or a floor above zero"
)

JITTER = 0.25
"""In squares, how far points stand from the centres of theirs: on a lattice, four would lie on a circle."""


@dataclass(frozen=True, eq=False)
class _Squares:
    """Squares (n,) of the cube's faces: centres (n, 3), masses (n,), least distances (n,) from the border, widths."""

    patches: Index
    centers: Array
    masses: Array
    distance: Array
    resolution: int

    @property
    def width(self) -> float:
        """Radians, in the middle of a face, where it is longest."""
        return 2.0 / self.resolution

    def chosen(self, which: NDArray[np.bool_]) -> "_Squares":
        return _Squares(
            self.patches[which], self.centers[which], self.masses[which], self.distance[which], self.resolution
        )


def spread_points(count: int, density: Density, distance: Callable[[Array], Array], seed: int) -> Array:
    """Points (count, 3), about as dense as `density`, where the `distance` from the border of a part is positive.

    The distance of unit vectors (n, 3) is in radians or a chord, negative outside. `seed` moves points within their
    squares. Raises `MeshError` where the density is negative or not finite, or zero all over, or no square is inside.
    """
    resolution = math.ceil(math.sqrt(FIRST_SQUARES * count / 6.0))
    patches = np.arange(6 * resolution**2)
    squares = _squares(patches, resolution, density, distance, np.zeros(len(patches)))
    done: list[_Squares] = []
    passed = 0.0
    for cut in range(MOST_CUTS + 1):
        enough = LARGEST_SHARE / count * (passed + squares.masses.sum())
        large = (squares.masses > enough) & (cut < MOST_CUTS)
        done.append(squares.chosen(~large))
        passed += float(done[-1].masses.sum())
        if not large.any():
            break
        squares = _quarters(squares.chosen(large), density, distance)
    return _dealt(count, done, distance, np.random.default_rng(seed))


def _squares(
    patches: Index, resolution: int, density: Density, distance: Callable[[Array], Array], known: Array
) -> _Squares:
    """Those of the patches (n,) that may be inside; where distances are `known` (n,), not zero, they are taken."""
    centers = points_in_patches(patches, resolution, np.array([0.5]))[:, 0, 0]
    away = known.copy()
    near = known == 0.0
    away[near] = distance(centers[near])
    inside = away > -2.0 / resolution
    centers = centers[inside]
    # A square of the face's plane, seen from the centre of the sphere.
    masses = density_at(density, centers) * (2.0 / resolution) ** 2 * np.abs(centers).max(axis=1) ** 3
    return _Squares(patches[inside], centers, masses, away[inside], resolution)


def _quarters(squares: _Squares, density: Density, distance: Callable[[Array], Array]) -> _Squares:
    """The four squares of half the width in each."""
    face, square = np.divmod(squares.patches, squares.resolution**2)
    row, column = np.divmod(square, squares.resolution)
    resolution = 2 * squares.resolution
    patches = [
        (face * resolution + 2 * row + up) * resolution + 2 * column + right for up in (0, 1) for right in (0, 1)
    ]
    away = np.abs(squares.distance)
    known = np.where(away > squares.width, np.sign(squares.distance) * (away - 0.5 * squares.width), 0.0)
    return _squares(np.concatenate(patches), resolution, density, distance, np.tile(known, 4))


def _dealt(
    count: int, done: list[_Squares], distance: Callable[[Array], Array], generator: np.random.Generator
) -> Array:
    """Points (count, 3) in squares inside, at equal steps of the mass along a curve through them."""
    inside = [squares.chosen(squares.distance > 0.0) for squares in done]
    centers = np.concatenate([squares.centers for squares in inside])
    if len(centers) == 0:
        raise MeshError("no place was found where points could be spread; take a larger part, or more points")
    width = np.repeat([squares.width for squares in inside], [len(squares.patches) for squares in inside])
    order = hilbert_order(centers)
    ends = np.cumsum(np.concatenate([squares.masses for squares in inside])[order])
    if not ends[-1] > 0.0:
        raise MeshError(ZERO_DENSITY)
    chosen = order[np.searchsorted(ends, (np.arange(count) + 0.5) * (ends[-1] / count))]
    shift = generator.uniform(-JITTER, JITTER, (count, 3)) * width[chosen, None]
    points = normalize(centers[chosen] + shift)
    outside = distance(points) <= 0.0
    points[outside] = centers[chosen[outside]]
    return points

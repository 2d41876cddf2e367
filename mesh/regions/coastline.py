"""The coastline of a sea, as smooth as the cells of a mesh can follow it.

Two discs of half a spacing's radius roll along the coast. The one on land must fit everywhere, so spits and islands
narrower than the spacing go; then that at sea, so channels and inlets narrower than the spacing go. Land left between
two waters that nearly meet opens where it is thinner than half a spacing.
"""

from collections.abc import Callable

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.geometry.sphere import arc_length, normalize
from mesh.regions.level_set import LevelSet, level_set
from mesh.regions.outline import Outline, signed

Function = Callable[[Array], Array]

SHIFTS = (-0.5, 1.0, -0.75, 0.25)
"""In spacings, where each next line of equal distance runs, positive at sea, as seen from the one before.

The first step grows the sea by half a spacing; the second takes that back and as much again; the third grows it by half
a spacing and a quarter more; the last takes back the quarter.
"""

FINENESS = 0.125
"""In spacings, the longest side of the triangles on which lines are found."""

STEP = 0.25
"""In spacings, the distance between vertices of a ring."""

ROUNDING = 0.25
"""In spacings, the standard deviation of the Gaussian that smooths rings along themselves."""

PLACES = 4
"""Places between two vertices of a ring, at which it is sampled to be smoothed."""

SHORTEST, LONGEST = 1e-5, 0.25
"""Radians: spacings for which a coastline is made, of some 60 m and of 1600 km on the Earth."""


def smooth_coastline(distance: Function, spacing: float, all_seas: bool, name: str) -> list[Array]:
    """Closed rings (m, 3) of unit vectors, the sea to their left, of the coast where `distance` (n,) is zero.

    No channel, island, spit or inlet is much narrower than the `spacing`, radians; vertices stand about a quarter of it
    apart. Only rings of the largest connected sea are given, the longest first, unless `all_seas`; none where there is
    no land. The distance of unit vectors (n, 3) to the coast is positive at sea. Raises `MeshError` where no sea is
    left, or the spacing is out of range.
    """
    if not SHORTEST <= spacing <= LONGEST:
        raise MeshError(f"{name}: a spacing of {spacing:g} radians; ask for one between {SHORTEST:g} and {LONGEST:g}")
    for shift in SHIFTS[:-1]:
        distance = _distance_to_line(distance, shift * spacing, FINENESS * spacing)
    coast = level_set(lambda points: distance(points) - SHIFTS[-1] * spacing, FINENESS * spacing)
    if coast.largest_sea is None:
        raise MeshError(
            f"{name}: no sea is as wide as the spacing of {np.degrees(spacing):.3g} degrees; take another region, "
            "or more cells"
        )
    rings = [coast.vertices[ring] for ring in coast.rings() if all_seas or coast.sea[ring[0]] == coast.largest_sea]
    smooth = [_evenly_spaced(ring, spacing) for ring in rings]
    return sorted(smooth, key=len, reverse=True)


def _distance_to_line(distance: Function, level: float, fineness: float) -> Function:
    """The distance, of the same sign as `distance - level`, to the line where that is zero."""
    line: LevelSet = level_set(lambda points: distance(points) - level, fineness)
    outline = Outline(line.vertices, line.vertices[line.following])
    return lambda points: signed(outline.distance(points), distance(points) > level)


def _evenly_spaced(ring: Array, spacing: float) -> Array:
    """The ring (n, 3), smoothed along itself, with vertices about `STEP` spacings apart."""
    closed = np.concatenate([ring, ring[:1]])
    way = np.concatenate([[0.0], np.cumsum(arc_length(closed[:-1], closed[1:]))])
    count = max(6, round(way[-1] / (STEP * spacing)))
    places = np.arange(PLACES * count) * (way[-1] / (PLACES * count))
    even = np.stack([np.interp(places, way, axis) for axis in closed.T], axis=1)
    waves = 2.0 * np.pi * np.fft.rfftfreq(len(even), way[-1] / len(even))
    damping = np.exp(-0.5 * (ROUNDING * spacing * waves) ** 2)[:, None]
    return normalize(np.fft.irfft(damping * np.fft.rfft(even, axis=0), len(even), axis=0)[::PLACES])

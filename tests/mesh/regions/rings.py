"""What the tests of coastlines measure on rings of unit vectors."""

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, dot, normalize, triangle_area


def area_within(rings: list[Array]) -> float:
    """Steradians to the left of all rings; each must be smaller than a hemisphere."""
    total = 0.0
    for ring in rings:
        middle = np.broadcast_to(normalize(ring.mean(axis=0)), ring.shape)
        total += float(triangle_area(middle, ring, np.roll(ring, -1, axis=0)).sum())
    return total


def sides(rings: list[Array]) -> tuple[Array, Array]:
    """Starts and ends of all sides (n, 3)."""
    return np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])


def crossings(rings: list[Array]) -> int:
    """How many pairs of sides, without a common end, cross each other."""
    starts, ends = sides(rings)
    reach = float(np.linalg.norm(ends - starts, axis=1).max())
    first, second = cKDTree(normalize(starts + ends)).query_pairs(1.01 * reach, output_type="ndarray").T

    def apart(one: Array, other: Array) -> Array:
        normal = np.cross(starts[one], ends[one])
        return dot(normal, starts[other]) * dot(normal, ends[other]) < 0.0

    joined = (starts[first] == ends[second]).all(axis=1) | (ends[first] == starts[second]).all(axis=1)
    return int(np.count_nonzero(apart(first, second) & apart(second, first) & ~joined))


def steps(rings: list[Array]) -> Array:
    """Lengths of all sides, radians."""
    return arc_length(*sides(rings))


def left_of(rings: list[Array], step: float) -> Array:
    """Points (n, 3) beside the middles of all sides, a `step` in radians to the left."""
    starts, ends = sides(rings)
    return normalize(normalize(starts + ends) + step * normalize(np.cross(starts, ends)))

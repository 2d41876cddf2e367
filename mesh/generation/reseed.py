"""Converged meshes without bad triangles: shake their surroundings and converge again.

A variable-resolution SCVT is one of very many local minima, and its least quality is a matter of luck. The cells near
triangles below a wanted quality are displaced at random and the mesh is converged again, until no such triangle is
left; a mesh further from the wanted quality than the one before is discarded. The result is as centroidal as any other.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, sum_by_index
from mesh.generation.optimizer import ScvtResult
from mesh.geometry.sphere import dot, normalize
from mesh.triangulation.triangle_quality import near_bad_triangles, qualities

SHAKEN_RINGS = 2
AMPLITUDE = 0.35
"""Size of a random displacement, in lengths of the neighbouring sides."""


def reseed(
    result: ScvtResult,
    converge: Callable[[Array], ScvtResult],
    wanted: float,
    tries: int,
    seed: int,
    fixed: NDArray[np.bool_],
) -> ScvtResult:
    """Return the best mesh in at most `tries` tries, starting from a converged one; `fixed` generators stay.

    No try follows one for which `converge` had too little time.
    """
    generator = np.random.default_rng(seed)
    lacking = _shortfall(result, wanted)
    for _ in range(tries):
        if lacking == 0.0:
            break
        near = near_bad_triangles(result.points, result.triangles, wanted, SHAKEN_RINGS) & ~fixed
        other = converge(_shaken(result.points, result.triangles, near, generator))
        if other.reason == "seconds":
            break
        if other.reason == result.reason and _shortfall(other, wanted) < lacking:
            result, lacking = other, _shortfall(other, wanted)
    return result


def _shortfall(result: ScvtResult, wanted: float) -> float:
    """Sum over triangles of how far their quality falls short."""
    return float(np.maximum(0.0, wanted - qualities(result.points, result.triangles)).sum())


def _shaken(points: Array, triangles: Index, near: NDArray[np.bool_], generator: np.random.Generator) -> Array:
    """Points (n, 3), with those in the mask `near` displaced at random."""
    moved = points.copy()
    amplitude = AMPLITUDE * _side_lengths(points, triangles)[near, None]
    moved[near] = normalize(points[near] + amplitude * generator.normal(size=(np.count_nonzero(near), 3)))
    return moved


def _side_lengths(points: Array, triangles: Index) -> Array:
    """Mean length (n,) of the sides that start at each point."""
    sides = points[np.roll(triangles, -1, axis=1)] - points[triangles]
    return sum_by_index(triangles, np.sqrt(dot(sides, sides)), len(points)) / np.bincount(triangles.ravel())

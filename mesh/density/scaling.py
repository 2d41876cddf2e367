"""Densities of any scale, multiplied by a factor so that products of their values neither underflow nor overflow."""

import math

import numpy as np

from mesh.density.named import Density, density_at
from mesh.errors import MeshError
from mesh.geometry.sphere import fibonacci_points

PROBES = 20_000
"""Points at which the largest value of a density is sought."""

SAFE_EXPONENT = 200
"""Densities whose largest value lies within this power of two of one can be squared and summed as they are."""


def within_range(density: Density) -> Density:
    """The density itself or, where its values are so large or small that products of them are lost, a multiple of it.

    Only ratios of a density matter. The factor is a power of four, which changes no digit, nor of roots. Raises
    `MeshError` where the density is negative, not finite, or zero everywhere.
    """
    exponent = 2 * (math.frexp(largest_value(density))[1] // 2)
    if abs(exponent) <= SAFE_EXPONENT:
        return density
    return lambda points: np.ldexp(density_at(density, points), -exponent)


def largest_value(density: Density) -> float:
    """The largest value of `density` at points everywhere on the sphere."""
    largest = float(density_at(density, fibonacci_points(PROBES)).max())
    if not largest > 0.0:
        raise MeshError("the density is zero everywhere it was tried; give one that is positive")
    return largest

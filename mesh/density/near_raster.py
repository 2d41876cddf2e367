"""A function that vanishes but near some places, such as a coast, sampled once and then looked up.

The patches of the sphere (`mesh.geometry.cube`) that are near a place are cut into squares, at whose corners the
function is sampled; between them it is interpolated bilinearly. All other patches cost one number each. Patches that
meet share the samples on their common side, so that the result is continuous.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index, by_blocks, row_loop
from mesh.geometry.cube import patch_centers, place_in_patch, points_in_patches

SQUARES = 16
"""Squares along the side of a patch."""

MOST_PATCHES = 1024
"""Along the side of a face: squares are never smaller than some 800 m on the Earth, however fine the asked step."""


class NearRaster:
    """Looks up samples of a function that is zero farther from all places than a reach.

    `block` (patches,) is the number of the block of samples of a patch, -1 where the function is zero, and `samples`
    (blocks, SQUARES + 1, SQUARES + 1) holds these.
    """

    def __init__(self, function: Callable[[Array], Array], places: Array, reach: float, step: float) -> None:
        """Sample `function` of unit vectors (m, 3) within the chord `reach` of `places` (n, 3), at most `step` apart.

        Lengths are in radians; the step is that in the middle of a face of the cube, where it is longest.
        """
        self.resolution = min(math.ceil(2.0 / (SQUARES * step)), MOST_PATCHES)
        diagonal = math.sqrt(2.0) * 2.0 / self.resolution
        away = cKDTree(places).query(patch_centers(self.resolution), distance_upper_bound=reach + diagonal)[0]
        near = np.flatnonzero(np.isfinite(away))
        self.block: Index = np.full(len(away), -1, np.int32)
        self.block[near] = np.arange(len(near))
        corners = points_in_patches(near, self.resolution, np.linspace(0.0, 1.0, SQUARES + 1))
        self.samples = function(corners.reshape(-1, 3)).reshape(corners.shape[:-1])

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        return by_blocks(
            lambda rows: _look_up(rows, self.resolution, self.block, self.samples), np.ascontiguousarray(points)
        )


@row_loop
def _look_up(points: Array, resolution: int, block: Index, samples: Array) -> Array:
    """Bilinear interpolation (m,) at unit vectors (m, 3) of the samples of `NearRaster`."""
    result = np.zeros(len(points))
    for point in range(len(points)):
        patch, across, up = place_in_patch(points[point, 0], points[point, 1], points[point, 2], resolution)
        if block[patch] >= 0:
            values = samples[block[patch]]
            column, row = min(int(SQUARES * across), SQUARES - 1), min(int(SQUARES * up), SQUARES - 1)
            across, up = SQUARES * across - column, SQUARES * up - row
            low = values[row, column] + across * (values[row, column + 1] - values[row, column])
            high = values[row + 1, column] + across * (values[row + 1, column + 1] - values[row + 1, column])
            result[point] = low + up * (high - low)
    return result

"""Where a density is constant, found by sampling it once: cells there need no quadrature.

The sphere is cut into patches (`mesh.geometry.cube`), each sampled at its corners, the middles of its sides and its
centre. Neighbours share samples, so that a jump between two patches shows in one of them. A patch whose samples differ
is varied; a patch whose samples are the same to the last digit is part of a plateau. What is narrower than half a patch
may be missed, but with as many patches as here it is narrower than the cells.
"""

import math

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density.named import Density, density_at
from mesh.geometry.cube import patch_centers, points_on_faces

PATCHES_PER_CELL = 4.0
"""Patches per cell of the mesh, about; each takes four samples, so all take less than half of one quadrature."""

FEWEST_CELLS = 2500
"""Meshes of fewer cells do without: exact integrals and quadrature differ there by more than round-off."""

FURTHEST = 32.0
"""Patches within which the nearest varied one is sought: that is wider than any cell, and quick."""


class Plateaus:
    """Values of a density on its plateaus, and how far these extend.

    `values` (patches,) are those at the centres of patches. All within the chord `reaches` (patches,) of any point of
    a patch has the patch's value; it is zero or less where the density varies.
    """

    def __init__(self, density: Density, resolution: int) -> None:
        """Sample `density` for patches of `resolution` to a side of the cube's faces."""
        lines = 2 * resolution + 1
        samples = density_at(density, points_on_faces(np.linspace(-1.0, 1.0, lines))).reshape(6, lines, lines)
        self.resolution = resolution
        self.values = np.ascontiguousarray(samples[:, 1::2, 1::2]).ravel()
        varied = (_of_three(samples, np.minimum) != _of_three(samples, np.maximum)).ravel()
        centers = patch_centers(resolution)
        self.reaches = np.zeros(len(centers))
        if varied.all():
            return
        width = 2.0 / resolution  # of patches in the middle of a face, the largest
        nearest = np.full(np.count_nonzero(~varied), FURTHEST * width)
        if varied.any():
            found = cKDTree(centers[varied]).query(centers[~varied], distance_upper_bound=FURTHEST * width)[0]
            nearest = np.minimum(nearest, found)
        # Half a diagonal of the patch itself and half a one of the varied patch.
        self.reaches[~varied] = nearest - math.sqrt(2.0) * width

    @property
    def any(self) -> bool:
        """Whether the density has any plateau."""
        return bool((self.reaches > 0.0).any())


def plateaus_of(density: Density, n_cells: int) -> Plateaus | None:
    """The plateaus of a density for a mesh of so many cells; None where there are none, or too few cells.

    Raises `MeshError` where the density is negative or not finite.
    """
    if n_cells < FEWEST_CELLS:
        return None
    plateaus = Plateaus(density, math.ceil(math.sqrt(PATCHES_PER_CELL * n_cells / 6.0)))
    return plateaus if plateaus.any else None


def _of_three(samples: Array, extreme: np.ufunc) -> Array:
    """The `extreme` (6, k, k) of the three by three samples of each patch, from those of all lines (6, 2k+1, 2k+1)."""
    rows = extreme(extreme(samples[:, :-2:2], samples[:, 1:-1:2]), samples[:, 2::2])
    result: Array = extreme(extreme(rows[:, :, :-2:2], rows[:, :, 1:-1:2]), rows[:, :, 2::2])
    return result

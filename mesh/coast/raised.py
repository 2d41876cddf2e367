"""A density that rises towards the coast, so that cells get smaller there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density.named import Density, density_at
from mesh.density.near_raster import NearRaster
from mesh.density.record import name_of
from mesh.errors import MeshError

REACH = 4.0
"""In widths, the distance from the coast beyond which the density is not raised: by 1e-7 of the factor there."""

STEP = 0.125
"""In widths, between samples of how the density rises: within 0.4 percent of the factor, so 0.1 percent of spacings."""


@dataclass(frozen=True, eq=False)
class RaisedDensity:
    """`density` times 1 + (`factor` - 1) exp(-(d / `width`)^2), with d the distance to the `coast`.

    `width` is in radians, `coast` (n, 3) are points of the coast, much closer together than that. Spacings at the coast
    become factor^(-1/4) of what they would be. How far the coast is takes a search among its points, which is done once
    on a raster and looked up from then on; widths below some 6 km on the Earth are finer than that raster. Raises
    `MeshError` unless the width is positive and the factor is 1 at least.
    """

    density: Density
    coast: Array
    width: float
    factor: float

    def __post_init__(self) -> None:
        if not 0.0 < self.width < np.inf:
            raise MeshError(f"the density cannot be raised over {self.width:g} radians; give a positive width")
        if not 1.0 <= self.factor < np.inf:
            raise MeshError(f"the density cannot be raised {self.factor:g} times at the coast; give 1 or more")

    @cached_property
    def _nearness(self) -> NearRaster:
        """What is 1 at the coast and falls to 0."""
        tree, width = cKDTree(self.coast), self.width

        def bell(points: Array) -> Array:
            away = tree.query(points, workers=-1, distance_upper_bound=REACH * width)[0] / width
            return np.exp(-(away**2))

        return NearRaster(bell, self.coast, REACH * width, STEP * width)

    @property
    def __name__(self) -> str:
        return f"{name_of(self.density)} raised {self.factor:g} times at the coast"

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        return density_at(self.density, points) * (1.0 + (self.factor - 1.0) * self._nearness(points))

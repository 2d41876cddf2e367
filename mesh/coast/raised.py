"""A density that rises towards the coast, so that cells get smaller there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density.named import Density, density_at
from mesh.density.record import name_of
from mesh.errors import MeshError


@dataclass(frozen=True, eq=False)
class RaisedDensity:
    """`density` times 1 + (`factor` - 1) exp(-(d / `width`)^2), with d the distance to the `coast`.

    `width` is in radians, `coast` (n, 3) are points of the coast, much closer together than that. Spacings at the coast
    become factor^(-1/4) of what they would be. Raises `MeshError` unless the width is positive and the factor is 1 at
    least.
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
    def _tree(self) -> cKDTree:
        return cKDTree(self.coast)

    @property
    def __name__(self) -> str:
        return f"{name_of(self.density)} raised {self.factor:g} times at the coast"

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        away = self._tree.query(points, workers=-1)[0] / self.width
        return density_at(self.density, points) * (1.0 + (self.factor - 1.0) * np.exp(-(away**2)))

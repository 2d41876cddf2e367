"""A density that rises towards the coast, so that cells get smaller there."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.density.named import Density, density_at
from mesh.density.record import name_of
from mesh.errors import MeshError
from mesh.regions.region import Region


@dataclass(frozen=True, eq=False)
class RaisedDensity:
    """`density` times 1 + (`factor` - 1) exp(-(d / `width`)^2), with d the distance to the coast of a `region`.

    `width` is in radians. Spacings at the coast become factor^(-1/4) of what they would be; on land d counts as zero.
    Raises `MeshError` unless the width is positive and the factor is 1 at least.
    """

    density: Density
    region: Region
    width: float
    factor: float

    def __post_init__(self) -> None:
        if not 0.0 < self.width < np.inf:
            raise MeshError(f"the density cannot be raised over {self.width:g} radians; give a positive width")
        if not 1.0 <= self.factor < np.inf:
            raise MeshError(f"the density cannot be raised {self.factor:g} times at the coast; give 1 or more")

    @property
    def __name__(self) -> str:
        return f"{name_of(self.density)} raised {self.factor:g} times at the coast of {self.region.name}"

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        away = np.maximum(self.region.distance(points), 0.0) / self.width
        return density_at(self.density, points) * (1.0 + (self.factor - 1.0) * np.exp(-(away**2)))

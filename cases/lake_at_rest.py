"""A lake at rest, after Bermudez and Vazquez (1994), Computers & Fluids 23, 1049-1071.

Their C-property: over any topography, fluid at rest with a level surface must stay at rest.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.williamson import ConicalMountain
from mesh.arrays import Array


@dataclass(frozen=True)
class LakeAtRest(ConicalMountain):
    """Fluid at rest with a level surface over the mountain of Williamson's test case 5; it stays so.

    Any motion is round-off, so that there is no order of convergence.
    """

    name: ClassVar[str] = "lake-at-rest"
    title: ClassVar[str] = "Lake at rest over an isolated mountain"
    reference: ClassVar[str] = (
        "Bermudez and Vazquez (1994), Computers & Fluids 23, 1049-1071, https://doi.org/10.1016/0045-7930(94)90004-3"
    )
    recommended_days: ClassVar[float] = 5.0

    surface_height: float = parameter(5960.0, "m", "Height of the surface")

    @property
    def has_exact_solution(self) -> bool:
        """Yes: nothing moves."""
        return True

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """From the bottom to the level surface."""
        return self.surface_height - self.topography(longitude, latitude)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Zero."""
        return np.zeros(longitude.shape)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Zero."""
        return np.zeros(longitude.shape), np.zeros(longitude.shape)

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Zero."""
        return np.zeros(longitude.shape)

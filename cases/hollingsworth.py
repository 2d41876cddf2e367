"""The test for Hollingsworth instability in one layer, of Bell, Peixoto and Thuburn (2017) and of the same in 2018.

Hollingsworth et al. (1983), Q. J. R. Meteorol. Soc. 109, 417-428, found that models in vector-invariant form are
unstable where the discrete gradient of kinetic energy and Coriolis force do not cancel as advection of momentum wants
it. What is left over matters most for internal modes, which are layers of small equivalent depth.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.williamson import BalancedRotation
from mesh.arrays import Array


@dataclass(frozen=True)
class Hollingsworth(BalancedRotation):
    """Balanced zonal flow in a thin layer of uniform depth, as the bottom has the slope that balance asks for.

    Wind and Coriolis parameter are those of Williamson's test case 2, and so is the surface but for a constant. The
    flow is an exact steady state, and stable, as it is at rest for an observer who turns with it: where a departure
    grows, the scheme makes it grow.
    """

    name: ClassVar[str] = "hollingsworth"
    title: ClassVar[str] = "Hollingsworth instability: balanced flow in a thin layer"
    reference: ClassVar[str] = (
        "Peixoto et al. (2018), Q. J. R. Meteorol. Soc. 144, 156-171, https://doi.org/10.1002/qj.3191; "
        "Bell et al. (2017), Q. J. R. Meteorol. Soc. 143, 563-581, https://doi.org/10.1002/qj.2950"
    )
    recommended_days: ClassVar[float] = 20.0

    depth: float = parameter(50.0, "m", "Depth of the layer, everywhere")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth")

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Uniform."""
        return np.full(longitude.shape, self.depth)

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Highest at the equator of the rotation, zero at its poles."""
        return self._drop_to_the_poles() * (1.0 - self._sine_of_turned_latitude(longitude, latitude) ** 2)

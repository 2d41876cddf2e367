"""Test cases 2 and 5 of Williamson, Drake, Hack, Jakob and Swarztrauber (1992), J. Comput. Phys. 102, 211-224."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import Case
from mesh.arrays import Array
from swe.constants import EARTH_RADIUS, GRAVITY, SECONDS_PER_DAY

REFERENCE = "Williamson et al. (1992), J. Comput. Phys. 102, 211-224, https://doi.org/10.1016/S0021-9991(05)80016-6"


@dataclass(frozen=True)
class Williamson2(Case):
    """Global steady-state nonlinear zonal geostrophic flow (test case 2), which is its own exact solution.

    Solid-body rotation about an axis turned by `angle` from the pole, with a Coriolis parameter turned alike, so
    that the pressure gradient balances it: equations (90) to (96) of the paper.
    """

    name: ClassVar[str] = "williamson2"
    title: ClassVar[str] = "Williamson test case 2: steady geostrophic flow"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 5.0
    has_exact_solution: ClassVar[bool] = True

    wind_speed: float = 2.0 * np.pi * EARTH_RADIUS / (12.0 * SECONDS_PER_DAY)
    """Speed u0 at the equator of the rotation, m/s."""

    reference_depth: float = 2.94e4 / GRAVITY
    """Depth h0 at the equator of the rotation, m."""

    angle: float = 0.0
    """Angle alpha between the axis of the flow and the polar axis, rad."""

    def _sine_of_turned_latitude(self, longitude: Array, latitude: Array) -> Array:
        return np.sin(latitude) * np.cos(self.angle) - np.cos(longitude) * np.cos(latitude) * np.sin(self.angle)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (95)."""
        drop = self.radius * self.rotation_rate * self.wind_speed + 0.5 * self.wind_speed**2
        return self.reference_depth - drop / self.gravity * self._sine_of_turned_latitude(longitude, latitude) ** 2

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (92)."""
        return -self.radius * self.wind_speed * self._sine_of_turned_latitude(longitude, latitude)

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """Equation (96)."""
        return 2.0 * self.rotation_rate * self._sine_of_turned_latitude(longitude, latitude)


@dataclass(frozen=True)
class Williamson5(Case):
    """Zonal flow over an isolated mountain (test case 5), without a known solution.

    The flow of test case 2 with angle 0, slower and deeper, meets a conical mountain at mid-latitude: section 3.5
    of the paper, equation (134).
    """

    name: ClassVar[str] = "williamson5"
    title: ClassVar[str] = "Williamson test case 5: flow over an isolated mountain"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 15.0

    wind_speed: float = 20.0
    """Speed u0 at the equator, m/s."""

    reference_depth: float = 5960.0
    """Height h0 of the free surface at the equator, m."""

    mountain_height: float = 2000.0
    """Height h_s0 of the mountain's peak, m."""

    mountain_radius: float = np.pi / 9.0
    """Distance R, in longitude and latitude, from the peak to the foot, rad."""

    mountain_longitude: float = 1.5 * np.pi
    """Longitude of the peak, rad, in [0, 2 pi)."""

    mountain_latitude: float = np.pi / 6.0
    """Latitude of the peak, rad."""

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Equation (134): a cone in the plane of longitude and latitude."""
        from_peak = (longitude - self.mountain_longitude + np.pi) % (2.0 * np.pi) - np.pi
        distance = np.minimum(self.mountain_radius, np.hypot(from_peak, latitude - self.mountain_latitude))
        return self.mountain_height * (1.0 - distance / self.mountain_radius)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (95) less the topography."""
        drop = self.radius * self.rotation_rate * self.wind_speed + 0.5 * self.wind_speed**2
        surface = self.reference_depth - drop / self.gravity * np.sin(latitude) ** 2
        return surface - self.topography(longitude, latitude)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (92) with angle 0."""
        return -self.radius * self.wind_speed * np.sin(latitude) + 0.0 * longitude

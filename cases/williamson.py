"""Test cases of Williamson, Drake, Hack, Jakob and Swarztrauber (1992), J. Comput. Phys. 102, 211-224: 1, 2, 5 and 6.

Equation numbers are those of the paper, where latitude is theta and longitude lambda.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import Case, parameter
from mesh.arrays import Array
from mesh.geometry.angles import about_zero
from mesh.geometry.sphere import arc_length, from_lonlat
from swe.constants import EARTH_RADIUS, GRAVITY, SECONDS_PER_DAY
from swe.errors import InputError

REFERENCE = "Williamson et al. (1992), J. Comput. Phys. 102, 211-224, https://doi.org/10.1016/S0021-9991(05)80016-6"

LARGEST_WAVE_NUMBER = 200
"""No mesh that fits a machine resolves more waves round the sphere, and their powers of cosines vanish."""


@dataclass(frozen=True)
class SolidRotation(Case):
    """Wind of solid-body rotation about an axis turned by `angle` from the pole towards longitude 180 degrees.

    The paper runs its test cases 1 and 2 with the angles 0, 0.05, pi/2 - 0.05 and pi/2.
    """

    wind_speed: float = parameter(
        2.0 * np.pi * EARTH_RADIUS / (12.0 * SECONDS_PER_DAY),
        "m/s",
        "Speed u0 at the equator of the rotation; once round the Earth in 12 days",
    )
    angle: float = parameter(0.0, "rad", "Angle alpha between the axis of the flow and the polar axis")

    @property
    def axis(self) -> Array:
        """Unit vector (3,) of the axis of the flow."""
        return np.array([-np.sin(self.angle), 0.0, np.cos(self.angle)])

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_angles("angle")

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (92)."""
        return -self.radius * self.wind_speed * self._sine_of_turned_latitude(longitude, latitude)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Equations (75) and (76) of test case 1, (90) and (91) of test case 2."""
        sine, cosine = np.sin(self.angle), np.cos(self.angle)
        zonal = self.wind_speed * (np.cos(latitude) * cosine + np.sin(latitude) * np.cos(longitude) * sine)
        return zonal, -self.wind_speed * np.sin(longitude) * sine

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Twice the angular velocity of the rotation along the vertical."""
        return 2.0 * self.wind_speed / self.radius * self._sine_of_turned_latitude(longitude, latitude)

    def _sine_of_turned_latitude(self, longitude: Array, latitude: Array) -> Array:
        return np.sin(latitude) * np.cos(self.angle) - np.cos(longitude) * np.cos(latitude) * np.sin(self.angle)


@dataclass(frozen=True)
class Williamson1(SolidRotation):
    """Advection of a cosine bell once round the sphere (test case 1), with a known solution.

    The wind is prescribed and only thickness moves: section 3.1 of the paper. A constant
    `background_depth` is added to the bell, for the centred flux of the scheme undershoots and the diagnostics divide
    by thickness. Since advection is linear and the discrete wind has no divergence, the bell moves as it would
    without; the error norms of the paper are those of thickness less the background.
    """

    name: ClassVar[str] = "williamson1"
    title: ClassVar[str] = "Williamson test case 1: advection of a cosine bell"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 12.0
    convergence_order: ClassVar[float | None] = 1.5
    prescribed_wind: ClassVar[bool] = True

    bell_height: float = parameter(1000.0, "m", "Height h0 of the bell")
    bell_radius: float = parameter(1.0 / 3.0, "rad", "Distance R from the centre of the bell to its foot")
    bell_longitude: float = parameter(1.5 * np.pi, "rad", "Longitude of the centre at the start")
    bell_latitude: float = parameter(0.0, "rad", "Latitude of the centre at the start")
    background_depth: float = parameter(1000.0, "m", "Thickness outside of the bell")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("bell_radius")
        self.require_angles("bell_longitude", "bell_latitude")

    @property
    def has_exact_solution(self) -> bool:
        """Yes: the bell is carried by the wind."""
        return True

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """A cosine of the distance from the centre of the bell, which the wind has carried along."""
        start = from_lonlat(np.array(self.bell_longitude), np.array(self.bell_latitude))
        center = _turned(start, self.axis, self.wind_speed / self.radius * time)
        distance = np.minimum(arc_length(from_lonlat(longitude, latitude), center), self.bell_radius)
        return self.background_depth + 0.5 * self.bell_height * (1.0 + np.cos(np.pi * distance / self.bell_radius))


def _turned(point: Array, axis: Array, angle: float) -> Array:
    """`point` (3,) turned by `angle`, radians, counter-clockwise about the unit vector `axis` (Rodrigues's formula)."""
    along = np.dot(axis, point) * axis
    return along + np.cos(angle) * (point - along) + np.sin(angle) * np.cross(axis, point)


@dataclass(frozen=True)
class BalancedRotation(SolidRotation):
    """Solid-body rotation with a Coriolis parameter about the same axis, in balance with the height of the surface.

    The flow is steady, and its own exact solution: equations (90) to (96) of the paper.
    """

    @property
    def has_exact_solution(self) -> bool:
        """Yes: nothing changes."""
        return True

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """Equation (96)."""
        return 2.0 * self.rotation_rate * self._sine_of_turned_latitude(longitude, latitude)

    def _drop_to_the_poles(self) -> float:
        """How much lower the surface is at the poles of the rotation than at its equator, m: equation (95)."""
        return (self.radius * self.rotation_rate * self.wind_speed + 0.5 * self.wind_speed**2) / self.gravity


@dataclass(frozen=True)
class Williamson2(BalancedRotation):
    """Global steady-state nonlinear zonal geostrophic flow (test case 2), which is its own exact solution.

    The layer carries the balance, over a flat bottom.
    """

    name: ClassVar[str] = "williamson2"
    title: ClassVar[str] = "Williamson test case 2: steady geostrophic flow"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 5.0
    convergence_order: ClassVar[float | None] = 1.85

    reference_depth: float = parameter(2.94e4 / GRAVITY, "m", "Depth h0 at the equator of the rotation")

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (95)."""
        sine = self._sine_of_turned_latitude(longitude, latitude)
        return self.reference_depth - self._drop_to_the_poles() * sine**2


@dataclass(frozen=True)
class ConicalMountain(Case):
    """The isolated mountain of test case 5."""

    mountain_height: float = parameter(2000.0, "m", "Height h_s0 of the mountain's peak")
    mountain_radius: float = parameter(
        np.pi / 9.0, "rad", "Distance R, in longitude and latitude, from the peak to the foot"
    )
    mountain_longitude: float = parameter(1.5 * np.pi, "rad", "Longitude of the peak, in [0, 2 pi)")
    mountain_latitude: float = parameter(np.pi / 6.0, "rad", "Latitude of the peak")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("mountain_radius")
        self.require_angles("mountain_longitude", "mountain_latitude")

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Equation (134): a cone in the plane of longitude and latitude."""
        from_peak = about_zero(longitude - self.mountain_longitude)
        distance = np.minimum(self.mountain_radius, np.hypot(from_peak, latitude - self.mountain_latitude))
        return self.mountain_height * (1.0 - distance / self.mountain_radius)


@dataclass(frozen=True)
class Williamson5(ConicalMountain):
    """Zonal flow over an isolated mountain (test case 5), without a known solution.

    The flow of test case 2 with angle 0, slower and deeper, meets a conical mountain at mid-latitude: section 3.5
    of the paper, equation (134).
    """

    name: ClassVar[str] = "williamson5"
    title: ClassVar[str] = "Williamson test case 5: flow over an isolated mountain"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 15.0

    wind_speed: float = parameter(20.0, "m/s", "Speed u0 at the equator")
    reference_depth: float = parameter(5960.0, "m", "Height h0 of the free surface at the equator")

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (95) less the topography."""
        drop = self.radius * self.rotation_rate * self.wind_speed + 0.5 * self.wind_speed**2
        surface = self.reference_depth - drop / self.gravity * np.sin(latitude) ** 2
        return surface - self.topography(longitude, latitude)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (92) with angle 0."""
        return -self.radius * self.wind_speed * np.sin(latitude)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Equations (90) and (91) with angle 0."""
        return self.wind_speed * np.cos(latitude), np.zeros(latitude.shape)

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Twice the angular velocity along the vertical."""
        return 2.0 * self.wind_speed / self.radius * np.sin(latitude)


@dataclass(frozen=True)
class Williamson6(Case):
    """Rossby-Haurwitz wave (test case 6), without a known solution in the full equations.

    A wave that moves eastward without change of shape in the nondivergent barotropic equation, with the height that
    keeps its divergence at zero at the start: section 3.6 of the paper, equations (141) to (149).
    """

    name: ClassVar[str] = "williamson6"
    title: ClassVar[str] = "Williamson test case 6: Rossby-Haurwitz wave"
    reference: ClassVar[str] = REFERENCE
    recommended_days: ClassVar[float] = 14.0

    wave_number: int = parameter(4, "", "Zonal wave number R")
    angular_velocity: float = parameter(7.848e-6, "1/s", "Angular velocity omega of the zonal flow")
    wave_amplitude: float = parameter(7.848e-6, "1/s", "Amplitude K of the wave")
    polar_depth: float = parameter(
        8000.0, "m", "Constant part h0 of the depth; the depth at the poles where the wave number is above 1"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 <= self.wave_number <= LARGEST_WAVE_NUMBER:
            raise InputError(f"wave_number is {self.wave_number}; it must be 1 to {LARGEST_WAVE_NUMBER}")

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """The zonal flow and the wave, a spherical harmonic of degree R + 1."""
        R, omega, K = self.wave_number, self.angular_velocity, self.wave_amplitude
        wave = K * np.cos(latitude) ** R * np.cos(R * longitude)
        return self.radius**2 * np.sin(latitude) * (wave - omega)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Equations (143) and (144)."""
        R, omega, K, a = self.wave_number, self.angular_velocity, self.wave_amplitude, self.radius
        sine, cosine = np.sin(latitude), np.cos(latitude)
        wave = a * K * cosine ** (R - 1)
        zonal = a * omega * cosine + wave * (R * sine**2 - cosine**2) * np.cos(R * longitude)
        return zonal, -R * wave * sine * np.sin(R * longitude)

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """The Laplacian of the streamfunction, whose parts are spherical harmonics of degrees 1 and R + 1."""
        R, omega, K = self.wave_number, self.angular_velocity, self.wave_amplitude
        wave = K * np.cos(latitude) ** R * np.cos(R * longitude)
        return np.sin(latitude) * (2.0 * omega - (R + 1) * (R + 2) * wave)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equations (146) to (149), with the power of the cosine taken into the brackets of (147)."""
        R, omega, K = self.wave_number, self.angular_velocity, self.wave_amplitude
        c2 = np.cos(latitude) ** 2
        quarter = 0.25 * K**2 * c2 ** (R - 1)
        A = 0.5 * omega * (2.0 * self.rotation_rate + omega) * c2
        A += quarter * ((R + 1) * c2**2 + (2 * R**2 - R - 2) * c2 - 2 * R**2)
        B = 2.0 * (self.rotation_rate + omega) * K / ((R + 1) * (R + 2)) * np.cos(latitude) ** R
        B *= (R**2 + 2 * R + 2) - (R + 1) ** 2 * c2
        C = quarter * c2 * ((R + 1) * c2 - (R + 2))
        waves = A + B * np.cos(R * longitude) + C * np.cos(2 * R * longitude)
        return self.polar_depth + self.radius**2 / self.gravity * waves

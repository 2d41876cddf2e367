"""The barotropically unstable jet of Galewsky, Scott and Polvani (2004), Tellus 56A, 429-440.

Equation numbers are those of the paper, where latitude is phi and longitude lambda. Streamfunction and height are
integrals over latitude without a closed form. They are tabulated by Gauss-Legendre quadrature and interpolated by
cubics with the exact slope: the error is near round-off, far below that of any mesh.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from cases.base import Case, parameter
from mesh.arrays import Array
from mesh.geometry.angles import about_zero
from swe.errors import InputError

PANELS = 4096
"""Intervals into which the latitudes of the jet are divided."""

NODES_PER_PANEL = 8
"""Points of the Gauss-Legendre rule in each interval."""


@dataclass(frozen=True)
class Galewsky(Case):
    """Zonal jet at mid-latitude in balance, steady but unstable; a bump of height, where `perturbed`, sets it off.

    Without the bump the jet is its own exact solution. The truncation error of the mesh sets it off as well, though:
    by the sixth day the error has grown as the instability does, and it has an order only on the finest meshes.
    """

    name: ClassVar[str] = "galewsky"
    title: ClassVar[str] = "Galewsky et al.: barotropic instability of a jet"
    reference: ClassVar[str] = (
        "Galewsky et al. (2004), Tellus 56A, 429-440, https://doi.org/10.3402/tellusa.v56i5.14436"
    )
    recommended_days: ClassVar[float] = 6.0

    perturbed: bool = parameter(True, "", "Whether the bump of height is added")
    wind_speed: float = parameter(80.0, "m/s", "Speed u_max in the middle of the jet")
    southern_edge: float = parameter(np.pi / 7.0, "rad", "Latitude phi_0 where the jet begins")
    northern_edge: float = parameter(np.pi / 2.0 - np.pi / 7.0, "rad", "Latitude phi_1 where the jet ends")
    mean_depth: float = parameter(1.0e4, "m", "Mean depth over the sphere, without the bump")
    bump_height: float = parameter(120.0, "m", "Height of the bump")
    bump_latitude: float = parameter(np.pi / 4.0, "rad", "Latitude phi_2 of the middle of the bump; its longitude is 0")
    bump_width: float = parameter(1.0 / 3.0, "rad", "Extent alpha of the bump in longitude")
    bump_length: float = parameter(1.0 / 15.0, "rad", "Extent beta of the bump in latitude")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("bump_width", "bump_length")
        self.require_angles("bump_latitude")
        if not -0.5 * np.pi < self.southern_edge < self.northern_edge < 0.5 * np.pi:
            raise InputError(
                f"the jet has its edges at {self.southern_edge:g} and {self.northern_edge:g} rad; southern_edge must "
                "be less than northern_edge, and both between the poles"
            )

    @property
    def has_exact_solution(self) -> bool:
        """Yes, but only without the bump."""
        return not self.perturbed

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Equation (3), and (4) where `perturbed`."""
        balanced = self._depth_at_the_south_pole - self._integral(self._slope_integral, latitude) / self.gravity
        return balanced + self._bump(longitude, latitude) if self.perturbed else balanced

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Minus the integral of a u over latitude."""
        return -self.radius * self._integral(self._wind_integral, latitude)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Equation (2)."""
        return self._wind(latitude), np.zeros(latitude.shape)

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Minus the divergence of the wind over latitude, (u tan(phi) - du/dphi) / a."""
        below, above = latitude - self.southern_edge, latitude - self.northern_edge
        # Outside of the jet the wind is zero, whatever this factor.
        product = np.where(below * above < 0.0, below * above, -1.0)
        relative_slope = -(below + above) / product**2
        return self._wind(latitude) * (np.tan(latitude) - relative_slope) / self.radius

    def _wind(self, latitude: Array) -> Array:
        """Eastward velocity, m/s: equation (2)."""
        product = (latitude - self.southern_edge) * (latitude - self.northern_edge)
        inside = product < 0.0
        # 4 / width^2 cancels the exponent in the middle of the jet: the factor 1 / e_n of the paper.
        exponent = 1.0 / np.where(inside, product, -1.0) + 4.0 / (self.northern_edge - self.southern_edge) ** 2
        return np.where(inside, self.wind_speed * np.exp(np.where(inside, exponent, 0.0)), 0.0)

    def _slope(self, latitude: Array) -> Array:
        """-g dh/dphi, m2/s2 per radian: the integrand of equation (3)."""
        wind, coriolis = self._wind(latitude), 2.0 * self.rotation_rate * np.sin(latitude)
        return wind * (self.radius * coriolis + wind * np.tan(latitude))

    def _bump(self, longitude: Array, latitude: Array) -> Array:
        """Height of the bump, m: equation (4), with longitude in (-pi, pi)."""
        east = about_zero(longitude)
        exponent = -((east / self.bump_width) ** 2) - ((self.bump_latitude - latitude) / self.bump_length) ** 2
        return self.bump_height * np.cos(latitude) * np.exp(exponent)

    @cached_property
    def _wind_integral(self) -> CubicHermiteSpline:
        return _integrated(self._wind, self.southern_edge, self.northern_edge)

    @cached_property
    def _slope_integral(self) -> CubicHermiteSpline:
        return _integrated(self._slope, self.southern_edge, self.northern_edge)

    @cached_property
    def _depth_at_the_south_pole(self) -> float:
        """h_0 of equation (3), m, which gives the mean depth.

        The mean over the sphere of the integral G of `_slope` is, by parts, that of (1 - sin(phi)) G' / 2.
        """
        weighted = _integrated(
            lambda latitude: 0.5 * (1.0 - np.sin(latitude)) * self._slope(latitude),
            self.southern_edge,
            self.northern_edge,
        )
        return self.mean_depth + float(weighted(self.northern_edge)) / self.gravity

    def _integral(self, inside_jet: CubicHermiteSpline, latitude: Array) -> Array:
        """Integral from the south pole, constant on both sides of the jet."""
        return inside_jet(np.clip(latitude, self.southern_edge, self.northern_edge))


def _integrated(function: Callable[[Array], Array], start: float, stop: float) -> CubicHermiteSpline:
    """Integral of `function` from `start` to x, for x up to `stop`."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES_PER_PANEL)
    edges = np.linspace(start, stop, PANELS + 1)
    half = 0.5 * np.diff(edges)
    points = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    panels = half * (function(points) @ weights)
    return CubicHermiteSpline(edges, np.concatenate([[0.0], np.cumsum(panels)]), function(edges))

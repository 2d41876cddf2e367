"""Waves on planes of which the linear equations are solved exactly."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.plane.base import ExactCase
from cases.plane.lengths import require_periods
from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError


@dataclass(frozen=True)
class InertiaGravityWave(ExactCase):
    """A plane inertia-gravity (Poincare) wave on an f-plane that is periodic in both directions, known exactly.

    With the phase p = k x + l y - omega t, the surface is a cos(p) above the depth H, and
    omega^2 = f^2 + g H (k^2 + l^2). It solves the linear equations; the others differ by terms of the square of a / H.
    One period of the mesh must hold whole waves.
    """

    name: ClassVar[str] = "inertia-gravity-wave"
    title: ClassVar[str] = "Inertia-gravity wave on a periodic f-plane"
    reference: ClassVar[str] = (
        "Vallis (2017), Atmospheric and Oceanic Fluid Dynamics, chapter 3, https://doi.org/10.1017/9781107588417"
    )
    recommended_days: ClassVar[float] = 0.25
    convergence_order: ClassVar[float | None] = 1.95

    amplitude: float = parameter(1e-3, "m", "Height a of the crests of the wave")
    x_length: float = parameter(1e6, "m", "Length in x that holds waves_x waves")
    y_length: float = parameter(5e5 * math.sqrt(3.0), "m", "Length in y that holds waves_y waves")
    waves_x: int = parameter(1, "", "Number of waves along x")
    waves_y: int = parameter(1, "", "Number of waves along y")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth", "x_length", "y_length")
        if self.waves_x == self.waves_y == 0:
            raise InputError("waves_x and waves_y are 0; one of them must be another whole number")

    @property
    def wave_numbers(self) -> tuple[float, float]:
        """Wave numbers k and l along x and y, rad/m."""
        return 2.0 * math.pi * self.waves_x / self.x_length, 2.0 * math.pi * self.waves_y / self.y_length

    @property
    def frequency(self) -> float:
        """Angular frequency omega, rad/s."""
        k, l = self.wave_numbers  # noqa: E741
        return math.sqrt(self.coriolis_parameter**2 + self.gravity * self.depth * (k * k + l * l))

    @property
    def period_days(self) -> float:
        """Period of the wave, days."""
        return 2.0 * math.pi / self.frequency / SECONDS_PER_DAY

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must repeat itself after whole lengths of the case."""
        require_periods(self, mesh, x=self.x_length, y=self.y_length)

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth and the wave."""
        return self.depth + self.amplitude * np.cos(self._phase(x, y, time))

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Ellipses, along the wave numbers with the surface, and across them a quarter of a period apart."""
        phase, (k, l) = self._phase(x, y, time), self.wave_numbers  # noqa: E741
        size = self.amplitude / (self.depth * (k * k + l * l))
        cosine, sine = self.frequency * np.cos(phase), self.coriolis_parameter * np.sin(phase)
        return size * (k * cosine - l * sine), size * (l * cosine + k * sine)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """That which keeps potential vorticity uniform: f a cos(p) / H."""
        return self.coriolis_parameter * self.amplitude / self.depth * np.cos(self._phase(x, y, time))

    def _phase(self, x: Array, y: Array, time: float) -> Array:
        k, l = self.wave_numbers  # noqa: E741
        return k * x + l * y - self.frequency * time

"""The Kelvin wave of a channel, which a wall holds."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.plane.base import ExactCase
from cases.plane.lengths import require_periods
from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError


@dataclass(frozen=True)
class KelvinChannel(ExactCase):
    """A wave that the Coriolis force holds at the wall y = 0 of a channel along x, on an f-plane.

    The surface is a exp(-f y / c) cos(k (x - c t)) above the depth H, with c = sqrt(g H); the flow along x is g / c
    times that, and nothing flows across the channel, so that the other wall may stand at any distance. It solves the
    linear equations; the others differ by terms of the square of a / H.
    """

    name: ClassVar[str] = "kelvin-channel"
    title: ClassVar[str] = "Kelvin wave along a wall of a channel"
    reference: ClassVar[str] = (
        "Thomson (1880), Proc. R. Soc. Edinburgh 10, 92-100, https://doi.org/10.1017/S0370164600043467"
    )
    periodic: ClassVar[str] = "x"
    recommended_days: ClassVar[float] = 5.0

    depth: float = parameter(40.0, "m", "Depth H of the fluid at rest")
    amplitude: float = parameter(1e-3, "m", "Height a of the crests at the wall")
    x_length: float = parameter(1e6, "m", "Length in x that holds wave_number waves")
    wave_number: int = parameter(1, "", "Number of waves, 1 or more")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth", "x_length", "wave_number", "coriolis_parameter")

    @property
    def phase_speed(self) -> float:
        """Of gravity waves, c = sqrt(g H), m/s."""
        return math.sqrt(self.gravity * self.depth)

    @property
    def decay_length(self) -> float:
        """Distance from the wall in which the wave falls by 1/e, c / f, m."""
        return self.phase_speed / self.coriolis_parameter

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must be a channel along x, above y = 0, that holds whole waves."""
        require_periods(self, mesh, x=self.x_length)
        lowest = float(mesh.y_cell.min())
        if lowest < 0.0:
            raise InputError(f"{self.name} has a wall at y = 0, but the mesh has cells at y = {lowest:.6g} m; move it")

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth and the wave."""
        return self.depth + self._height(x, y, time)

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Along the wall, in phase with the surface."""
        return self.gravity / self.phase_speed * self._height(x, y, time), np.zeros(x.shape)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Of f / H times the height: the wave leaves the potential vorticity uniform."""
        return self.coriolis_parameter / self.depth * self._height(x, y, time)

    def _height(self, x: Array, y: Array, time: float) -> Array:
        """Height of the surface, m."""
        k = 2.0 * math.pi * self.wave_number / self.x_length
        strength = self.amplitude * np.exp(-y / self.decay_length)
        return np.asarray(strength * np.cos(k * (x - self.phase_speed * time)))

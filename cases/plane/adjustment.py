"""Geostrophic adjustment: steps of the surface at rest that turn into currents and waves."""

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

MOST_STEPS = 2000.0
"""Widths of the step in x_length, at most: narrower ones need more harmonics than can be summed."""

NEGLIGIBLE = 9.0
"""Harmonics whose wave number is beyond this, over the width of the step, are below round-off."""


@dataclass(frozen=True)
class GeostrophicAdjustment(ExactCase):
    """A fluid at rest whose surface has a step up at a quarter of x_length and a step down at three quarters.

    The surface is -a or a beside the steps, which a Gaussian of standard deviation `step_width` smooths. A current in
    geostrophic balance stays along each, beside which the surface rises or falls as 1 - exp(-abs(x) / R), with
    R = sqrt(g H) / f; waves carry the rest away. Where steps are sharp and far apart, a third of the potential energy
    that is released stays in the currents.

    The solution is the sum of the harmonics b sin(q x) of the surface at the start, each of which keeps the part
    G = 1 / (1 + (q R)^2) and oscillates with the rest at the frequency f / sqrt(G). It solves the linear equations; the
    others differ by terms of the square of a / H.
    """

    name: ClassVar[str] = "geostrophic-adjustment"
    title: ClassVar[str] = "Geostrophic adjustment of steps of the surface on a periodic f-plane"
    reference: ClassVar[str] = "Gill (1976), J. Fluid Mech. 77, 603-621, https://doi.org/10.1017/S0022112076002280"
    recommended_days: ClassVar[float] = 1.0

    amplitude: float = parameter(1e-3, "m", "Half of the height of the steps, a")
    x_length: float = parameter(8e6, "m", "Length in x after which the steps repeat themselves")
    step_width: float = parameter(1e5, "m", "Standard deviation of the Gaussian that smooths the steps")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth", "x_length", "step_width")
        if self.coriolis_parameter == 0.0:
            raise InputError("coriolis_parameter is 0; nothing adjusts without rotation, so give another number")
        if self.x_length > MOST_STEPS * self.step_width:
            raise InputError(
                f"step_width is {self.step_width:g}; it must be at least {self.x_length / MOST_STEPS:g}, "
                f"x_length / {MOST_STEPS:g}"
            )

    @property
    def deformation_radius(self) -> float:
        """R = sqrt(g H) / f, m."""
        return math.sqrt(self.gravity * self.depth) / abs(self.coriolis_parameter)

    @property
    def kept_energy(self) -> float:
        """Part of the potential energy released that is kinetic energy of the adjusted currents."""
        _, size, kept = self._harmonics
        released = np.sum(size**2 * (1.0 - kept**2))
        return float(np.sum(size**2 * kept * (1.0 - kept)) / released)

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must repeat itself in both directions, in x after whole lengths of the case."""
        require_periods(self, mesh, x=self.x_length)

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth, the adjusted surface and the waves."""
        _, size, kept = self._harmonics
        return self.depth + self._sum(size * (kept + (1.0 - kept) * np.cos(self._phases(time))), np.sin, x)

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Waves alone along x, currents and waves along y."""
        number, size, kept = self._harmonics
        waves, phases = size * (1.0 - kept) / (self.depth * number), self._phases(time)
        frequencies = abs(self.coriolis_parameter) / np.sqrt(kept)
        along = self._sum(-waves * frequencies * np.sin(phases), np.cos, x)
        return along, self._sum(self.coriolis_parameter * waves * (1.0 - np.cos(phases)), np.cos, x)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """That which leaves the potential vorticity of each column of fluid as it was at the start."""
        _, size, kept = self._harmonics
        waves = size * (1.0 - kept) / self.depth
        return self._sum(-self.coriolis_parameter * waves * (1.0 - np.cos(self._phases(time))), np.sin, x)

    def adjusted_thickness(self, x: Array, y: Array) -> Array:
        """What is left when the waves have gone, m."""
        _, size, kept = self._harmonics
        return self.depth + self._sum(size * kept, np.sin, x)

    def adjusted_velocity(self, x: Array, y: Array) -> tuple[Array, Array]:
        """The currents that are left then, along x and along y, m/s."""
        number, size, kept = self._harmonics
        return np.zeros(x.shape), self._sum(self.gravity / self.coriolis_parameter * size * kept * number, np.cos, x)

    @property
    def _harmonics(self) -> tuple[Array, Array, Array]:
        """Wave numbers q, rad/m, sizes b, m, and parts G that are kept, of the harmonics of the smoothed steps."""
        first = 2.0 * math.pi / self.x_length
        odd = np.arange(1.0, max(NEGLIGIBLE / (first * self.step_width), 2.0), 2.0)
        number = first * odd
        size = 4.0 * self.amplitude / (math.pi * odd) * np.exp(-0.5 * (number * self.step_width) ** 2)
        return number, size, 1.0 / (1.0 + (number * self.deformation_radius) ** 2)

    def _phases(self, time: float) -> Array:
        """Of the waves of all harmonics at `time`, radians."""
        return np.asarray(abs(self.coriolis_parameter) / np.sqrt(self._harmonics[2]) * time)

    def _sum(self, sizes: Array, function: np.ufunc, x: Array) -> Array:
        """The sum of the harmonics, sines or cosines from the step up on, with `sizes`."""
        total, from_step = np.zeros(x.shape), x - 0.25 * self.x_length
        for number, size in zip(self._harmonics[0], sizes, strict=True):
            total += size * function(number * from_step)
        return total

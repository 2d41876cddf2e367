"""A nonlinear flow on a periodic f-plane that a forcing makes an exact solution of the shallow-water equations."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.plane.base import ExactCase
from cases.plane.lengths import require_periods
from mesh.arrays import Array
from mesh.discrete.operators import normal_component
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.terms import Forcing
from swe.state import State


@dataclass(frozen=True)
class Manufactured(ExactCase):
    """Crests and eddies that move over a periodic f-plane, far from small, with the forcing that keeps them exact.

    With p = k x - w t and q = l y + w t, one wave in each direction,

        h = H + a cos(p) cos(q),   u = U (1/2 + sin(p) cos(q)),   v = U cos(p) cos(q).

    The forcing is what is left when these are put into the equations: a source of thickness,
    dh/dt + u dh/dx + v dh/dy + h (du/dx + dv/dy), and an acceleration, du/dt + u du/dx + v du/dy - f v + g dh/dx along
    x and the like along y.
    """

    name: ClassVar[str] = "manufactured"
    title: ClassVar[str] = "Manufactured solution: a forced nonlinear flow on a periodic f-plane"
    reference: ClassVar[str] = (
        "Roache (2002), J. Fluids Eng. 124, 4-10, https://doi.org/10.1115/1.1436090, for the method; the flow is ours"
    )
    recommended_days: ClassVar[float] = 0.5
    convergence_order: ClassVar[float | None] = 1.95

    depth: float = parameter(100.0, "m", "Mean thickness H")
    amplitude: float = parameter(20.0, "m", "Largest departure a of the thickness from its mean")
    speed: float = parameter(5.0, "m/s", "Largest speed U of the eddies along x and y, twice the mean flow along x")
    period: float = parameter(43200.0, "s", "Time after which the flow repeats itself")
    x_length: float = parameter(1e6, "m", "Length in x after which the flow repeats itself")
    y_length: float = parameter(5e5 * math.sqrt(3.0), "m", "Length in y after which the flow repeats itself")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth", "period", "x_length", "y_length")

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must repeat itself after whole lengths of the case."""
        require_periods(self, mesh, x=self.x_length, y=self.y_length)

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The mean and the crests."""
        return self.depth + self.amplitude * self._waves(x, y, time).cos_cos

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """The mean flow along x, and the eddies."""
        waves = self._waves(x, y, time)
        return self.speed * (0.5 + waves.sin_cos), self.speed * waves.cos_cos

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """That of the eddies."""
        waves, (k, l) = self._waves(x, y, time), self._wave_numbers  # noqa: E741
        return self.speed * (l * waves.sin_sin - k * waves.sin_cos)

    def source(self, x: Array, y: Array, time: float) -> Array:
        """What the forcing adds to dh/dt, m/s."""
        waves, (k, l), w = self._waves(x, y, time), self._wave_numbers, self._frequency  # noqa: E741
        h, (u, v) = self.thickness(x, y, time), self.velocity(x, y, time)
        rate = w * (waves.sin_cos - waves.cos_sin)
        along, across = -k * waves.sin_cos, -l * waves.cos_sin
        divergence = self.speed * (k * waves.cos_cos - l * waves.cos_sin)
        return self.amplitude * (rate + u * along + v * across) + h * divergence

    def acceleration(self, x: Array, y: Array, time: float) -> tuple[Array, Array]:
        """What the forcing adds to the rates of the velocity along x and along y, m/s2."""
        waves, (k, l), w = self._waves(x, y, time), self._wave_numbers, self._frequency  # noqa: E741
        (u, v), f = self.velocity(x, y, time), self.coriolis(x, y)
        pressure = -self.gravity * self.amplitude
        along = self.speed * (-w * (waves.cos_cos + waves.sin_sin) + u * k * waves.cos_cos - v * l * waves.sin_sin)
        across = self.speed * (w * (waves.sin_cos - waves.cos_sin) - u * k * waves.sin_cos - v * l * waves.cos_sin)
        return along - f * v + pressure * k * waves.sin_cos, across + f * u + pressure * l * waves.cos_sin

    def normal_velocity_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """Velocity at `time` along the normals of edges (n_edges,), m/s: that at the midpoints between cells.

        There the gradient of the model and the forcing are, which make this flow.
        """
        return normal_component(mesh, *self.evaluated_velocity(time)(*mesh.coordinates("edge")))

    def terms(self) -> tuple[Forcing, ...]:
        """The forcing, at the midpoints between cells and the centres of cells."""

        def acceleration(mesh: VoronoiMesh, state: State, time: float) -> Array:
            return normal_component(mesh, *self.acceleration(*mesh.coordinates("edge"), time))

        def source(mesh: VoronoiMesh, state: State, time: float) -> Array:
            return self.source(*mesh.coordinates("cell"), time)

        return (Forcing("manufactured", acceleration, source),)

    @property
    def _wave_numbers(self) -> tuple[float, float]:
        """Of the waves, k and l, rad/m."""
        return 2.0 * math.pi / self.x_length, 2.0 * math.pi / self.y_length

    @property
    def _frequency(self) -> float:
        """w, rad/s."""
        return 2.0 * math.pi / self.period

    def _waves(self, x: Array, y: Array, time: float) -> "Waves":
        (k, l), w = self._wave_numbers, self._frequency  # noqa: E741
        p, q = k * x - w * time, l * y + w * time
        return Waves(np.cos(p), np.sin(p), np.cos(q), np.sin(q))


class Waves:
    """The products of the sines and cosines of p and q, whose derivatives are such products again."""

    def __init__(self, cos_p: Array, sin_p: Array, cos_q: Array, sin_q: Array) -> None:
        self.cos_cos, self.cos_sin = cos_p * cos_q, cos_p * sin_q
        self.sin_cos, self.sin_sin = sin_p * cos_q, sin_p * sin_q

"""Two vortices on a periodic f-plane."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cases.base import parameter
from cases.plane.base import StreamfunctionCase
from cases.plane.lengths import require_periods
from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError


@dataclass(frozen=True)
class DualVortex(StreamfunctionCase):
    """Two equal cyclones beside each other on a doubly periodic f-plane, in geostrophic balance at the start.

    They are depressions of the surface, dh exp(-(X^2 + Y^2) / 2) deep. X = sin(pi (x - x0) / L) / (pi s), with the
    length L of the plane, is nearly that of a Gaussian of standard deviation s L, but periodic; Y is the like. Both
    centres stand `distance` of the lengths from the middle, along x and along y. The cyclones turn about each other and
    move apart, and draw out filaments of potential vorticity. The flow stays the same when the plane is turned by half
    a turn about its middle.
    """

    name: ClassVar[str] = "dual-vortex"
    title: ClassVar[str] = "Dual vortex: two cyclones on a periodic f-plane"
    reference: ClassVar[str] = (
        "Bauer and Gay-Balmaz (2019), J. Comput. Dyn. 6, 1-37, https://doi.org/10.3934/jcd.2019001"
    )
    recommended_days: ClassVar[float] = 10.0

    coriolis_parameter: float = parameter(6.147e-5, "1/s", "Coriolis parameter f0 at y = 0")
    depth: float = parameter(750.0, "m", "Depth H, nearly the mean")
    vortex_depth: float = parameter(75.0, "m", "Depth dh of the depressions in the middle of the vortices")
    vortex_width: float = parameter(0.075, "", "Standard deviations s along x and y, in lengths of the plane")
    distance: float = parameter(
        0.1, "", "Distance of each centre from the middle along x and y, in lengths of the plane"
    )
    x_length: float = parameter(5e6, "m", "Length of the plane in x")
    y_length: float = parameter(2.5e6 * math.sqrt(3.0), "m", "Length of the plane in y")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth", "vortex_width", "x_length", "y_length")
        if self.coriolis_parameter == 0.0:
            raise InputError("coriolis_parameter is 0; the vortices are in geostrophic balance, so give another number")

    @property
    def background_depth(self) -> float:
        """The depth: norms are those of the departure from it."""
        return self.depth

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must repeat itself after whole lengths of the case."""
        require_periods(self, mesh, x=self.x_length, y=self.y_length)

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth less the depressions, which are taken above their mean, or nearly so."""
        lacking = 4.0 * math.pi * self.vortex_width**2
        shapes = np.sum([vortex.shape for vortex in self._vortices(x, y)], axis=0)
        return np.asarray(self.depth - self.vortex_depth * (shapes - lacking))

    def streamfunction(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """That of geostrophic flow, g (h - H) / f."""
        return self.gravity / self.coriolis_parameter * (self.thickness(x, y) - self.depth)

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """In geostrophic balance."""
        size = self.gravity * self.vortex_depth / self.coriolis_parameter
        vortices = self._vortices(x, y)
        return (
            -size * np.sum([vortex.shape * vortex.slope_y for vortex in vortices], axis=0),
            size * np.sum([vortex.shape * vortex.slope_x for vortex in vortices], axis=0),
        )

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Positive in the middle of cyclones of the northern hemisphere."""
        size = self.gravity * self.vortex_depth / self.coriolis_parameter
        return np.asarray(
            size
            * np.sum(
                [
                    vortex.shape * (vortex.bend - vortex.slope_x**2 - vortex.slope_y**2)
                    for vortex in self._vortices(x, y)
                ],
                axis=0,
            )
        )

    def _vortices(self, x: Array, y: Array) -> list["Vortex"]:
        """The two, at positions."""
        lengths = self.x_length, self.y_length
        middles = ([(0.5 + side * self.distance) * length for length in lengths] for side in (-1.0, 1.0))
        return [Vortex(x - x0, y - y0, lengths, self.vortex_width) for x0, y0 in middles]


class Vortex:
    """exp(-e) at distances from a centre, and the derivatives of e, where e is nearly (x^2 / s^2 + y^2 / s^2) / 2.

    `shape` is exp(-e); `slope_x` and `slope_y`, 1/m, are the first derivatives of e, and `bend`, 1/m2, its Laplacian.
    `width` is s in lengths of the plane.
    """

    def __init__(self, x: Array, y: Array, lengths: tuple[float, float], width: float) -> None:
        exponent, self.bend, slopes = np.zeros(x.shape), np.zeros(x.shape), []
        for position, length in zip((x, y), lengths, strict=True):
            turn = math.pi * position / length
            exponent += 0.5 * (np.sin(turn) / (math.pi * width)) ** 2
            slopes.append(np.sin(2.0 * turn) / (2.0 * math.pi * width**2 * length))
            self.bend += np.cos(2.0 * turn) / (width * length) ** 2
        self.shape = np.exp(-exponent)
        self.slope_x, self.slope_y = slopes

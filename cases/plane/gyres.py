"""Gyres that the wind drives in a box on a beta-plane: those of Stommel and Munk."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from cases.base import parameter
from cases.gyres import stommel_profile
from cases.munk import Place, evaluated, solution
from cases.plane.base import StreamfunctionCase
from cases.plane.lengths import require_periodic
from cases.sea_walls import stray_wall
from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.forcing.drag import LinearDrag
from swe.forcing.viscosity import Viscosity
from swe.forcing.wind import SEA_WATER, WindStress

OUTLINES = 0.3
"""Roots of the area of a cell by which outlines of hexagons leave a straight wall, at most: 0.27."""


@dataclass(frozen=True)
class GyreBox(StreamfunctionCase):
    """A steady gyre in a box of x_length by y_length with a corner at the origin, under the stress -tau cos(pi y / Ly).

    The wind is so weak that the equations are linear to some parts in 1000.
    """

    periodic: ClassVar[str] = "none"

    beta: float = parameter(2e-11, "1/(m s)", "Change of the Coriolis parameter with y")
    depth: float = parameter(100.0, "m", "Depth of the fluid at rest")
    wind_stress: float = parameter(1e-5, "N/m2", "Largest stress tau of the wind")
    x_length: float = parameter(1e6, "m", "Length Lx of the box")
    y_length: float = parameter(5e5 * math.sqrt(3.0), "m", "Length Ly of the box")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("beta", "depth", "x_length", "y_length")

    @property
    def has_exact_solution(self) -> bool:
        """Yes, but for terms of the square of the wind."""
        return True

    @property
    def background_depth(self) -> float:
        """The depth: norms are those of the height of the surface."""
        return self.depth

    @property
    def width(self) -> float:
        """Of the box along x, m."""
        return self.x_length

    @property
    def height(self) -> float:
        """Of the box along y, m."""
        return self.y_length

    @property
    def driving(self) -> float:
        """Stress over density and depth, m/s2."""
        return self.wind_stress / (SEA_WATER * self.depth)

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """See `PlaneCase`; the mesh must be that of the box, between four walls."""
        require_periodic(self, mesh)
        for axis, length in (("x", self.x_length), ("y", self.y_length)):
            centres = getattr(mesh, f"{axis}_cell")
            if centres.min() < 0.0 or centres.max() > length:
                raise InputError(
                    f"{self.name} is in a box from 0 to {axis}_length = {length:.10g} m in {axis}, but the mesh has "
                    f"cells from {centres.min():.6g} to {centres.max():.6g} m; set {axis}_length, or take another mesh"
                )
        x, y = mesh.x_vertex, mesh.y_vertex
        stray = stray_wall(mesh, np.abs([x, x - self.x_length, y, y - self.y_length]).min(axis=0), OUTLINES)
        if stray is not None:
            raise InputError(
                f"{self.name} is in a box of x_length = {self.x_length:.10g} by y_length = {self.y_length:.10g} m, but "
                f"the mesh has a wall at x = {x[stray]:.6g}, y = {y[stray]:.6g} m; set these, or take another mesh"
            )

    def streamfunction_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """See `StreamfunctionCase`; the walls of the mesh are streamlines, where it vanishes.

        They are the edges without a second cell, the centre of which would be outside the box. Other edges without one
        are at the rim of what a process has of the mesh.
        """
        streamfunction = super().streamfunction_on(mesh, time)
        edges = wall_edges(mesh)
        beyond = 2.0 * mesh.edge_points[edges] - mesh.cell_points[mesh.cells_on_edge[edges].max(axis=1)]
        outside = (beyond[:, :2] < 0.0) | (beyond[:, :2] > (self.x_length, self.y_length))
        streamfunction[mesh.vertices_on_edge[edges[outside.any(axis=1)]]] = 0.0
        return streamfunction

    def stress(self, x: Array, y: Array) -> Array:
        """Stress of the wind along x, N/m2."""
        return np.asarray(-self.wind_stress * np.cos(math.pi / self.y_length * self._in_box(x, y)[1]))

    @abstractmethod
    def friction(self) -> Forcing:
        """What balances the wind."""

    def terms(self) -> tuple[Forcing, ...]:
        """Wind and friction."""
        return WindStress(self.stress), self.friction()

    def _in_box(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Positions; at the wall, if beyond it, as corners of cells there are."""
        return np.clip(x, 0.0, self.x_length), np.clip(y, 0.0, self.y_length)


@dataclass(frozen=True)
class StommelBox(GyreBox):
    """Stommel's gyre: linear drag balances the wind, r lap(psi) + beta dpsi/dx = -(pi / Ly) T sin(pi y / Ly).

    T is the stress over density and depth. The boundary layer in the west is r / beta wide.
    """

    name: ClassVar[str] = "stommel-box"
    title: ClassVar[str] = "Stommel's gyre in a box on a beta-plane"
    reference: ClassVar[str] = (
        "Stommel (1948), Trans. Am. Geophys. Union 29, 202-206, https://doi.org/10.1029/TR029i002p00202"
    )
    recommended_days: ClassVar[float] = 30.0

    drag_rate: float = parameter(2e-6, "1/s", "Rate r of the linear drag")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("drag_rate")

    def friction(self) -> Forcing:
        """Linear drag."""
        return LinearDrag(self.drag_rate)

    def streamfunction(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Steady."""
        x, y = self._in_box(x, y)
        return np.asarray(self._profile(x)[0] * np.sin(self._wave_number * y))

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Steady."""
        x, y = self._in_box(x, y)
        (profile, slope), k = self._profile(x), self._wave_number
        return -k * profile * np.cos(k * y), slope * np.sin(k * y)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """That from which drag takes what the wind and the planet give: -(k T + beta X') sin(k y) / r."""
        x, y = self._in_box(x, y)
        given = self._wave_number * self.driving + self.beta * self._profile(x)[1]
        return np.asarray(-given / self.drag_rate * np.sin(self._wave_number * y))

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth and a surface whose slope balances wind, drag and Coriolis force."""
        x, y = self._in_box(x, y)
        (profile, slope), k = self._profile(x), self._wave_number
        along = self.beta * profile + self.drag_rate * slope
        pressure = self.coriolis(x, y) * profile * np.sin(k * y) + along * np.cos(k * y) / k
        return np.asarray(self.depth + pressure / self.gravity)

    @property
    def _wave_number(self) -> float:
        """Wave number k = pi / Ly, rad/m."""
        return math.pi / self.y_length

    def _profile(self, x: Array) -> tuple[Array, Array]:
        """X(x) of the streamfunction X sin(k y), m2/s, and its derivative."""
        return stommel_profile(x, self.x_length, self._wave_number, self.beta, self.drag_rate, self.driving)


@dataclass(frozen=True)
class MunkBox(GyreBox):
    """Munk's gyre: viscosity balances the wind, beta dpsi/dx = A lap(lap(psi)) - (pi / Ly) T sin(pi y / Ly).

    T is the stress over density and depth. The fluid does not slip along any of the four walls, where Munk leaves
    friction out in the north and the south; polynomials solve the equation, as they do on the sphere (`cases.munk`).
    The boundary layer in the west is about (A / beta)^(1/3) wide.
    """

    name: ClassVar[str] = "munk-box"
    title: ClassVar[str] = "Munk's gyre in a box on a beta-plane"
    reference: ClassVar[str] = (
        "Munk (1950), J. Meteorol. 7, 80-93, https://doi.org/10.1175/1520-0469(1950)007<0080:OTWDOC>2.0.CO;2"
    )
    recommended_days: ClassVar[float] = 30.0

    viscosity: float = parameter(1e4, "m2/s", "Viscosity A")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("viscosity")

    def friction(self) -> Forcing:
        """Viscosity."""
        return Viscosity(self.viscosity)

    def place(self, nodes: Array) -> Place:
        """See `cases.munk.MunkSea`: nothing depends on y."""
        none = np.zeros((len(nodes), 1))
        return Place(none + 1.0, none, none, none + self.beta)

    def streamfunction(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Steady."""
        return evaluated(solution(self).streamfunction, *self._scaled(x, y))

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Steady."""
        return -self._derivative(0, 1, x, y), self._derivative(1, 0, x, y)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Steady."""
        return self._derivative(2, 0, x, y) + self._derivative(0, 2, x, y)

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """The depth and a surface whose slope balances wind, viscosity and Coriolis force."""
        pressure = evaluated(solution(self).pressure, *self._scaled(x, y))
        pressure += self.coriolis(*self._in_box(x, y)) * self.streamfunction(x, y)
        return self.depth + pressure / self.gravity

    def _derivative(self, along: int, across: int, x: Array, y: Array) -> Array:
        """That of the streamfunction, so many times in x and in y."""
        series = chebyshev.chebder(solution(self).streamfunction, along, 2.0 / self.x_length, axis=0)
        series = chebyshev.chebder(series, across, 2.0 / self.y_length, axis=1)
        return evaluated(np.asarray(series, dtype=np.float64), *self._scaled(x, y))

    def _scaled(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Positions in the box, from -1 to 1 in both directions."""
        x, y = self._in_box(x, y)
        return 2.0 * x / self.x_length - 1.0, 2.0 * y / self.y_length - 1.0

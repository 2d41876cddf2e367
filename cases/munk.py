"""Munk's gyre, which viscosity balances, and its solution on the sphere by Chebyshev polynomials."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Protocol

import numpy as np
from numpy.polynomial import chebyshev

from cases.base import parameter
from cases.gyres import Gyre, mercator
from mesh.arrays import Array
from swe.equations.terms import Forcing
from swe.forcing.viscosity import Viscosity

TERMS = 44
"""Chebyshev polynomials in each direction: l2 errors of 2e-5 in psi and 7e-4 in height, from the corners."""


@dataclass(frozen=True, eq=False)
class Series:
    """Chebyshev coefficients (n, m) of streamfunction, m2/s, and of g times the surface less f psi, m2/s2.

    The first index belongs to longitude, the second to Mercator's y; both run from -1 to 1 over the sea.
    """

    streamfunction: Array
    pressure: Array


@dataclass(frozen=True, eq=False)
class Place:
    """What depends on latitude in the equation, at nodes (n, 1).

    s = 1 / (a cos(lat))^2, 1/m2, its two derivatives in y, and df/dy, 1/s. On a plane, with x and y in metres, s is 1.
    """

    s: Array
    slope: Array
    bend: Array
    beta: Array


class MunkSea(Protocol):
    """What the solution asks for: a closed sea, on the sphere or on a plane, in the coordinates of its equation."""

    @property
    def width(self) -> float:
        """Of the sea in x."""

    @property
    def height(self) -> float:
        """Of the sea in y."""

    @property
    def driving(self) -> float:
        """T, where the wind is -T cos(pi s) along x, s from 0 in the south to 1 in the north."""

    @property
    def viscosity(self) -> float:
        """A, m2/s."""

    def place(self, nodes: Array) -> Place:
        """What depends on latitude at `nodes` (n,), from -1 in the south to 1 in the north."""

    def __hash__(self) -> int:
        """Solutions are kept by the parameters of the sea."""


@dataclass(frozen=True)
class Munk(Gyre):
    """Munk's gyre in a closed sea of the rotating sphere, whose fluid does not slip along any coast.

    Times the square of a cos(lat), the curl of the equations of steady flow is, in longitude and Mercator's y,
    2 Omega cos(lat)^2 dpsi/dlon = -(pi / Y) T sin(pi s) + A lap(lap psi / (a cos(lat))^2). Munk leaves out friction at
    the northern and southern coast and the change of beta with latitude; here nothing is left out, and the equation is
    solved by polynomials. The boundary layer is about (A / beta)^(1/3) wide.
    """

    name: ClassVar[str] = "munk"
    title: ClassVar[str] = "Munk's gyre: wind and viscosity in a closed sea"
    reference: ClassVar[str] = (
        "Munk (1950), J. Meteorol. 7, 80-93, https://doi.org/10.1175/1520-0469(1950)007<0080:OTWDOC>2.0.CO;2"
    )
    recommended_days: ClassVar[float] = 20.0

    viscosity: float = parameter(2.2e6, "m2/s", "Viscosity A")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("viscosity")

    def friction(self) -> Forcing:
        """Viscosity."""
        return Viscosity(self.viscosity)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Steady."""
        return evaluated(solution(self).streamfunction, *self._scaled(longitude, latitude))

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """The depth and a surface whose slope balances wind, viscosity and Coriolis force."""
        pressure = evaluated(solution(self).pressure, *self._scaled(longitude, latitude))
        pressure += self.coriolis(longitude, latitude) * self.streamfunction(longitude, latitude)
        return self.depth + pressure / self.gravity

    def _scaled(self, longitude: Array, latitude: Array) -> tuple[Array, Array]:
        """Positions in the sea, from -1 to 1 in both directions."""
        x, y = self.in_box(longitude, latitude)
        return 2.0 * x / self.width - 1.0, 2.0 * y / self.height - 1.0

    def place(self, nodes: Array) -> Place:
        """See `MunkSea`."""
        y = mercator(np.array(self.south)) + 0.5 * (nodes[:, None] + 1.0) * self.height
        area = self.radius**2
        return Place(
            np.cosh(y) ** 2 / area,
            np.sinh(2.0 * y) / area,
            2.0 * np.cosh(2.0 * y) / area,
            2.0 * self.rotation_rate / np.cosh(y) ** 2,
        )


def evaluated(series: Array, x: Array, y: Array) -> Array:
    """Values of a series of coefficients (n, m) at positions from -1 to 1."""
    return np.asarray(chebyshev.chebval2d(x, y, series), dtype=np.float64)


@lru_cache(maxsize=8)
def solution(case: MunkSea, terms: int = TERMS) -> Series:
    """The steady flow of a case, by collocation: psi is (1 - x^2)^2 (1 - y^2)^2 times a polynomial."""
    nodes = chebyshev.chebpts1(terms)
    along, across = 2.0 / case.width, 2.0 / case.height
    basis = clamped(terms)
    x = [along**order * chebyshev.chebval(nodes, chebyshev.chebder(basis, order)).T for order in range(5)]
    y = [across**order * chebyshev.chebval(nodes, chebyshev.chebder(basis, order)).T for order in range(5)]
    place = case.place(nodes)
    # The Laplacian of s lap(psi), with s = 1 / (a cos(lat))^2, a function of y.
    viscous = (
        np.kron(x[4], place.s * y[0])
        + np.kron(x[2], 2.0 * (place.s * y[2] + place.slope * y[1]) + place.bend * y[0])
        + np.kron(x[0], place.s * y[4] + 2.0 * place.slope * y[3] + place.bend * y[2])
    )
    curl = -(math.pi / case.height) * case.driving * np.sin(0.5 * math.pi * (nodes + 1.0))
    operator = np.kron(x[1], place.beta * y[0]) - case.viscosity * viscous
    factors = np.linalg.solve(operator, np.tile(curl, terms)).reshape(terms, terms)
    streamfunction = basis @ factors @ basis.T
    return Series(streamfunction, pressure_series(case, streamfunction))


def clamped(terms: int) -> Array:
    """Coefficients (terms + 4, terms) of (1 - x^2)^2 times each Chebyshev polynomial: zero at the ends, with slope."""
    square = np.array([3.0, 0.0, -4.0, 0.0, 1.0]) / 8.0
    columns = [chebyshev.chebmul(square, unit) for unit in np.eye(terms)]
    return np.stack([np.pad(column, (0, terms + 4 - len(column))) for column in columns], axis=1)


def pressure_series(case: MunkSea, streamfunction: Array) -> Array:
    """Coefficients of W = g eta - f psi, m2/s2, from those of psi.

    dW/dlon is the wind less A dzeta/dy, and dW/dy is A dzeta/dlon - psi df/dy: from the middle of the sea to the north
    and south by the second, and from there to the east and west by the first.
    """
    nodes = chebyshev.chebpts1(len(streamfunction))
    along, across = 2.0 / case.width, 2.0 / case.height
    place = case.place(nodes)

    def at(x: Array, dx: int, dy: int) -> Array:
        """Derivative of psi at `x` (k,) and the nodes in y, (n, k)."""
        derivative = chebyshev.chebder(chebyshev.chebder(streamfunction, dx, axis=0), dy, axis=1)
        values = along**dx * across**dy * chebyshev.chebgrid2d(x, nodes, derivative).T
        return np.asarray(values, dtype=np.float64)

    inverse = np.linalg.inv(chebyshev.chebvander(nodes, len(nodes) - 1))
    middle = np.zeros(1)
    northward = case.viscosity * place.s * (at(middle, 3, 0) + at(middle, 1, 2)) - place.beta * at(middle, 0, 0)
    bend = place.s * (at(nodes, 2, 1) + at(nodes, 0, 3)) + place.slope * (at(nodes, 2, 0) + at(nodes, 0, 2))
    wind = -case.driving * np.cos(0.5 * math.pi * (nodes[:, None] + 1.0))
    eastward = wind - case.viscosity * bend
    result = chebyshev.chebint(inverse @ eastward.T @ inverse.T, axis=0, scl=1.0 / along, lbnd=0.0)
    result = np.pad(result, ((0, 0), (0, 1)))
    result[0] += chebyshev.chebint(inverse @ northward[:, 0], scl=1.0 / across)
    return np.asarray(result, dtype=np.float64)

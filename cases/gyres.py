"""Seas that the wind drives: Stommel's gyre, which is known exactly, and the double gyre, which becomes turbulent."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cases.base import Case, parameter
from cases.basins import ON_THE_COAST, Basin
from cases.sea_walls import stray_wall
from mesh.arrays import Array
from mesh.geometry.angles import about_zero
from mesh.integrals.quadrature import Sampling
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.forcing.drag import LinearDrag
from swe.forcing.viscosity import Viscosity
from swe.forcing.wind import SEA_WATER, WindStress
from swe.state import State


def mercator(latitude: Array) -> Array:
    """The coordinate y = artanh(sin(latitude)), which maps the sphere to a plane without changing angles."""
    return np.arctanh(np.sin(latitude))


STAIRS = 1.0
"""Roots of the area of a cell by which a coast may miss that of the sea: stairs do by 0.6, smooth corners by more."""


@dataclass(frozen=True)
class Gyre(Basin):
    """A steady gyre between two meridians and two parallels, under the stress -tau cos(pi s) / cos(lat) eastward.

    s runs from 0 in the south to 1 in the north, evenly in Mercator's y. The sea turns as an anticyclone in the north
    of the sphere. The wind is so weak that the equations are linear to some parts in 10000.
    """

    west: float = parameter(0.0, "rad", "Longitude of the western coast")
    east: float = parameter(math.pi / 3.0, "rad", "Longitude of the eastern coast")
    south: float = parameter(math.pi / 18.0, "rad", "Latitude of the southern coast")
    north: float = parameter(5.0 * math.pi / 18.0, "rad", "Latitude of the northern coast")
    wind_stress: float = parameter(0.01, "N/m2", "Largest stress of the wind, times the cosine of latitude")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_angles("west", "east")
        self.require_positive("rotation_rate")
        if not (0.0 < self.east - self.west < 2.0 * math.pi and -1.5 < self.south < self.north < 1.5):
            raise InputError(
                f"the sea from {self.west:g} to {self.east:g} east and {self.south:g} to {self.north:g} north is none; "
                "give radians, east of west and north of south, less than a turn and no latitude beyond 1.5"
            )

    @property
    def basin(self) -> str:
        """See `Basin`."""
        sides = ",".join(f"{math.degrees(side):g}" for side in (self.west, self.east, self.south, self.north))
        return f"the box {sides} in degrees"

    @property
    def has_exact_solution(self) -> bool:
        """Yes, but for terms of the square of the wind."""
        return True

    @property
    def width(self) -> float:
        """Of the sea in longitude, radians."""
        return self.east - self.west

    @property
    def height(self) -> float:
        """Of the sea in Mercator's y."""
        return float(np.diff(mercator(np.array([self.south, self.north])))[0])

    @property
    def driving(self) -> float:
        """Radius times stress over density and depth, m3/s2."""
        return self.radius * self.wind_stress / (SEA_WATER * self.depth)

    def is_outside(self, longitude: Array, latitude: Array) -> NDArray[np.bool_]:
        """See `Basin`."""
        beyond = np.abs(self._from_middle(longitude)) > 0.5 * self.width + ON_THE_COAST
        return np.asarray(beyond | (latitude < self.south - ON_THE_COAST) | (latitude > self.north + ON_THE_COAST))

    def state_on(self, mesh: VoronoiMesh, time: float = 0.0, sampling: Sampling = "point") -> State:
        """See `Basin`. Raises `InputError` if the mesh has a coast within the sea too."""
        state = super().state_on(mesh, time, sampling)
        lon, lat = mesh.lon_vertex, mesh.lat_vertex
        along = (0.5 * self.width - np.abs(self._from_middle(lon))) * np.cos(lat)
        away = self.radius * np.abs([along, lat - self.south, lat - self.north]).min(axis=0)
        stray = stray_wall(mesh, away, STAIRS)
        if stray is not None:
            raise InputError(
                f"{self.name} needs a mesh of all of {self.basin}, but this one has a coast at "
                f"{math.degrees(lon[stray]):.4g} E, {math.degrees(lat[stray]):.4g} N; take another region"
            )
        return state

    def in_box(self, longitude: Array, latitude: Array) -> tuple[Array, Array]:
        """Longitude from the western coast, and Mercator's y from the southern one; at the coast, if beyond it."""
        from_west = np.clip(self._from_middle(longitude) + 0.5 * self.width, 0.0, self.width)
        return from_west, mercator(np.clip(latitude, self.south, self.north)) - mercator(np.array(self.south))

    def _from_middle(self, longitude: Array) -> Array:
        """Longitude from the middle of the sea, between minus and plus half a turn."""
        middle = 0.5 * (self.west + self.east)
        return about_zero(longitude - middle)

    def stress(self, longitude: Array, latitude: Array) -> Array:
        """Eastward stress of the wind, N/m2."""
        _, y = self.in_box(longitude, latitude)
        return -self.wind_stress * np.cos(math.pi * y / self.height) / np.cos(latitude)

    @abstractmethod
    def friction(self) -> Forcing:
        """What balances the wind."""

    def terms(self) -> tuple[Forcing, ...]:
        """Wind and friction."""
        return WindStress(self.stress), self.friction()


@dataclass(frozen=True)
class Stommel(Gyre):
    """Stommel's gyre, which linear drag balances, carried over to the sphere without approximation.

    The Coriolis parameter is 2 Omega y, with Mercator's y. Times the square of a cos(lat), the curl of the equations of
    steady flow then has Stommel's constant coefficients in longitude and y, r lap psi + 2 Omega dpsi/dlon =
    -(pi / Y) T sin(pi s), so that his solution holds. Its boundary layer is r / (2 Omega) wide in longitude.
    """

    name: ClassVar[str] = "stommel"
    title: ClassVar[str] = "Stommel's gyre: wind and linear drag in a closed sea"
    reference: ClassVar[str] = (
        "Stommel (1948), Trans. Am. Geophys. Union 29, 202-206, https://doi.org/10.1029/TR029i002p00202"
    )
    recommended_days: ClassVar[float] = 15.0

    drag_rate: float = parameter(1.25e-5, "1/s", "Rate r of the linear drag")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("drag_rate")

    def friction(self) -> Forcing:
        """Linear drag."""
        return LinearDrag(self.drag_rate)

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """2 Omega y."""
        return 2.0 * self.rotation_rate * mercator(latitude)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Steady."""
        x, y = self.in_box(longitude, latitude)
        return self._profile(x)[0] * np.sin(math.pi * y / self.height)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """The depth and a surface whose slope balances wind, drag and Coriolis force."""
        x, y = self.in_box(longitude, latitude)
        profile, slope = self._profile(x)
        wave_number = math.pi / self.height
        along = 2.0 * self.rotation_rate * profile + self.drag_rate * slope
        pressure = self.coriolis(longitude, latitude) * profile * np.sin(wave_number * y)
        return self.depth + (pressure + along * np.cos(wave_number * y) / wave_number) / self.gravity

    def _profile(self, x: Array) -> tuple[Array, Array]:
        """X(x) of the streamfunction X sin(pi s), m2/s, and its derivative, at longitudes from the western coast."""
        beta, wave_number = 2.0 * self.rotation_rate, math.pi / self.height
        return stommel_profile(x, self.width, wave_number, beta, self.drag_rate, self.driving)


def stommel_profile(
    x: Array, width: float, wave_number: float, beta: float, drag_rate: float, driving: float
) -> tuple[Array, Array]:
    """X(x) of Stommel's streamfunction X sin(k y), and its derivative, at distances `x` from the western coast.

    It solves r (X'' - k^2 X) + beta X' = -k T and vanishes at both coasts, `width` apart; T is the `driving`.
    """
    r, k = drag_rate, wave_number
    root = math.sqrt(beta**2 + 4.0 * (r * k) ** 2)
    slow, fast = (root - beta) / (2.0 * r), (root + beta) / (2.0 * r)
    # A exp(slow (x - width)) + B exp(-fast x) is 1 at both coasts, and neither part overflows.
    over, back = math.exp(-slow * width), math.exp(-fast * width)
    from_east, from_west = (1.0 - back) / (1.0 - over * back), (1.0 - over) / (1.0 - over * back)
    east, west = from_east * np.exp(slow * (x - width)), from_west * np.exp(-fast * x)
    size = driving / (r * k)
    return size * (1.0 - east - west), size * (fast * west - slow * east)


@dataclass(frozen=True)
class DoubleGyre(Case):
    """A subtropical and a subpolar gyre in a closed sea of any shape, such as the North Atlantic, from rest.

    One layer, as thick as the water above the thermocline, over another at rest: `gravity` is the reduced one. The
    stress is -tau cos(2 pi s) eastward, with s from 0 to 1 between two latitudes and constant beyond them: westerlies
    in the middle. Where the mesh resolves the radius of deformation, sqrt(g h) / f or some 70 km, eddies grow within
    a few years.
    """

    name: ClassVar[str] = "double-gyre"
    title: ClassVar[str] = "Double gyre: a closed sea under a zonal wind"
    reference: ClassVar[str] = (
        "Jiang et al. (1995), J. Phys. Oceanogr. 25, 764-786, "
        "https://doi.org/10.1175/1520-0485(1995)025<0764:MEPAAS>2.0.CO;2"
    )
    recommended_days: ClassVar[float] = 3650.0

    gravity: float = parameter(0.1, "m/s2", "Reduced acceleration of gravity")
    depth: float = parameter(500.0, "m", "Thickness of the layer at rest")
    wind_stress: float = parameter(0.1, "N/m2", "Largest stress tau of the wind")
    wind_south: float = parameter(math.pi / 12.0, "rad", "Southern latitude of the strongest easterlies")
    wind_north: float = parameter(65.0 * math.pi / 180.0, "rad", "Northern latitude of the strongest easterlies")
    drag_rate: float = parameter(1e-7, "1/s", "Rate of the linear drag")
    viscosity: float = parameter(300.0, "m2/s", "Laplacian viscosity")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth")
        if not self.wind_south < self.wind_north:
            raise InputError(
                f"wind_north is {self.wind_north:g}; it must be greater than wind_south, {self.wind_south:g}"
            )

    @property
    def background_depth(self) -> float:
        """The depth: norms are those of the departure from rest."""
        return self.depth

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Uniform."""
        return np.full(longitude.shape, self.depth)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Zero: the sea is at rest."""
        return np.zeros(longitude.shape)

    def stress(self, longitude: Array, latitude: Array) -> Array:
        """Eastward stress of the wind, N/m2."""
        s = np.clip((latitude - self.wind_south) / (self.wind_north - self.wind_south), 0.0, 1.0)
        return -self.wind_stress * np.cos(2.0 * math.pi * s)

    def terms(self) -> tuple[Forcing, ...]:
        """Wind, drag and viscosity."""
        return WindStress(self.stress), LinearDrag(self.drag_rate), Viscosity(self.viscosity)

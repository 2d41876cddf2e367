"""Cases of closed basins: what they share, the seiche of half a sphere, and the Kelvin wave along its coast."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import lpmv

from cases.base import Case, parameter
from cases.differences import gradient
from mesh.arrays import Array, Index
from mesh.discrete.operators import normal_component, normal_velocity_from_streamfunction
from mesh.discrete.walls import wall_edges
from mesh.geometry.sphere import dot, to_lonlat
from mesh.integrals.quadrature import Sampling
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.state import State

ON_THE_COAST = 1e-6
"""Cells whose centres are less than this angle, radians, beyond the coast are at the coast."""


HIGHEST_DEGREE = 30
"""Of spherical harmonics; meshes of some thousands of cells do not resolve more."""

SAMPLES = 1001
"""Latitudes at which the largest value of a spherical harmonic is looked for."""


@dataclass(frozen=True)
class Basin(Case):
    """A sea that walls close, on a mesh whose cells are missing elsewhere (`mesh.parts.cutting.without_cells`)."""

    depth: float = parameter(1000.0, "m", "Depth of the sea")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("depth")

    @property
    def background_depth(self) -> float:
        """The depth: norms are those of the height of the surface."""
        return self.depth

    @property
    @abstractmethod
    def basin(self) -> str:
        """Where the sea is, as the end of a sentence."""

    @abstractmethod
    def is_outside(self, longitude: Array, latitude: Array) -> NDArray[np.bool_]:
        """Which positions lie outside the sea."""

    def state_on(self, mesh: VoronoiMesh, time: float = 0.0, sampling: Sampling = "point") -> State:
        """See `Case`; the streamfunction is constant along the coast. Raises `InputError` if cells lie outside."""
        outside = int(self.is_outside(mesh.lon_cell, mesh.lat_cell).sum())
        if outside:
            raise InputError(
                f"{self.name} needs a mesh of {self.basin} alone, but {outside} of its {mesh.n_cells} cells have their "
                "centres elsewhere; cut them out"
            )
        state = super().state_on(mesh, time, sampling)
        return State(state.thickness, self.normal_velocity_on(mesh, time))

    def normal_velocity_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """Velocity at `time` along the normals of edges (n_edges,), m/s, that does not diverge, even at the coast."""
        streamfunction = self.evaluated(self.streamfunction, time)(mesh.lon_vertex, mesh.lat_vertex)
        streamfunction[mesh.vertices_on_edge[self._coast(mesh)]] = 0.0
        return normal_velocity_from_streamfunction(mesh, streamfunction)

    def _coast(self, mesh: VoronoiMesh) -> Index:
        """Edges at the coast: those without a second cell, the centre of which would be outside the sea.

        Other edges without one are at the rim of what a process has of the mesh.
        """
        edges = wall_edges(mesh)
        middles, centres = mesh.edge_points[edges], mesh.cell_points[mesh.cells_on_edge[edges].max(axis=1)]
        mirror = 2.0 * dot(middles, centres) / dot(middles, middles)
        longitude, latitude = to_lonlat(mirror[:, None] * middles - centres)
        return edges[self.is_outside(longitude, latitude)]


@dataclass(frozen=True)
class Wave(Basin):
    """A small wave in the northern half of the sphere, whose coast is the equator; its flow diverges."""

    amplitude: float = parameter(0.1, "m", "Largest height of the surface")

    @property
    def basin(self) -> str:
        """See `Basin`."""
        return "the northern half of the sphere (the box -180,180,0,90)"

    @property
    def has_exact_solution(self) -> bool:
        """Yes, but for terms of the square of the amplitude."""
        return True

    @property
    def speed(self) -> float:
        """Of gravity waves in the sea, sqrt(g H), m/s."""
        return math.sqrt(self.gravity * self.depth)

    def is_outside(self, longitude: Array, latitude: Array) -> NDArray[np.bool_]:
        """See `Basin`."""
        return np.asarray(latitude < -ON_THE_COAST)

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Zero: the velocity does not come from it."""
        return np.zeros(longitude.shape)

    def normal_velocity_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """The velocity at the middle of edges, m/s."""
        return normal_component(mesh, *self.evaluated_velocity(time)(mesh.lon_edge, mesh.lat_edge))


@dataclass(frozen=True)
class Seiche(Wave):
    """A free oscillation of the sea without rotation, whose surface is a spherical harmonic of degree n and order m.

    Where n + m is even its slope across the equator vanishes, so that a wall may stand there. The frequency is
    sqrt(n (n + 1) g H) / a.
    """

    name: ClassVar[str] = "seiche"
    title: ClassVar[str] = "Seiche of half a sphere"
    reference: ClassVar[str] = (
        "Longuet-Higgins (1968), Phil. Trans. R. Soc. A 262, 511-607, https://doi.org/10.1098/rsta.1968.0003"
    )
    recommended_days: ClassVar[float] = 10.0

    rotation_rate: float = parameter(0.0, "1/s", "Angular velocity of the sphere")
    degree: int = parameter(2, "", "Degree n of the spherical harmonic, 1 or more")
    order: int = parameter(0, "", "Order m of the spherical harmonic, 0 to n, even where n is even and odd where not")

    def __post_init__(self) -> None:
        super().__post_init__()
        n, m = self.degree, self.order
        if not (0 <= m <= n <= HIGHEST_DEGREE and n > 0 and (n + m) % 2 == 0):
            raise InputError(
                f"degree and order are {n} and {m}; give a degree from 1 to {HIGHEST_DEGREE} and an order up to it, "
                "both even or both odd"
            )

    @property
    def has_exact_solution(self) -> bool:
        """Only without rotation."""
        return self.rotation_rate == 0.0

    @property
    def frequency(self) -> float:
        """Of the oscillation, rad/s."""
        return math.sqrt(self.degree * (self.degree + 1)) * self.speed / self.radius

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """The surface is at rest, and as high as it gets, at the start."""
        return self.depth + math.cos(self.frequency * time) * self.highest(longitude, latitude)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """What the slope of the surface has accelerated by then."""
        eastward, northward = gradient(self.highest, longitude, latitude)
        size = -self.gravity * math.sin(self.frequency * time) / (self.frequency * self.radius)
        return size * eastward, size * northward

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Zero: the flow is a gradient."""
        return np.zeros(longitude.shape)

    def highest(self, longitude: Array, latitude: Array) -> Array:
        """Height of the surface at the start, m."""
        largest = np.abs(lpmv(self.order, self.degree, np.linspace(0.0, 1.0, SAMPLES))).max()
        shape = lpmv(self.order, self.degree, np.sin(latitude)) * np.cos(self.order * longitude)
        return np.asarray(self.amplitude / largest * shape)


@dataclass(frozen=True)
class KelvinWave(Wave):
    """A wave that the Coriolis force holds at the equator, as a coast: eastward, at the speed c = sqrt(g H) there.

    The Coriolis parameter f is everywhere that of the pole. With the depth H cos(lat)^2 the wave keeps its shape on the
    sphere too: E(lat) cos(k lon - k c t / a), with E = exp(-f a y / c) and y = artanh(sin(lat)). No fluid crosses
    circles of latitude. Where the wave has died out, north of 60 degrees, the depth is H / 4.
    """

    name: ClassVar[str] = "kelvin-wave"
    title: ClassVar[str] = "Kelvin wave along a coast at the equator"
    reference: ClassVar[str] = (
        "Thomson (1880), Phil. Mag. 10, 109-116; Hsieh et al. (1983), J. Phys. Oceanogr. 13, 1383-1397, "
        "https://doi.org/10.1175/1520-0485(1983)013<1383:TFKWIF>2.0.CO;2"
    )
    recommended_days: ClassVar[float] = 5.0

    wave_number: int = parameter(4, "", "Number k of waves round the equator, 1 or more")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("wave_number", "rotation_rate")

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """That of the pole."""
        return np.full(longitude.shape, 2.0 * self.rotation_rate)

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Zero at the equator, and rising towards the pole."""
        return self.depth * np.minimum(np.sin(latitude) ** 2, 0.75)

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """From the bottom to the surface."""
        return self.depth - self.topography(longitude, latitude) + self._height(longitude, latitude, time)

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Along circles of latitude, in phase with the height of the surface."""
        height = self._height(longitude, latitude, time)
        return self.gravity * height / (self.speed * np.cos(latitude)), np.zeros(longitude.shape)

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """As the wave loses strength with the distance from the coast."""
        height = self._height(longitude, latitude, time)
        return 2.0 * self.rotation_rate * height / (self.depth * np.cos(latitude) ** 2)

    def _height(self, longitude: Array, latitude: Array, time: float) -> Array:
        """Height of the surface, m."""
        rate = 2.0 * self.rotation_rate * self.radius / self.speed
        # exp(-rate artanh(s)), which holds at the pole too
        s = np.sin(latitude)
        strength = ((1.0 - s) / (1.0 + s)) ** (0.5 * rate)
        phase = self.wave_number * (longitude - self.speed * time / self.radius)
        return self.amplitude * strength * np.cos(phase)

"""What a test case is: documented parameters and pure functions of position and time."""

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import ClassVar

import numpy as np

from mesh.arrays import Array
from mesh.operators import normal_velocity_from_streamfunction
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import EARTH_RADIUS, GRAVITY, ROTATION_RATE
from swe.state import State


@dataclass(frozen=True)
class Case(ABC):
    """A shallow-water test case on a rotating sphere; longitudes and latitudes in radians.

    `name` is what the user types, `reference` the paper, `recommended_days` how long the paper runs it.
    `has_exact_solution` tells whether `thickness` and `streamfunction` hold at any time or at time zero only.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    reference: ClassVar[str]
    recommended_days: ClassVar[float]
    has_exact_solution: ClassVar[bool] = False

    radius: float = EARTH_RADIUS
    """Radius of the sphere, m."""

    gravity: float = GRAVITY
    """Acceleration of gravity, m/s2."""

    rotation_rate: float = ROTATION_RATE
    """Angular velocity of the sphere, 1/s."""

    @abstractmethod
    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Thickness of the fluid, m, at `time` seconds."""

    @abstractmethod
    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Streamfunction psi, m2/s, at `time` seconds; the velocity is k x grad(psi)."""

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Height of the bottom, m; flat unless the case says otherwise."""
        return np.zeros(np.broadcast_shapes(longitude.shape, latitude.shape))

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """Coriolis parameter, 1/s, of rotation about the polar axis."""
        return 2.0 * self.rotation_rate * np.sin(latitude) + 0.0 * longitude

    def state_on(self, mesh: VoronoiMesh, time: float = 0.0) -> State:
        """State at `time` seconds on `mesh`: thickness at the centres, normal velocity from the streamfunction.

        The streamfunction is taken at vertices, so that the velocity has no discrete divergence.
        """
        streamfunction = self.streamfunction(mesh.lon_vertex, mesh.lat_vertex, time)
        return State(
            self.thickness(mesh.lon_cell, mesh.lat_cell, time),
            normal_velocity_from_streamfunction(mesh, streamfunction),
        )

    def initial_state(self, mesh: VoronoiMesh) -> State:
        """State at time zero on `mesh`, whose radius is that of the case."""
        return self.state_on(mesh)

    def topography_on(self, mesh: VoronoiMesh) -> Array:
        """Height of the bottom at cell centres (n_cells,), m."""
        return self.topography(mesh.lon_cell, mesh.lat_cell)

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices (n_vertices,), 1/s."""
        return self.coriolis(mesh.lon_vertex, mesh.lat_vertex)

    def parameters(self) -> dict[str, float]:
        """Parameters by name."""
        return asdict(self)

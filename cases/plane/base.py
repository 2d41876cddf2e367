"""What a test case on a plane is: functions of x and y, metres, and of time."""

from abc import abstractmethod
from dataclasses import asdict, dataclass, field
from typing import ClassVar

import numpy as np

from cases.base import Case, parameter
from mesh.arrays import Array
from mesh.discrete.operators import normal_component
from mesh.discrete.walls import wall_edges
from mesh.integrals.quadrature import Sampling, sample_cells
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.state import State


@dataclass(frozen=True)
class PlaneCase(Case):
    """A shallow-water test case on an f-plane or a beta-plane: f = f0 + beta y.

    It is a `Case` whose positions are x and y, in metres, in the place of longitude and latitude; its radius is zero.
    A case must define `thickness`, `velocity`, `vorticity`, `title` and `recommended_days`. Its velocity need not come
    from a streamfunction, and so is given at the middles of edges.
    """

    _bounded: ClassVar[tuple[str, ...]] = ("gravity",)

    radius: float = field(default=0.0, init=False)
    rotation_rate: float = field(default=0.0, init=False)
    coriolis_parameter: float = parameter(1e-4, "1/s", "Coriolis parameter f0 at y = 0")
    beta: float = parameter(0.0, "1/(m s)", "Change of the Coriolis parameter with y")

    @abstractmethod
    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Velocity along x and along y, m/s, at `time` seconds."""

    @abstractmethod
    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Relative vorticity, 1/s, at `time` seconds."""

    def streamfunction(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Zero: the velocity does not come from it."""
        return np.zeros(x.shape)

    def coriolis(self, x: Array, y: Array) -> Array:
        """Coriolis parameter, 1/s."""
        return self.coriolis_parameter + self.beta * y

    def require_mesh(self, mesh: VoronoiMesh) -> None:
        """Raise `InputError` unless the case can be run on this mesh, which is on a plane; any will do by default."""

    def state_on(self, mesh: VoronoiMesh, time: float = 0.0, sampling: Sampling = "point") -> State:
        """See `Case`; the velocity is that at the middles of edges, and nothing flows through walls.

        Raises `InputError` if the mesh is on a sphere.
        """
        if mesh.on_a_sphere:
            raise InputError(f"{self.name} needs a mesh on a plane (trisk mesh --plane), and this one is on a sphere")
        self.require_mesh(mesh)
        along, across = self.evaluated_velocity(time)(*mesh.coordinates("edge"))
        velocity = normal_component(mesh, along, across)
        velocity[wall_edges(mesh)] = 0.0
        return State(sample_cells(mesh, self.evaluated(self.thickness, time), sampling), velocity)

    def parameters(self) -> dict[str, float]:
        """Parameters by name; a plane has no radius, and no axis about which it turns."""
        return {name: value for name, value in asdict(self).items() if name not in ("radius", "rotation_rate")}

"""What a test case on a plane is: functions of x and y, metres, and of time."""

from abc import abstractmethod
from dataclasses import asdict, dataclass, field
from typing import ClassVar

import numpy as np

from cases.base import Case, parameter
from mesh.arrays import Array
from mesh.discrete.operators import normal_velocity_from_streamfunction
from mesh.discrete.walls import wall_edges
from mesh.integrals.quadrature import Sampling, normal_means, sample_cells
from mesh.shown import Rows, in_words
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.state import State


@dataclass(frozen=True)
class PlaneCase(Case):
    """A shallow-water test case on an f-plane or a beta-plane: f = f0 + beta y.

    It is a `Case` whose positions are x and y, in metres, in the place of longitude and latitude; its radius is zero.
    A case must define `thickness`, `velocity`, `vorticity`, `title` and `recommended_days`. Its velocity need not come
    from a streamfunction; on a mesh it is the mean over each Voronoi edge, or what the case makes of it.
    """

    _bounded: ClassVar[tuple[str, ...]] = ("gravity",)

    periodic: ClassVar[str] = "xy"
    """Directions in which the plane of the case repeats itself: "xy", "x" or "none"."""

    radius: float = field(default=0.0, init=False)
    rotation_rate: float = field(default=0.0, init=False)
    coriolis_parameter: float = parameter(1e-4, "1/s", "Coriolis parameter f0 at y = 0")
    beta: float = parameter(0.0, "1/(m s)", "Change of the Coriolis parameter with y")

    def _title_and_rows(self) -> tuple[str, Rows]:
        """See `Case`, without what a plane has not."""
        title, rows = super()._title_and_rows()
        told = {name: value for name, value in rows.items() if name != "sphere"}
        return title, told | {"gravity": in_words(self.gravity, "m/s2")}

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
        """See `Case`; the velocity is that of `normal_velocity_on`, and nothing flows through walls.

        Raises `InputError` if the mesh is on a sphere.
        """
        if mesh.on_a_sphere:
            raise InputError(f"{self.name} needs a mesh on a plane (trisk mesh --plane), and this one is on a sphere")
        self.require_mesh(mesh)
        velocity = self.normal_velocity_on(mesh, time)
        velocity[wall_edges(mesh)] = 0.0
        return State(sample_cells(mesh, self.evaluated(self.thickness, time), sampling), velocity)

    def normal_velocity_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """Velocity at `time` along the normals of edges (n_edges,), m/s: its means over the Voronoi edges.

        So are the differences of a streamfunction.
        """
        return normal_means(mesh, self.evaluated_velocity(time))

    def parameters(self) -> dict[str, float]:
        """Parameters by name; a plane has no radius, and no axis about which it turns."""
        return {name: value for name, value in asdict(self).items() if name not in ("radius", "rotation_rate")}


@dataclass(frozen=True)
class ExactCase(PlaneCase):
    """A case on a plane whose solution is known on an f-plane; norms are those of the departure from the depth."""

    depth: float = parameter(100.0, "m", "Depth H of the fluid at rest")

    @property
    def has_exact_solution(self) -> bool:
        """Yes on an f-plane; in waves, but for terms of the square of the amplitude."""
        return self.beta == 0.0

    @property
    def background_depth(self) -> float:
        """The depth."""
        return self.depth


@dataclass(frozen=True)
class StreamfunctionCase(PlaneCase):
    """A case on a plane whose flow does not diverge: its velocity on a mesh comes from the streamfunction at vertices.

    A case must define `streamfunction` in addition.
    """

    @abstractmethod
    def streamfunction(self, x: Array, y: Array, time: float = 0.0) -> Array:
        """Streamfunction psi, m2/s, at `time` seconds; the velocity is k x grad(psi)."""

    def normal_velocity_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """Velocity at `time` along the normals of edges (n_edges,), m/s, that does not diverge."""
        return normal_velocity_from_streamfunction(mesh, self.streamfunction_on(mesh, time))

    def streamfunction_on(self, mesh: VoronoiMesh, time: float) -> Array:
        """Streamfunction at `time` at vertices (n_vertices,), m2/s."""
        return self.evaluated(self.streamfunction, time)(*mesh.coordinates("vertex"))

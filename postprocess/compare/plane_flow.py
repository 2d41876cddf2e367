"""A smooth flow on a plane, known exactly, that repeats itself as the plane does, for truncation errors.

    psi = cos(k x) sin(2 l y) + sin(k x + l y)        chi = sin(k x) cos(l y)        u = k x grad(psi) + grad(chi)

One wave of k and of l fits the plane: its period, or its extent where it has none.
"""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh


@dataclass(frozen=True)
class PlaneFlow:
    """The flow with the wave numbers `k` and `l`, rad/m, as functions of points (n, 3) of the plane."""

    k: float
    l: float  # noqa: E741

    def streamfunction(self, points: Array) -> Array:
        """Streamfunction psi (n,)."""
        x, y = self._phases(points)
        return np.cos(x) * np.sin(2.0 * y) + np.sin(x + y)

    def streamfunction_gradient(self, points: Array) -> Array:
        """Gradient (n, 3) of psi."""
        x, y = self._phases(points)
        along = self.k * (np.cos(x + y) - np.sin(x) * np.sin(2.0 * y))
        across = self.l * (np.cos(x + y) + 2.0 * np.cos(x) * np.cos(2.0 * y))
        return np.stack([along, across, np.zeros(len(x))], axis=1)

    def velocity(self, points: Array) -> Array:
        """Velocity (n, 3)."""
        x, y = self._phases(points)
        slope = self.streamfunction_gradient(points)
        along = self.k * np.cos(x) * np.cos(y) - slope[:, 1]
        across = slope[:, 0] - self.l * np.sin(x) * np.sin(y)
        return np.stack([along, across, np.zeros(len(x))], axis=1)

    def vorticity(self, points: Array) -> Array:
        """Relative vorticity (n,), the Laplacian of psi."""
        x, y = self._phases(points)
        k2, l2 = self.k**2, self.l**2
        return -(k2 + 4.0 * l2) * np.cos(x) * np.sin(2.0 * y) - (k2 + l2) * np.sin(x + y)

    def divergence(self, points: Array) -> Array:
        """Divergence (n,), the Laplacian of chi."""
        x, y = self._phases(points)
        return -(self.k**2 + self.l**2) * np.sin(x) * np.cos(y)

    def _phases(self, points: Array) -> tuple[Array, Array]:
        return self.k * points[:, 0], self.l * points[:, 1]


def plane_flow(mesh: VoronoiMesh) -> PlaneFlow:
    """The flow that fits the plane of a mesh."""
    lengths = (
        period or float(np.ptp(vertices))
        for period, vertices in ((mesh.x_period, mesh.x_vertex), (mesh.y_period, mesh.y_vertex))
    )
    return PlaneFlow(*(2.0 * np.pi / length for length in lengths))

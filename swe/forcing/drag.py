"""Drag of the bottom, linear or quadratic in the velocity."""

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import closed_mesh
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.kernels import kinetic_energy
from swe.equations.terms import Forcing
from swe.forcing import kernels
from swe.forcing.places import coefficient
from swe.state import State


class LinearDrag(Forcing):
    """Rayleigh friction, du/dt = -r u, with the `rate` r, 1/s; raises `InputError` where that is negative."""

    def __init__(self, rate: float, name: str = "linear_drag") -> None:
        super().__init__(name, acceleration=self._acceleration)
        self.rate = coefficient("the rate of the drag", rate)

    def _acceleration(self, mesh: VoronoiMesh, state: State, time: float) -> Array:
        return -self.rate * state.normal_velocity


class QuadraticDrag(Forcing):
    """Drag of a rough bottom, du/dt = -C abs(u) u / h, with C, the `drag_coefficient`, without units.

    The speed at an edge is that of the kinetic energy of its two cells, abs(u)^2 = K_1 + K_2, with K of Ringler et al.
    (2010) whatever the scheme. Raises `InputError` where the coefficient is negative.
    """

    def __init__(self, drag_coefficient: float, name: str = "quadratic_drag") -> None:
        super().__init__(name, acceleration=self._acceleration)
        self.drag_coefficient = coefficient("the drag coefficient", drag_coefficient)

    def _acceleration(self, mesh: VoronoiMesh, state: State, time: float) -> Array:
        closed, u = closed_mesh(mesh), state.normal_velocity
        energy, result = np.empty(mesh.n_cells), np.empty(mesh.n_edges)
        kinetic_energy(
            u, closed.n_edges_on_cell, closed.edges_on_cell, closed.dc_edge, closed.dv_edge, closed.area_cell, energy
        )
        kernels.quadratic_drag(self.drag_coefficient, state.thickness, u, energy, closed.cells_on_edge, result)
        return result

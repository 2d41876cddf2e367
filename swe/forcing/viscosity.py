"""Laplacian viscosity, du/dt = A lap u, with the discrete Laplacian of `swe.equations.dissipation`."""

from copy import copy
from typing import Self

import numpy as np

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.terms import Forcing
from swe.forcing.places import OncePerMesh, coefficient
from swe.state import State


class Viscosity(Forcing):
    """Laplacian viscosity, du/dt = A lap u = A [grad(div u) + k x grad(curl u)], with the `viscosity` A, m2/s.

    At a wall the vorticity is that of a fluid which slips along it as that of the model does (`at_walls`). Raises
    `InputError` where the viscosity is negative.
    """

    def __init__(self, viscosity: float, name: str = "viscosity") -> None:
        super().__init__(name, acceleration=self._acceleration)
        self.viscosity = coefficient("the viscosity", viscosity)
        self._wall_slip, self._operator = 0.0, self._operators(0.0)

    def at_walls(self, wall_slip: float) -> Self:
        """See `Term`; another term where the slip is another one, as models may share this one."""
        if wall_slip == self._wall_slip:
            return self
        term = copy(self)
        term._wall_slip, term._operator = wall_slip, term._operators(wall_slip)
        term.acceleration = term._acceleration
        return term

    def _operators(self, wall_slip: float) -> OncePerMesh[BiharmonicDissipation]:
        return OncePerMesh(lambda mesh: BiharmonicDissipation(mesh, self.viscosity, wall_slip))

    def stable_step(self, mesh: VoronoiMesh) -> float:
        """See `Forcing`: 2 / (A L), where L bounds the eigenvalues of lap, about 24 / d^2 for cells d apart.

        All integrators stand 2.5 / (A L).
        """
        rate = self.viscosity * self._operator(mesh).largest_eigenvalue
        return 2.0 / rate if rate > 0.0 else float("inf")

    def _acceleration(self, mesh: VoronoiMesh, state: State, time: float) -> Array:
        result = np.empty(mesh.n_edges)
        self._operator(mesh).laplacian(state.normal_velocity, result)
        result *= self.viscosity
        return result

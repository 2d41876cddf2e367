"""Laplacian viscosity, du/dt = A lap u, with the discrete Laplacian of `swe.equations.dissipation`."""

import numpy as np

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.forcing.places import OncePerMesh, coefficient
from swe.state import State


class Viscosity(Forcing):
    """Laplacian viscosity, du/dt = A lap u = A [grad(div u) + k x grad(curl u)], with the `viscosity` A, m2/s.

    At a wall the vorticity is that of a fluid with `wall_slip` along it, from 0 (none) to 1 (free); give the same
    to the run. Raises `InputError` where the viscosity is negative, or the slip is not from 0 to 1.
    """

    def __init__(self, viscosity: float, name: str = "viscosity", wall_slip: float = 0.0) -> None:
        super().__init__(name, acceleration=self._acceleration)
        self.viscosity = coefficient("the viscosity", viscosity)
        self.wall_slip = coefficient("the slip along walls", wall_slip)
        if self.wall_slip > 1.0:
            raise InputError(f"the slip along walls is {self.wall_slip:g}; it must be a number from 0 to 1")
        self._operator = OncePerMesh(lambda mesh: BiharmonicDissipation(mesh, self.viscosity, self.wall_slip))

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

"""Stress of the wind on the surface, du/dt = tau / (rho h)."""

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import normal_component
from mesh.discrete.walls import closed_mesh
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.terms import Forcing
from swe.forcing import kernels
from swe.forcing.places import Field, OncePerMesh, coefficient, require_field, sampled
from swe.state import State

SEA_WATER = 1025.0
"""Density of sea water, kg/m3."""


class WindStress(Forcing):
    """Stress of a steady wind, spread over the depth of the layer: du/dt = tau / (rho h).

    Parameters
    ----------
    eastward, northward
        Components of the stress tau on the fluid, N/m2, positive towards the east and the north: numbers, or functions
        of longitude and latitude, radians, or of x and y, metres, on a plane.
    density
        Density rho of the fluid, kg/m3.
    name
        Its name in the diagnostics.

    Raises
    ------
    InputError
        If the density is not positive, or a stress is neither a finite number nor a function.
    """

    def __init__(self, eastward: Field, northward: Field = 0.0, density: float = SEA_WATER, name: str = "wind") -> None:
        super().__init__(name, acceleration=self._acceleration)
        require_field("the eastward stress", eastward)
        require_field("the northward stress", northward)
        self.eastward, self.northward = eastward, northward
        self.density = coefficient("the density", density, positive=True)
        self._along_normals = OncePerMesh(self._stress_along_normals)

    def _stress_along_normals(self, mesh: VoronoiMesh) -> Array:
        """The stress over the density, along the normals of edges (n_edges,), m2/s2."""
        east, north = (sampled(part, *mesh.coordinates("edge")) for part in (self.eastward, self.northward))
        return normal_component(mesh, east, north) / self.density

    def _acceleration(self, mesh: VoronoiMesh, state: State, time: float) -> Array:
        result = np.empty(mesh.n_edges)
        kernels.over_thickness(self._along_normals(mesh), state.thickness, closed_mesh(mesh).cells_on_edge, result)
        return result

"""Anticipation of potential vorticity (Sadourny and Basdevant 1985): potential enstrophy decays, energy stays."""

from typing import Any

from mesh.arrays import Array
from mesh.discrete.operators import vertex_to_cell
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import kernels
from swe.equations.terms import Term
from swe.state import State


class Anticipation(Term):
    """The Coriolis flux carries q_e - seconds (u . grad q)_e, the value that the flow brings within `seconds`."""

    name = "anticipation"
    meaning = "by the anticipation of potential vorticity"
    changes = ("potential_enstrophy",)
    rings = 3  # it takes gradients of the mean of q over cells beyond the neighbours

    def __init__(self, mesh: VoronoiMesh, seconds: float) -> None:
        self.seconds = seconds
        self._mesh = mesh

    def change_vorticity(self, state: State, potential_vorticity: Array, at_edges: Array) -> None:
        """See `Term`."""
        kernels.anticipate(*by_gradient(self._mesh, state, potential_vorticity, self.seconds, at_edges))


def by_gradient(
    mesh: VoronoiMesh, state: State, potential_vorticity: Array, number: float, at_edges: Array
) -> tuple[Any, ...]:
    """What kernels take that change potential vorticity at edges by its gradient, as much as a `number` says."""
    return (
        state.normal_velocity,
        potential_vorticity,
        vertex_to_cell(mesh, potential_vorticity),
        number,
        mesh.cells_on_edge,
        mesh.vertices_on_edge,
        mesh.n_edges_on_edge,
        mesh.edges_on_edge,
        mesh.weights_on_edge,
        mesh.dc_edge,
        mesh.dv_edge,
        at_edges,
    )

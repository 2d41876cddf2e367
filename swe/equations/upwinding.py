"""Upwinding of potential vorticity: potential enstrophy decays at a rate that does not depend on the time step.

The velocity (u_n, u_t) at an edge reaches back to the ellipse through the two cells and the two vertices of the edge,
whose half-axes are d/2 and l/2. The value there, by the differences across and along the edge, is

    q_e - 1/2 (a delta_n q + b delta_t q) / sqrt(a^2 + b^2),    a = l u_n,  b = d u_t

which is that of the cell or the vertex upstream where the flow is across or along the edge, and depends on the
direction of the flow alone, without a jump but where nothing moves. So it is the anticipated potential vorticity
(`swe.equations.anticipation`) of half the time in which the flow passes the edge. Weller (2012), Controlling the
computational modes of the arbitrarily structured C grid, shows how interpolation that is biased upwind controls
oscillations of q at the grid scale, and proposes one whose bias depends on the direction of the flow to the edge; this
one is simpler, and of first order.
"""

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import kernels
from swe.equations.anticipation import by_gradient
from swe.equations.terms import Term
from swe.state import State


class Upwinding(Term):
    """The Coriolis flux carries q_e blended towards the value upstream, by a `factor` from 0 to 1.

    It does no work, as the flux weights the values of two edges symmetrically.
    """

    name = "upwinding"
    meaning = "by the upwinding of potential vorticity"
    changes = ("potential_enstrophy",)
    rings = 3  # as for anticipation

    def __init__(self, mesh: VoronoiMesh, factor: float) -> None:
        self.factor = factor
        self._mesh = mesh

    def change_vorticity(self, state: State, potential_vorticity: Array, at_edges: Array) -> None:
        """See `Term`."""
        kernels.blend_upwind(*by_gradient(self._mesh, state, potential_vorticity, self.factor, at_edges))

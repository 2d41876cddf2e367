"""Schemes: the kinetic energy of the cells, and the mass flux that is the derivative of the total energy.

With E = sum_i A_i (h_i K_i + g h_i (h_i/2 + b_i)), the bracket that all schemes share (continuity, Coriolis flux and
gradient, see `swe.equations.model`) conserves E for any K that is a quadratic form in u, provided that the flux is its
companion, F_e = 1/(l_e d_e) dE/du_e.
"""

from collections.abc import Callable
from dataclasses import dataclass

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import kernels


@dataclass(frozen=True)
class Scheme:
    """A scheme by its `name`; `source` says where it comes from and what it conserves.

    `kinetic_energy(mesh, u, K)` writes K at cells (n_cells,), m2/s2, from the normal velocity u at edges (n_edges,),
    m/s. `flux(mesh, h, u, F)` writes F at edges (n_edges,), m2/s, from u and the thickness h at cells, m.
    """

    name: str
    source: str
    kinetic_energy: Callable[[VoronoiMesh, Array, Array], None]
    flux: Callable[[VoronoiMesh, Array, Array, Array], None]


def _kinetic_energy(mesh: VoronoiMesh, u: Array, K: Array) -> None:
    """K_i = 1/A_i sum_e (1/4) l_e d_e u_e^2: Ringler et al. (2010), equation (63)."""
    kernels.kinetic_energy(u, mesh.n_edges_on_cell, mesh.edges_on_cell, mesh.dc_edge, mesh.dv_edge, mesh.area_cell, K)


def _flux(mesh: VoronoiMesh, h: Array, u: Array, F: Array) -> None:
    """F_e = (h_1 + h_2)/2 u_e."""
    kernels.thickness_flux(h, u, mesh.cells_on_edge, F)


RINGLER2010 = Scheme(
    "ringler2010",
    "Thuburn et al. (2009) and Ringler et al. (2010), conserving energy",
    _kinetic_energy,
    _flux,
)
"""The only scheme whose steps are also fused (`swe.tiles`)."""

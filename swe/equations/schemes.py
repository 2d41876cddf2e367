"""Schemes: the kinetic energy of the cells, and the mass flux that is the derivative of the total energy.

With E = sum_i A_i (h_i K_i + g h_i (h_i/2 + b_i)), the bracket that all schemes share (continuity, Coriolis flux and
gradient, see `swe.equations.model`) conserves E for any K that is a quadratic form in u, provided that the flux is its
companion, F_e = 1/(l_e d_e) dE/du_e. `docs/scheme.md` derives this.
"""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import closed_mesh
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import energy_along, kernels
from swe.equations.measures import Measures
from swe.state import State


class Scheme(ABC):
    """Kinetic energy and flux on one mesh, in metres; cells may be missing beyond its edges.

    Attributes
    ----------
    name
        What the user calls it.
    source
        Where it comes from.
    rings
        How many rings of cells must stand round those of a process for its tendencies to be right: see
        `swe.run.composition.rings_needed`.
    mesh
        The mesh as loops read it (`mesh.discrete.walls.closed_mesh`).
    """

    name: ClassVar[str]
    source: ClassVar[str]
    rings: ClassVar[int] = 2

    def __init__(self, mesh: VoronoiMesh) -> None:
        self.mesh = closed_mesh(mesh)

    @abstractmethod
    def kinetic_energy(self, u: Array, K: Array) -> None:
        """Write K at cells (n_cells,), m2/s2, from the normal velocity u at edges (n_edges,), m/s."""

    @abstractmethod
    def flux(self, h: Array, u: Array, F: Array) -> None:
        """Write F at edges (n_edges,), m2/s, from the thickness h at cells, m, and u; zero at walls."""

    def energy_along(
        self,
        state: State,
        after: State,
        height: Array,
        gravity: float,
        measures: Measures,
        folds: tuple[Array, Array],
        parts: Array,
    ) -> None:
        """Write parts (blocks, 3, 3) of the coefficients of c, c^2 and c^3 of the energy between two states.

        The energy is that of state + c (after - state), less that of `state`, with potential energy measured from where
        the `height` of the bottom (n_cells,), m, is zero. `measures` say which entities count, and `folds` are the
        coarse and fine ones of the three sums.
        """
        u, u_after = state.normal_velocity, after.normal_velocity
        energies = np.empty((3, self.mesh.n_cells))
        for velocity, K in zip((u, u_after, u_after - u), energies, strict=True):
            self.kinetic_energy(velocity, K)
        K, K_after, K_increment = energies
        h, h_after, (coarse, fine) = state.thickness, after.thickness, folds
        energy_along.sum_over_cells(
            h, h_after, K, K_after, K_increment, height, gravity, measures.area_cell, coarse, fine, parts
        )


class Ringler2010(Scheme):
    """K_i = 1/A_i sum_e (1/4) l_e d_e u_e^2, Ringler et al. (2010), equation (63), and F_e = (h_1 + h_2)/2 u_e."""

    name = "ringler2010"
    source = "Thuburn et al. (2009) and Ringler et al. (2010), conserving energy"

    def kinetic_energy(self, u: Array, K: Array) -> None:
        """See `Scheme`."""
        mesh = self.mesh
        kernels.kinetic_energy(
            u, mesh.n_edges_on_cell, mesh.edges_on_cell, mesh.dc_edge, mesh.dv_edge, mesh.area_cell, K
        )

    def flux(self, h: Array, u: Array, F: Array) -> None:
        """See `Scheme`."""
        kernels.thickness_flux(h, u, self.mesh.cells_on_edge, F)

    def energy_along(
        self,
        state: State,
        after: State,
        height: Array,
        gravity: float,
        measures: Measures,
        folds: tuple[Array, Array],
        parts: Array,
    ) -> None:
        """See `Scheme`; faster, as the kinetic energy is a sum over edges."""
        coarse, fine = folds
        energy_along.sum_over_edges(
            state.thickness,
            state.normal_velocity,
            after.thickness,
            after.normal_velocity,
            height,
            gravity,
            measures.area_cell,
            measures.half_edge_area,
            self.mesh.cells_on_edge,
            coarse,
            fine,
            parts,
        )

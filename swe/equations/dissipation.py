"""Biharmonic dissipation of velocity, du/dt = -nu lap(lap u), with lap u = grad(div u) + k x grad(curl u)."""

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import circulation_signs, closed_mesh, wall_edges
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import kernels
from swe.equations.terms import Term
from swe.state import State


class BiharmonicDissipation(Term):
    """Dissipation with the `coefficient` nu, m4/s, after each step, so that the effect of each on energy is known.

    On the mesh lap is symmetric in the inner product sum_e l_e d_e u_e v_e, so the acceleration -nu lap(lap u)
    removes energy, nu sum_e l_e d_e (lap u)_e^2 per unit thickness. Mass and absolute vorticity are conserved. Like its
    parts, curl and gradient, lap is consistent in the mean over neighbours, not at every edge. At walls its curl has
    their `wall_slip`, as that of the model: with free slip no stress acts there.
    """

    name = "dissipation"
    meaning = "by biharmonic dissipation"
    changes = ("total_energy", "potential_enstrophy", "absolute_vorticity")
    rings = 3  # the second Laplacian takes divergences of cells beyond the neighbours
    after_steps = True

    def __init__(self, mesh: VoronoiMesh, coefficient: float, wall_slip: float = 0.0) -> None:
        self.coefficient, self.wall_slip = coefficient, wall_slip
        self._circulation_signs = circulation_signs(mesh, wall_slip)
        self._mesh, self._closed, self._walls = mesh, closed_mesh(mesh), wall_edges(mesh)
        self._divergence = np.empty(mesh.n_cells)
        self._vorticity = np.empty(mesh.n_vertices)
        self._once, self._twice = np.empty(mesh.n_edges), np.empty(mesh.n_edges)

    def acceleration(self, velocity: Array) -> Array:
        """-nu lap(lap u) at edges (n_edges,), m/s2; the next call overwrites the array."""
        self.laplacian(velocity, self._once)
        self.laplacian(self._once, self._twice)
        self._twice *= -self.coefficient
        return self._twice

    def add(self, mesh: VoronoiMesh, state: State, time: float, tendency: State) -> None:
        """See `Term`."""
        tendency.normal_velocity[:] += self.acceleration(state.normal_velocity)

    def apply(self, state: State, time_step: float) -> None:
        """See `Term`."""
        velocity = state.normal_velocity
        kernels.add_scaled(velocity, time_step, self.acceleration(velocity), velocity)

    @property
    def largest_time_step(self) -> float:
        """Longest stable time step, s: 2 / (nu L^2), where L bounds the eigenvalues of lap."""
        rate = self.coefficient * self.largest_eigenvalue**2
        return 2.0 / rate if rate > 0.0 else float("inf")

    @property
    def largest_eigenvalue(self) -> float:
        """A bound L on the eigenvalues of lap, 1/m2, by their magnitude.

        By Gershgorin's theorem the gradient of divergence is at most 2 sum_e l_e / (d_e A_i) at any cell, and that of
        curl at most 2 sum_e d_e / (l_e A_v) at any vertex; where one of them acts, the other vanishes. Walls, where
        nothing moves, have no part in it.
        """
        mesh = self._closed
        flow, circulation = mesh.dv_edge / mesh.dc_edge, mesh.dc_edge / mesh.dv_edge
        flow[self._walls] = circulation[self._walls] = 0.0
        at_cells = np.where(mesh.on_ring, flow[mesh.edges_on_cell], 0.0).sum(axis=1) / mesh.area_cell
        shares = np.abs(self._circulation_signs)
        at_vertices = (shares * circulation[mesh.edges_on_vertex]).sum(axis=1) / mesh.area_triangle
        return 2.0 * max(float(at_cells.max()), float(at_vertices.max()))

    def laplacian(self, velocity: Array, result: Array) -> None:
        """Write lap u at edges (n_edges,), 1/(m s), into `result`; zero at walls."""
        mesh = self._closed
        kernels.thickness_tendency(
            velocity,
            mesh.n_edges_on_cell,
            mesh.edges_on_cell,
            self._mesh.edge_signs_on_cell,
            mesh.dv_edge,
            mesh.area_cell,
            self._divergence,
        )
        kernels.relative_vorticity(
            velocity,
            mesh.edges_on_vertex,
            self._circulation_signs,
            mesh.dc_edge,
            mesh.area_triangle,
            self._vorticity,
        )
        kernels.vector_laplacian(
            self._divergence,
            self._vorticity,
            mesh.cells_on_edge,
            mesh.vertices_on_edge,
            mesh.dc_edge,
            mesh.dv_edge,
            result,
        )
        result[self._walls] = 0.0

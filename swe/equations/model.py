"""The equations on one mesh: everything that the tendency and the diagnostics need, apart from any clock."""

import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import vertex_to_cell
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations import kernels
from swe.errors import InputError
from swe.parallel.exact_sum import exact_sum
from swe.state import State

STABLE_COURANT_NUMBER = 2.0 / 3.0**0.5
"""Linear gravity waves on regular hexagons are stable under classical RK4 up to here, see `courant_number`."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """Fields that follow from a state: vorticities at vertices, 1/s and 1/(m s), kinetic energy at cells, m2/s2."""

    relative_vorticity: Array
    potential_vorticity: Array
    kinetic_energy: Array


class ShallowWaterModel:
    """The rotating shallow-water equations over topography on a mesh in metres.

    Parameters
    ----------
    mesh
        Voronoi mesh, scaled to the radius of the sphere (`VoronoiMesh.scaled`).
    topography
        Height of the bottom at cells (n_cells,), m.
    coriolis
        Coriolis parameter at vertices (n_vertices,), 1/s.
    gravity
        Acceleration of gravity, m/s2.
    prescribed_wind
        Whether the velocity stays as it is, so that thickness is advected and there are no gravity waves.

    Attributes
    ----------
    anticipation
        Seconds by which the tendency anticipates potential vorticity, q_e - anticipation (u . grad q)_e in the Coriolis
        force (Sadourny and Basdevant 1985); 0 but for a model made by `anticipating`.
    sign_on_vertex, sign_on_cell
        Signs of circulations round vertices and of outflows of cells, see `kernels.edge_signs_on_vertex` and
        `kernels.edge_signs_on_cell`.
    area, bottom_volume, planetary_vorticity_magnitude
        Area of the sphere, m2, integral of the topography, m3, and that of the magnitude of the Coriolis parameter,
        m2/s.

    Raises
    ------
    InputError
        Where a field has the wrong shape or type or is not finite.
    """

    def __init__(
        self, mesh: VoronoiMesh, topography: Array, coriolis: Array, gravity: float, prescribed_wind: bool = False
    ) -> None:
        check_field("topography", topography, mesh.n_cells)
        check_field("coriolis", coriolis, mesh.n_vertices)
        self.mesh = mesh
        self.topography = topography
        self.coriolis = coriolis
        self.gravity = gravity
        self.prescribed_wind = prescribed_wind
        self._anticipation = 0.0
        self.area = exact_sum(mesh.area_cell)
        self.bottom_volume = exact_sum(mesh.area_cell * topography)
        self.planetary_vorticity_magnitude = exact_sum(mesh.area_triangle * np.abs(coriolis))
        self.sign_on_vertex = kernels.edge_signs_on_vertex(mesh)
        self._vorticity = np.empty(mesh.n_vertices)
        self._potential_vorticity = np.empty(mesh.n_vertices)
        self._kinetic_energy = np.empty(mesh.n_cells)

    @property
    def anticipation(self) -> float:
        """Seconds by which the tendency anticipates potential vorticity."""
        return self._anticipation

    def anticipating(self, seconds: float) -> "ShallowWaterModel":
        """The same model, with the same arrays, where potential vorticity is anticipated by so many seconds."""
        other = copy.copy(self)
        other._anticipation = seconds
        return other

    # The plain tendency alone needs these; a run takes the fused path and saves their memory.

    @cached_property
    def sign_on_cell(self) -> Array:
        """Signs of outflows of cells (n_cells, max_edges)."""
        return kernels.edge_signs_on_cell(self.mesh)

    @cached_property
    def _thickness_flux(self) -> Array:
        return np.empty(self.mesh.n_edges)

    @cached_property
    def _potential_vorticity_edge(self) -> Array:
        return np.empty(self.mesh.n_edges)

    def tendency(self, state: State, result: State) -> None:
        """Write the time derivative of `state` into `result`; allocates nothing after the first time."""
        self._update_thickness_tendency(state, result)
        if self.prescribed_wind:
            result.normal_velocity.fill(0.0)
        else:
            self._update_velocity_tendency(state, result)

    def _update_thickness_tendency(self, state: State, result: State) -> None:
        mesh, F = self.mesh, self._thickness_flux
        kernels.thickness_flux(state.thickness, state.normal_velocity, mesh.cells_on_edge, F)
        kernels.thickness_tendency(
            F,
            mesh.n_edges_on_cell,
            mesh.edges_on_cell,
            self.sign_on_cell,
            mesh.dv_edge,
            mesh.area_cell,
            result.thickness,
        )

    def _update_velocity_tendency(self, state: State, result: State) -> None:
        """Write the time derivative of velocity; the flux of thickness is there already."""
        mesh, q_edge = self.mesh, self._potential_vorticity_edge
        self._update_vorticity(state)
        kernels.mean_of_vertices(self._potential_vorticity, mesh.vertices_on_edge, q_edge)
        if self.anticipation > 0.0:
            self._anticipate(state, q_edge)
        self._update_kinetic_energy(state)
        kernels.velocity_tendency(
            state.thickness,
            self.topography,
            self._kinetic_energy,
            self._thickness_flux,
            q_edge,
            self.gravity,
            mesh.cells_on_edge,
            mesh.n_edges_on_edge,
            mesh.edges_on_edge,
            mesh.weights_on_edge,
            mesh.dc_edge,
            result.normal_velocity,
        )

    def _anticipate(self, state: State, q_edge: Array) -> None:
        """Take what is anticipated from `q_edge`; potential vorticity at vertices is there already."""
        mesh, q = self.mesh, self._potential_vorticity
        kernels.anticipate(
            state.normal_velocity,
            q,
            vertex_to_cell(mesh, q),
            self.anticipation,
            mesh.cells_on_edge,
            mesh.vertices_on_edge,
            mesh.n_edges_on_edge,
            mesh.edges_on_edge,
            mesh.weights_on_edge,
            mesh.dc_edge,
            mesh.dv_edge,
            q_edge,
        )

    def anticipated_acceleration(self, state: State) -> Array:
        """What the anticipation adds to the Coriolis force at edges (n_edges,), m/s2."""
        mesh, F = self.mesh, self._thickness_flux
        kernels.thickness_flux(state.thickness, state.normal_velocity, mesh.cells_on_edge, F)
        self._update_vorticity(state)
        q_edge, nothing, result = np.zeros(mesh.n_edges), np.zeros(mesh.n_cells), np.empty(mesh.n_edges)
        self._anticipate(state, q_edge)
        kernels.velocity_tendency(
            nothing,
            nothing,
            nothing,
            F,
            q_edge,
            0.0,
            mesh.cells_on_edge,
            mesh.n_edges_on_edge,
            mesh.edges_on_edge,
            mesh.weights_on_edge,
            mesh.dc_edge,
            result,
        )
        return result

    def diagnose(self, state: State) -> Diagnosis:
        """Fields that follow from `state`, as new arrays."""
        self._update_vorticity(state)
        self._update_kinetic_energy(state)
        return Diagnosis(
            relative_vorticity=self._vorticity.copy(),
            potential_vorticity=self._potential_vorticity.copy(),
            kinetic_energy=self._kinetic_energy.copy(),
        )

    def courant_number(self, state: State, time_step: float) -> float:
        """Largest (sqrt(g h) + |u|) dt / d over all edges, d the distance between the cells.

        Linear gravity waves on regular hexagons are stable under classical RK4 up to 2 / sqrt(3), as the largest
        frequency is sqrt(6 g h)/d and the limit of RK4 on the imaginary axis 2 sqrt(2). Under a prescribed wind,
        which has no waves, it is the largest |u| dt / d.
        """
        if not np.isfinite(state.normal_velocity).all():
            return float("nan")
        mesh, waves = self.mesh, not self.prescribed_wind
        return time_step * kernels.largest_rate(
            state.thickness, state.normal_velocity, self.gravity, waves, mesh.cells_on_edge, mesh.dc_edge
        )

    def _update_vorticity(self, state: State) -> None:
        mesh = self.mesh
        kernels.relative_vorticity(
            state.normal_velocity,
            mesh.edges_on_vertex,
            self.sign_on_vertex,
            mesh.dc_edge,
            mesh.area_triangle,
            self._vorticity,
        )
        kernels.potential_vorticity(
            state.thickness,
            self._vorticity,
            self.coriolis,
            mesh.cells_on_vertex,
            mesh.kite_areas_on_vertex,
            mesh.area_triangle,
            self._potential_vorticity,
        )

    def _update_kinetic_energy(self, state: State) -> None:
        mesh = self.mesh
        kernels.kinetic_energy(
            state.normal_velocity,
            mesh.n_edges_on_cell,
            mesh.edges_on_cell,
            mesh.dc_edge,
            mesh.dv_edge,
            mesh.area_cell,
            self._kinetic_energy,
        )


def check_field(name: str, values: Array, size: int) -> None:
    """Raise `InputError` where `values` are not `size` finite numbers of double precision."""
    if not isinstance(values, np.ndarray):
        raise InputError(f"{name} is {type(values).__name__}; it must be an array of {size} numbers")
    if values.shape != (size,):
        raise InputError(f"{name} has shape {values.shape}, but the mesh needs ({size},)")
    if values.dtype != np.float64:
        raise InputError(f"{name} has numbers of type {values.dtype}; it must have float64")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise InputError(f"{name} is {values[wrong[0]]} at entity {wrong[0]} (counted from 0); it must be finite")

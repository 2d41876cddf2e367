"""The equations on one mesh: everything that the tendency and the diagnostics need, apart from any clock."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array, Index
from mesh.discrete.walls import circulation_signs, closed_mesh, wall_edges
from mesh.shown import Rows, Shown, in_words, span
from mesh.voronoi_mesh import VoronoiMesh, coast_in_words, mesh_in_words
from swe.equations import kernels
from swe.equations.measures import measures_of
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.terms import Forcing, Term
from swe.errors import InputError
from swe.parallel.processes import ONE_PROCESS, Processes
from swe.state import State

ENTITIES_PER_CELL = 16
"""An upper bound on cells, edges and vertices together per cell: 6 on a sphere, 13 for a single hexagon."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """Fields that follow from a state: vorticities at vertices, 1/s and 1/(m s), kinetic energy at cells, m2/s2."""

    relative_vorticity: Array
    potential_vorticity: Array
    kinetic_energy: Array


class ShallowWaterModel(Shown):
    """The rotating shallow-water equations over topography on a mesh in metres.

    The tendency is the bracket that all schemes share, with the kinetic energy and the flux of the `scheme`,

        dh_i/dt = -1/A_i sum_e n_ei l_e F_e,      du_e/dt = Q_e - 1/d_e [g (h + b) + K]_1^2,

    plus the sum of the `terms`.

    Parameters
    ----------
    mesh
        Voronoi mesh, scaled to the radius of the sphere (`VoronoiMesh.scaled`). Cells may be missing beyond its edges
        (`mesh.discrete.walls`): nothing flows there, and a state must have zero velocity there.
    topography
        Height of the bottom at cells (n_cells,), m.
    coriolis
        Coriolis parameter at vertices (n_vertices,), 1/s.
    gravity
        Acceleration of gravity, m/s2.
    prescribed_wind
        Whether the velocity stays fixed, so that thickness is advected and there are no gravity waves.
    scheme
        Kinetic energy and mass flux.
    terms
        Terms added to the bracket, such as `Anticipation`, `BiharmonicDissipation` or a user's own `Forcing`.
    processes
        The processes that share the mesh.
    wall_slip
        Slip along walls, from 0 (no slip) to 1 (free slip, no relative vorticity at coasts); see `docs/scheme.md`.

    Attributes
    ----------
    closed
        The mesh as the loops read it, see `mesh.discrete.walls.closed_mesh`.
    measures
        Sizes of the entities over which integrals are taken, see `swe.equations.measures`.
    area, bottom_volume, planetary_vorticity_magnitude
        Area of the mesh of all processes, m2, integral of the topography, m3, and that of the magnitude of the Coriolis
        parameter, m2/s.
    cells, entities
        Number of cells of all processes, and an upper bound on that of cells, edges and vertices together.

    Raises
    ------
    InputError
        If a field has the wrong shape or type or is not finite, two terms share a name, or a term accelerates a
        prescribed wind.
    """

    def __init__(
        self,
        mesh: VoronoiMesh,
        topography: Array,
        coriolis: Array,
        gravity: float,
        prescribed_wind: bool = False,
        scheme: type[Scheme] = Ringler2010,
        terms: Sequence[Term] = (),
        processes: Processes = ONE_PROCESS,
        wall_slip: float = 0.0,
    ) -> None:
        check_field("topography", topography, mesh.n_cells)
        check_field("coriolis", coriolis, mesh.n_vertices)
        for name, count in Counter(term.name for term in terms).items():
            if count > 1:
                raise InputError(f"{count} terms of the model are named {name}; give each its own name")
        accelerating = [term.name for term in terms if "absolute_vorticity" in term.changes]
        if prescribed_wind and accelerating:
            raise InputError(f"the wind is prescribed, but the term {accelerating[0]} accelerates it; leave it out")
        self.mesh = mesh
        self.topography = topography
        self.coriolis = coriolis
        self.gravity = gravity
        self.prescribed_wind = prescribed_wind
        self.scheme = scheme(mesh)
        self.terms = tuple(term.at_walls(wall_slip) for term in terms)
        self.processes = processes
        self.wall_slip = wall_slip
        self.closed = closed_mesh(mesh)
        self._circulation_signs = circulation_signs(mesh, wall_slip)
        self.measures = measures_of(self.closed, self._circulation_signs, processes.own)
        areas, counted = self.measures.area_cell, np.zeros(mesh.n_cells)
        counted[processes.own.cells] = 1.0
        self.area, self.bottom_volume, cells = processes.exact_sums(np.stack([areas, areas * topography, counted]))
        (self.planetary_vorticity_magnitude,) = processes.exact_sums(
            (self.measures.area_triangle * np.abs(coriolis))[None]
        )
        self.cells = int(cells)
        self.entities = ENTITIES_PER_CELL * self.cells
        self._vorticity = np.empty(mesh.n_vertices)
        self._potential_vorticity = np.empty(mesh.n_vertices)
        self._kinetic_energy = np.empty(mesh.n_cells)

    def _title_and_rows(self) -> tuple[str, Rows]:
        rows = {
            "mesh": mesh_in_words(self.mesh),
            "coast": coast_in_words(self.mesh),
            "wall slip": in_words(self.wall_slip) if self.wall_slip else "",
            "scheme": in_words(getattr(self.scheme, "name", type(self.scheme).__name__)),
            "terms": in_words(", ".join(term.name for term in self.terms)),
            "wind": "prescribed, only thickness evolves" if self.prescribed_wind else "",
            "gravity": in_words(self.gravity, "m/s2"),
            "topography": span(self.topography, "m"),
            "coriolis": span(self.coriolis, "1/s"),
        }
        return "ShallowWaterModel", rows

    @property
    def forcings(self) -> tuple[Forcing, ...]:
        """Terms that a case has declared."""
        return tuple(term for term in self.terms if isinstance(term, Forcing))

    @property
    def terms_in_stages(self) -> tuple[Term, ...]:
        """Terms that are part of the tendency."""
        return tuple(term for term in self.terms if not term.after_steps)

    @property
    def terms_after_steps(self) -> tuple[Term, ...]:
        """Terms that act after each step."""
        return tuple(term for term in self.terms if term.after_steps)

    # Only the plain tendency needs these; a run on the fused path saves their memory.

    @cached_property
    def _thickness_flux(self) -> Array:
        return np.empty(self.mesh.n_edges)

    @cached_property
    def _potential_vorticity_edge(self) -> Array:
        return np.empty(self.mesh.n_edges)

    def tendency(self, state: State, result: State, time: float = 0.0) -> None:
        """Write the time derivative of `state` at `time`, s, into `result`: the bracket and the terms in stages.

        Allocates nothing after the first call, except what the terms allocate.
        """
        self._update_flux(state)
        self._update_thickness_tendency(result.thickness)
        self._update_velocity_tendency(state, result.normal_velocity)
        for term in self.terms_in_stages:
            self.add_term(term, state, time, result)

    def thickness_tendency(self, state: State, result: Array, time: float = 0.0) -> None:
        """Write dh/dt (n_cells,), m/s, of `state` at `time`, s, into `result`: one half of `tendency`."""
        self._update_flux(state)
        self._update_thickness_tendency(result)
        for term in self.terms_in_stages:
            term.add_source(self.mesh, state, time, result)

    def velocity_tendency(self, state: State, result: Array, time: float = 0.0) -> None:
        """Write du/dt (n_edges,), m/s2, of `state` at `time`, s, into `result`: the other half of `tendency`."""
        self._update_flux(state)
        self._update_velocity_tendency(state, result)
        for term in self.terms_in_stages:
            term.add_acceleration(self.mesh, state, time, result)
        result[self._walls] = 0.0

    def tendency_of(self, term: Term, state: State, time: float = 0.0) -> State:
        """The tendency of `state` at `time`, s, due to `term` alone, as a new state per second."""
        mesh, result = self.mesh, State(np.zeros(self.mesh.n_cells), np.zeros(self.mesh.n_edges))
        self._update_vorticity(state)
        q_edge, nothing = np.zeros(mesh.n_edges), np.zeros(mesh.n_cells)
        term.change_vorticity(state, self._potential_vorticity, q_edge)
        if q_edge.any():
            self._update_flux(state)
            self._update_velocity(nothing, nothing, nothing, q_edge, 0.0, result.normal_velocity)
        self.add_term(term, state, time, result)
        return result

    def add_term(self, term: Term, state: State, time: float, result: State) -> None:
        """Add `term` at `state` and `time`, s, to the tendency `result`; nothing accelerates at walls."""
        term.add(self.mesh, state, time, result)
        result.normal_velocity[self._walls] = 0.0

    @cached_property
    def _walls(self) -> Index:
        return wall_edges(self.mesh)

    def _update_flux(self, state: State) -> None:
        self.scheme.flux(state.thickness, state.normal_velocity, self._thickness_flux)

    def _update_thickness_tendency(self, result: Array) -> None:
        """Write the time derivative of thickness; the thickness flux has been computed already."""
        mesh = self.closed
        kernels.thickness_tendency(
            self._thickness_flux,
            mesh.n_edges_on_cell,
            mesh.edges_on_cell,
            self.mesh.edge_signs_on_cell,
            mesh.dv_edge,
            mesh.area_cell,
            result,
        )

    def _update_velocity_tendency(self, state: State, result: Array) -> None:
        """Write the time derivative of velocity; the thickness flux has been computed already."""
        if self.prescribed_wind:
            result.fill(0.0)
            return
        q_edge = self._potential_vorticity_edge
        self._update_vorticity(state)
        kernels.mean_of_vertices(self._potential_vorticity, self.mesh.vertices_on_edge, q_edge)
        for term in self.terms_in_stages:
            term.change_vorticity(state, self._potential_vorticity, q_edge)
        self._update_kinetic_energy(state)
        self._update_velocity(state.thickness, self.topography, self._kinetic_energy, q_edge, self.gravity, result)

    def _update_velocity(self, h: Array, b: Array, K: Array, q_edge: Array, gravity: float, result: Array) -> None:
        """Write the Coriolis flux of the thickness flux minus the gradient of g (h + b) + K."""
        mesh = self.closed
        kernels.velocity_tendency(
            h,
            b,
            K,
            self._thickness_flux,
            q_edge,
            gravity,
            mesh.cells_on_edge,
            mesh.n_edges_on_edge,
            mesh.edges_on_edge,
            mesh.weights_on_edge,
            mesh.dc_edge,
            result,
        )
        result[self._walls] = 0.0  # where the difference of a cell and itself leaves round-off

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
        """See `courant_number`."""
        return courant_number(self.closed, state, self.gravity, self.prescribed_wind, time_step, self.processes)

    def _update_vorticity(self, state: State) -> None:
        mesh = self.closed
        kernels.relative_vorticity(
            state.normal_velocity,
            mesh.edges_on_vertex,
            self._circulation_signs,
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
        self.scheme.kinetic_energy(state.normal_velocity, self._kinetic_energy)


def courant_number(
    mesh: VoronoiMesh,
    state: State,
    gravity: float,
    prescribed_wind: bool,
    time_step: float,
    processes: Processes = ONE_PROCESS,
) -> float:
    """Largest (sqrt(g h) + |u|) dt / d over all edges of all `processes`, d the distance between the cells.

    The largest frequency of linear gravity waves on regular hexagons is sqrt(6 g h)/d; `swe.integrators` says how long
    a step each integrator stands. Under a prescribed wind, which has no waves, it is the largest |u| dt / d. `mesh`
    must have no gaps (`closed_mesh`).
    """
    own = processes.own.edges
    u, largest = state.normal_velocity[own], float("nan")
    if np.isfinite(u).all():
        largest = time_step * kernels.largest_rate(
            state.thickness, u, gravity, not prescribed_wind, mesh.cells_on_edge[own], mesh.dc_edge[own]
        )
    return float(processes.largest(np.array([largest]))[0])


def check_field(name: str, values: Array, size: int) -> None:
    """Raise `InputError` unless `values` are `size` finite numbers of double precision."""
    if not isinstance(values, np.ndarray):
        raise InputError(f"{name} is {type(values).__name__}; it must be an array of {size} numbers")
    if values.shape != (size,):
        raise InputError(f"{name} has shape {values.shape}, but the mesh needs ({size},)")
    if values.dtype != np.float64:
        raise InputError(f"{name} has numbers of type {values.dtype}; it must have float64")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise InputError(f"{name} is {values[wrong[0]]} at entity {wrong[0]} (counted from 0); it must be finite")

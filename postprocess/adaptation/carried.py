"""A case that goes on from a state which another mesh has reached."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import velocity_at_cells
from mesh.discrete.walls import wall_edges
from mesh.integrals.quadrature import Sampling
from mesh.overlap.overlaps import Overlaps, overlaps_of
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.remap import remap_cells
from swe.constants import SECONDS_PER_DAY
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.run.case import Case
from swe.state import State

SAME_AREA = 1e-9
"""Relative difference of two areas that is round-off alone."""


@dataclass(frozen=True, eq=False)
class Continued:
    """`case` from the `first_day` on, with the `state` that it has there on the mesh to run on, in SI units."""

    case: Case
    first_day: float
    state: State

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.case.name

    @property
    def radius(self) -> float:
        """Radius of the sphere, m."""
        return self.case.radius

    @property
    def gravity(self) -> float:
        """Acceleration of gravity, m/s2."""
        return self.case.gravity

    @property
    def prescribed_wind(self) -> bool:
        """Whether the wind stays as it was at the start."""
        return self.case.prescribed_wind

    def initial_state(self, mesh: VoronoiMesh, sampling: Sampling) -> State:
        """The state that was carried over; raises `InputError` for any mesh of other size than it was made for."""
        sizes = len(self.state.thickness), len(self.state.normal_velocity)
        if sizes != (mesh.n_cells, mesh.n_edges):
            raise InputError(
                f"the state carried over has {sizes[0]} cells and {sizes[1]} edges, the mesh {mesh.n_cells} and "
                f"{mesh.n_edges}; carry it over to this mesh"
            )
        return self.state.copy()

    def topography_on(self, mesh: VoronoiMesh, sampling: Sampling) -> Array:
        """Height of the bottom, m, as the case has it."""
        return self.case.topography_on(mesh, sampling)

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices, 1/s, as the case has it."""
        return self.case.coriolis_on(mesh)

    def parameters(self) -> dict[str, float]:
        """Parameters of the case, and the day on which it goes on."""
        return {**self.case.parameters(), "first_day": self.first_day}

    def terms(self) -> tuple[Forcing, ...]:
        """The terms that the case adds, at their own times."""
        added: Callable[[], tuple[Forcing, ...]] = getattr(self.case, "terms", tuple)
        return tuple(_later(term, self.first_day * SECONDS_PER_DAY) for term in added())


def _later(term: Forcing, seconds: float) -> Forcing:
    """A term whose time zero is `seconds` later."""

    def shifted(function: Callable[..., Array] | None) -> Callable[..., Array] | None:
        return None if function is None else lambda mesh, state, time: function(mesh, state, time + seconds)

    return Forcing(term.name, shifted(term.acceleration), shifted(term.source))


def carried_over(case: Case, state: State, source: VoronoiMesh, target: VoronoiMesh, sampling: Sampling) -> State:
    """A `state` of `case` on the mesh `source`, in metres, on the mesh `target`.

    What is carried over is the surface h + b, by means over the cells of the target (`mesh.overlap`), so that a lake
    stays at rest whatever the bottom. The bottom of the target is that of the case, and the little by which the mass
    then differs is spread evenly: mass is the same to round-off. Where the two meshes do not cover the same area, as
    coasts of different spacing do not, the mean height of the surface is the same instead. Velocity vectors are fitted
    at the centres of the source's cells, taken at the target's edges, and nothing flows through its walls. Raises
    `InputError` where the bottom rises through the surface.
    """
    overlaps = overlaps_of(source, target)
    before = state.thickness + case.topography_on(source, sampling)
    bottom = case.topography_on(target, sampling)
    surface = overlaps.means(before)
    area, area_before = float(target.area_cell.sum()), float(source.area_cell.sum())
    if abs(area - area_before) <= SAME_AREA * area:
        missing = float(source.area_cell @ state.thickness) - float(target.area_cell @ (surface - bottom))
        surface += missing / area
    else:
        surface += float(source.area_cell @ before) / area_before - float(target.area_cell @ surface) / area
    thickness = surface - bottom
    lowest = int(np.argmin(thickness))
    if not thickness[lowest] > 0.0:
        raise InputError(
            f"the thickness carried over is {thickness[lowest]:.3g} m at cell {lowest}, where the bottom rises through "
            "the surface; use a finer mesh or a deeper bottom"
        )
    return State(thickness, _velocity_on(overlaps, state.normal_velocity, target))


def _velocity_on(overlaps: Overlaps, normal_velocity: Array, target: VoronoiMesh) -> Array:
    """Normal velocity (n_edges,) at the edges of the target, of the one at those of the source."""
    zonal, meridional = velocity_at_cells(overlaps.source, normal_velocity)
    at_edges = remap_cells(overlaps.source, target.lon_edge, target.lat_edge)
    east, north = at_edges.vector(zonal, meridional)
    velocity = np.cos(target.angle_edge) * east + np.sin(target.angle_edge) * north
    velocity[wall_edges(target)] = 0.0
    return velocity

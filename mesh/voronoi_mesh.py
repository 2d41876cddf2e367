"""The Voronoi mesh as data: connectivity and metrics, no computation beyond views, rescaling and words about it.

Names are those of the MPAS mesh specification in snake_case; `mesh.conventions` gives every array its
dimensions, units and meaning. In memory, indices count from 0 and -1 fills what a short ring leaves over.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, Signs
from mesh.errors import MeshError
from mesh.graphs import count_seas_and_coasts
from mesh.shown import Rows, Shown, in_kilometres, in_words
from mesh.validated import is_validated, remember_validated

Place = Literal["cell", "edge", "vertex"]


@dataclass(frozen=True, eq=False)
class Topology:
    """Which cells, edges and vertices touch; rings run counter-clockwise seen from outside.

    The normal of edge e points from `cells_on_edge[e, 0]` to `[e, 1]`, its tangent k x n from
    `vertices_on_edge[e, 0]` to `[e, 1]`. `vertices_on_cell[c, j]` lies between edges j and j + 1 of cell c, and
    `cells_on_vertex[v, j]` between edges j and j + 1 of vertex v. `edges_on_edge` goes round the first cell,
    starting after the edge itself, then round the second.
    """

    n_edges_on_cell: Index
    cells_on_cell: Index
    edges_on_cell: Index
    vertices_on_cell: Index
    n_edges_on_edge: Index
    edges_on_edge: Index
    cells_on_edge: Index
    vertices_on_edge: Index
    cells_on_vertex: Index
    edges_on_vertex: Index
    boundary_vertex: Index

    @property
    def n_cells(self) -> int:
        """Number of Voronoi cells."""
        return len(self.n_edges_on_cell)

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return len(self.cells_on_edge)

    @property
    def n_vertices(self) -> int:
        """Number of vertices, equal to that of Delaunay triangles."""
        return len(self.cells_on_vertex)

    @property
    def max_edges(self) -> int:
        """Width of the ring arrays: the largest number of edges of a cell, or more in files from other programs."""
        return self.edges_on_cell.shape[1]

    @property
    def on_ring(self) -> NDArray[np.bool_]:
        """Mask (n_cells, max_edges) of the entries of the cells' ring arrays that are not fill."""
        return np.arange(self.max_edges) < self.n_edges_on_cell[:, None]

    @cached_property
    def edge_signs_on_cell(self) -> Signs:
        """1 where the normal of `edges_on_cell[c, j]` leaves cell c, -1 where it enters, 0 beyond the ring.

        Also 0 where there is no cell on the other side: nothing flows through such an edge.
        """
        ends = self.cells_on_edge[np.where(self.on_ring, self.edges_on_cell, 0)]
        outward = np.where(ends[:, :, 0] == np.arange(self.n_cells)[:, None], 1, -1)
        return np.where(self.on_ring & (ends >= 0).all(axis=2), outward, 0).astype(np.int8)

    @cached_property
    def edge_signs_on_vertex(self) -> Signs:
        """1 where the normal of `edges_on_vertex[v, j]` runs counter-clockwise round v, else -1; 0 for no edge."""
        head = self.vertices_on_edge[self.edges_on_vertex, 1]
        around = np.where(head == np.arange(self.n_vertices)[:, None], 1, -1)
        return np.where(self.edges_on_vertex >= 0, around, 0).astype(np.int8)


@dataclass(frozen=True, eq=False)
class Metrics:
    """Positions and sizes of the entities: lengths in units of the sphere's radius as stored, angles in radians.

    On a plane lengths are in metres, z, longitudes and latitudes are zero, and angles count from the x axis.

    `kite_areas_on_vertex[v, j]` is the part of cell `cells_on_vertex[v, j]` in triangle v. The tangential velocity
    at edge e is the sum of `weights_on_edge[e, j]` times the normal velocity at `edges_on_edge[e, j]`.
    """

    lat_cell: Array
    lon_cell: Array
    x_cell: Array
    y_cell: Array
    z_cell: Array
    lat_edge: Array
    lon_edge: Array
    x_edge: Array
    y_edge: Array
    z_edge: Array
    lat_vertex: Array
    lon_vertex: Array
    x_vertex: Array
    y_vertex: Array
    z_vertex: Array
    dc_edge: Array
    dv_edge: Array
    angle_edge: Array
    area_cell: Array
    area_triangle: Array
    kite_areas_on_vertex: Array
    weights_on_edge: Array


@dataclass(frozen=True, eq=False, repr=False)
class VoronoiMesh(Shown, Metrics, Topology):
    """A Voronoi mesh with everything a C-grid scheme needs; see `Topology` and `Metrics`.

    It is on a sphere, or, with a `sphere_radius` of zero, on a plane that repeats itself after `x_period` and
    `y_period` metres, where these are not zero (`mesh.geometry.surface`).

    `mesh_density` holds the density at the centres; `density_name` says which one it is (see `mesh.density.named`)
    where that is known, and `density_source` where it is found (see `mesh.density.record`) where it comes from a file.
    `fixed_cells` (n_cells,) marks generators that were held while the others moved to their centroids, if any were.
    """

    mesh_density: Array
    sphere_radius: float
    density_name: str = ""
    density_source: str = ""
    fixed_cells: NDArray[np.bool_] | None = None
    x_period: float = 0.0
    y_period: float = 0.0

    def _title_and_rows(self) -> tuple[str, Rows]:
        rows = {
            "edges, vertices": f"{self.n_edges}, {self.n_vertices}",
            "surface": "" if self.on_a_sphere else surface_in_words(self),
            "radius": "" if not self.on_a_sphere or self.sphere_radius == 1.0 else in_kilometres(self.sphere_radius),
            "density": in_words(self.density_name),
            "spacing": _spacing_in_words(self),
            "sigma": _sigma_in_words(self),
            "irregular cells": f"{np.count_nonzero(self.n_edges_on_cell != 6)} with more or fewer than six edges",
            "coast": coast_in_words(self),
            "held": "" if self.fixed_cells is None else f"{np.count_nonzero(self.fixed_cells)} generators",
        }
        return f"VoronoiMesh of {self.n_cells} cells", rows

    @property
    def on_a_sphere(self) -> bool:
        """Whether the mesh is on a sphere, and not on a plane."""
        return self.sphere_radius > 0.0

    @property
    def length_unit(self) -> float:
        """What lengths are divided by for geometry: the radius of the sphere, one on a plane."""
        return self.sphere_radius if self.on_a_sphere else 1.0

    def coordinates(self, place: Place) -> tuple[Array, Array]:
        """What functions of the place take at all cells, edges or vertices: longitude and latitude, or x and y.

        Radians on a sphere, metres on a plane.
        """
        first, second = ("lon", "lat") if self.on_a_sphere else ("x", "y")
        return getattr(self, f"{first}_{place}"), getattr(self, f"{second}_{place}")

    def require_sphere(self, what: str) -> None:
        """Raise `MeshError` on a plane; `what` begins the sentence."""
        if not self.on_a_sphere:
            raise MeshError(f"{what} for meshes on a sphere alone, and this one is on a plane")

    @property
    def cell_points(self) -> Array:
        """Cell centres (n_cells, 3), in the units of `sphere_radius`."""
        return np.stack([self.x_cell, self.y_cell, self.z_cell], axis=1)

    @property
    def edge_points(self) -> Array:
        """Edge points (n_edges, 3), midway between the two cell centres, in the units of `sphere_radius`."""
        return np.stack([self.x_edge, self.y_edge, self.z_edge], axis=1)

    @property
    def vertex_points(self) -> Array:
        """Vertices (n_vertices, 3), in the units of `sphere_radius`."""
        return np.stack([self.x_vertex, self.y_vertex, self.z_vertex], axis=1)

    def scaled(self, radius: float) -> "VoronoiMesh":
        """The same mesh on a sphere of another radius, in metres.

        Raises `MeshError` on a plane, but for a radius of zero, which leaves the mesh as it is.
        """
        factor = scale_factor(self.sphere_radius, radius)
        if factor is None:
            return self
        lengths = {name: getattr(self, name) * factor for name in LENGTH_NAMES}
        areas = {name: getattr(self, name) * factor**2 for name in AREA_NAMES}
        scaled = replace(self, sphere_radius=float(radius), **lengths, **areas)
        if is_validated(self):
            remember_validated(scaled)
        return scaled


def scale_factor(old_radius: float, radius: float) -> float | None:
    """What lengths are multiplied by on a sphere of another radius; None on a plane, whose radius is zero.

    Raises `MeshError` where one is a plane and the other is not.
    """
    if (old_radius > 0.0) != (radius > 0.0):
        here, wanted = ("a sphere", "a plane") if old_radius > 0.0 else ("a plane", "a sphere")
        raise MeshError(f"the mesh is on {here}, but one on {wanted} is asked for; take another mesh")
    return radius / old_radius if old_radius > 0.0 else None


def mesh_in_words(mesh: VoronoiMesh) -> str:
    """Cells, mean spacing and sphere, for a line about what stands on the mesh."""
    spacing = _spacings(mesh)
    mean = f", mean spacing {_length(mesh, spacing.mean())}" if spacing.size else ""
    return f"{mesh.n_cells} cells on {surface_in_words(mesh)}{mean}"


def surface_in_words(mesh: VoronoiMesh) -> str:
    """What a mesh is on, as part of a sentence."""
    if mesh.on_a_sphere:
        return sphere_in_words(mesh.sphere_radius)
    periods = {"x": mesh.x_period, "y": mesh.y_period}
    repeated = " and ".join(f"{in_kilometres(period)} in {axis}" for axis, period in periods.items() if period > 0.0)
    return f"a plane that repeats itself after {repeated}" if repeated else "a plane"


def sphere_in_words(radius: float) -> str:
    """The unit sphere, or one with a radius in metres."""
    return "the unit sphere" if radius == 1.0 else f"a sphere of radius {in_kilometres(radius)}"


def coast_in_words(mesh: VoronoiMesh) -> str:
    """How many seas and coasts the mesh has and what share of the sphere it covers; empty if it has no coast."""
    if mesh.cells_on_edge.min(initial=0) >= 0:
        return ""
    at_boundary = mesh.cells_on_vertex.min(axis=1) < 0
    seas, coasts = count_seas_and_coasts(mesh.n_cells, mesh.cells_on_edge, mesh.vertices_on_edge, at_boundary)
    seas_in_words = "1 sea" if seas == 1 else f"{seas} seas"
    coasts_in_words = "1 coast" if coasts == 1 else f"{coasts} coasts"
    share = f"; {share_of_sphere(mesh.area_cell, mesh.sphere_radius)}" if mesh.on_a_sphere else ""
    return f"{seas_in_words}, {coasts_in_words}{share}"


def share_of_sphere(areas: Array, radius: float) -> str:
    """What share of a sphere cells with these areas (n,) cover, in words."""
    return f"the sea covers {100.0 * areas.sum() / (4.0 * np.pi * radius**2):.3g} % of the sphere"


def _spacings(mesh: VoronoiMesh) -> Array:
    """Distances between cells that are neighbours (n,), without those beyond walls, which are not there."""
    return mesh.dc_edge[mesh.cells_on_edge.min(axis=1) >= 0]


def _length(mesh: VoronoiMesh, length: float) -> str:
    return f"{length:.4g} radians" if mesh.sphere_radius == 1.0 else in_kilometres(length)


def _spacing_in_words(mesh: VoronoiMesh) -> str:
    spacing = _spacings(mesh)
    if not spacing.size:
        return ""
    mean, least, largest = (_length(mesh, each) for each in (spacing.mean(), spacing.min(), spacing.max()))
    return f"mean {mean}, least {least}, largest {largest}"


def _sigma_in_words(mesh: VoronoiMesh) -> str:
    """Mean and least sigma, as `mesh.discrete.quality` has them, from the distances that the mesh holds."""
    chords = np.sin(mesh.dc_edge / (2.0 * mesh.sphere_radius)) if mesh.on_a_sphere else mesh.dc_edge.copy()
    chords[mesh.cells_on_edge.min(axis=1) < 0] = np.nan
    shortest, longest = np.full((2, mesh.n_cells), np.nan)
    for place in range(mesh.max_edges):
        inside = place < mesh.n_edges_on_cell
        lengths = np.where(inside, chords[np.where(inside, mesh.edges_on_cell[:, place], 0)], np.nan)
        shortest, longest = np.fmin(shortest, lengths), np.fmax(longest, lengths)
    known = longest > 0.0
    sigma = shortest[known] / longest[known]
    if not sigma.size:
        return ""
    return f"mean {sigma.mean():.4f}, least {sigma.min():.4f} (shortest over longest distance to a neighbour)"


TOPOLOGY_NAMES = tuple(field.name for field in fields(Topology))
LENGTH_NAMES = (*(f"{axis}_{place}" for axis in "xyz" for place in ("cell", "edge", "vertex")), "dc_edge", "dv_edge")
AREA_NAMES = ("area_cell", "area_triangle", "kite_areas_on_vertex")
METRICS_NAMES = tuple(field.name for field in fields(Metrics))

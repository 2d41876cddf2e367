"""The discrete calculus of the C-grid as sparse matrices: one row per entity where the result lives.

Thickness-like fields live at cells, normal velocities at edges, vorticity-like fields at vertices. The matrices
are the plain statement of the operators; the solver's kernels are tested against them.
"""

from functools import cached_property

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from mesh.arrays import Array, Index
from mesh.discrete.sides import Sides, sides_of_cells
from mesh.discrete.walls import closed_mesh, shares_of_circulation
from mesh.geometry.surface import surface_of
from mesh.geometry.vectors import nearest_image
from mesh.shown import Rows, Shown, in_words
from mesh.voronoi_mesh import VoronoiMesh, coast_in_words, mesh_in_words


class Operators(Shown):
    """All operators of one mesh, each made when it is first asked for; apply them with `@`.

    They follow Ringler et al. (2010), by the numbers of their equations; across walls nothing flows and there is no
    gradient (`mesh.discrete.walls`). The vorticity at coasts is that of walls with `wall_slip`, from 0 to 1.
    """

    def __init__(self, mesh: VoronoiMesh, wall_slip: float = 0.0) -> None:
        self.mesh = closed_mesh(mesh)
        self._given = mesh
        self._wall_slip = wall_slip

    def _title_and_rows(self) -> tuple[str, Rows]:
        names = [name for name, value in vars(type(self)).items() if isinstance(value, cached_property)]
        made = [name for name in names if name in vars(self)]
        rows = {
            "mesh": mesh_in_words(self._given),
            "coast": coast_in_words(self._given),
            "wall slip": in_words(self._wall_slip) if self._wall_slip else "",
            "made": ", ".join(made),
            "made when asked for": ", ".join(name for name in names if name not in made),
        }
        return "Operators", rows

    @cached_property
    def divergence(self) -> csr_array:
        """(cells x edges), equation (21)."""
        mesh = self.mesh
        first, second = mesh.cells_on_edge.T
        return _scale_rows(
            1.0 / mesh.area_cell, _two_per_edge(first, second, mesh.dv_edge, -mesh.dv_edge, mesh.n_cells)
        )

    @cached_property
    def gradient(self) -> csr_array:
        """(edges x cells), equation (22)."""
        mesh = self.mesh
        first, second = mesh.cells_on_edge.T
        ones = np.ones(mesh.n_edges)
        return _scale_rows(1.0 / mesh.dc_edge, _two_per_edge(second, first, ones, -ones, mesh.n_cells).T)

    @cached_property
    def curl(self) -> csr_array:
        """(vertices x edges), equation (23)."""
        mesh = self.mesh
        tail, head = mesh.vertices_on_edge.T
        return _scale_rows(
            shares_of_circulation(self._given, self._wall_slip) / mesh.area_triangle,
            _two_per_edge(head, tail, mesh.dc_edge, -mesh.dc_edge, mesh.n_vertices),
        )

    @cached_property
    def perp(self) -> csr_array:
        """(edges x edges), from normal to tangential velocity, equation (24)."""
        mesh = self.mesh
        filled = np.arange(mesh.edges_on_edge.shape[1]) < mesh.n_edges_on_edge[:, None]
        starts = np.concatenate([[0], np.cumsum(mesh.n_edges_on_edge)])
        values, columns = mesh.weights_on_edge[filled], mesh.edges_on_edge[filled]
        rows = csr_array((values, columns, starts), shape=(mesh.n_edges, mesh.n_edges))
        rows.sum_duplicates()
        return rows

    @cached_property
    def kinetic_energy(self) -> csr_array:
        """(cells x edges), from squares of normal velocities, equation (63)."""
        mesh = self.mesh
        first, second = mesh.cells_on_edge.T
        # A wall, whose cells are one, has the share of one cell.
        quarter = np.where(first == second, 0.125, 0.25) * mesh.dv_edge * mesh.dc_edge
        return _scale_rows(1.0 / mesh.area_cell, _two_per_edge(first, second, quarter, quarter, mesh.n_cells))

    @cached_property
    def outward(self) -> csr_array:
        """(sides x edges), from velocities along the normals of edges to those out of each cell through its sides.

        The sides of cell c are `max_edges` rows from c times `max_edges` on; those beyond its last and walls are empty.
        """
        signs = self._given.edge_signs_on_cell
        edges = np.where(signs == 0, 0, self.mesh.edges_on_cell)
        places = (np.arange(signs.size), edges.ravel())
        return csr_array((signs.ravel().astype(float), places), shape=(signs.size, self.mesh.n_edges))

    @cached_property
    def sides(self) -> Sides:
        """Where neighbours and middles of sides lie, as the centres of the cells see them."""
        return sides_of_cells(self._given)

    @cached_property
    def cell_to_edge(self) -> csr_array:
        """(edges x cells), the mean of two."""
        first, second = self.mesh.cells_on_edge.T
        halves = np.full(self.mesh.n_edges, 0.5)
        return csr_array(_two_per_edge(first, second, halves, halves, self.mesh.n_cells).T)

    @cached_property
    def cell_to_vertex(self) -> csr_array:
        """(vertices x cells), weighted by kite areas, equation (25)."""
        mesh = self.mesh
        vertex = np.repeat(np.arange(mesh.n_vertices), 3)
        kites = (mesh.kite_areas_on_vertex.ravel(), (vertex, mesh.cells_on_vertex.ravel()))
        return _scale_rows(1.0 / mesh.area_triangle, coo_array(kites, shape=(mesh.n_vertices, mesh.n_cells)))

    @cached_property
    def vertex_to_edge(self) -> csr_array:
        """(edges x vertices), the mean of two."""
        mesh = self.mesh
        edge, (tail, head) = np.arange(mesh.n_edges), mesh.vertices_on_edge.T
        places = np.concatenate([edge, edge]), np.concatenate([tail, head])
        return csr_array(coo_array((np.full(2 * mesh.n_edges, 0.5), places), shape=(mesh.n_edges, mesh.n_vertices)))


def build_operators(mesh: VoronoiMesh, wall_slip: float = 0.0) -> Operators:
    """The operators of `mesh`, in the units of its radius, with a factor for the slip along walls (`Operators`)."""
    return Operators(mesh, wall_slip)


def _two_per_edge(rows_a: Array, rows_b: Array, values_a: Array, values_b: Array, n_rows: int) -> coo_array:
    """Matrix (n_rows, n_edges) with one entry for each end of every edge."""
    edge = np.arange(len(rows_a))
    return coo_array(
        (
            np.concatenate([values_a, values_b]),
            (np.concatenate([rows_a, rows_b]), np.concatenate([edge, edge])),
        ),
        shape=(n_rows, len(edge)),
    )


def _scale_rows(factors: Array, matrix: coo_array) -> csr_array:
    rows = csr_array(matrix)
    rows.data *= np.repeat(factors, np.diff(rows.indptr))
    return rows


VANISHING = 1e-9
"""Edges shorter than this part of the distance of their cells have no length but for round-off."""


def vanishing_edges(mesh: VoronoiMesh) -> Index:
    """Edges without length: their two triangles have one circumcircle, as the halves of a square do."""
    return np.flatnonzero(mesh.dv_edge <= VANISHING * mesh.dc_edge)


def normal_velocity_from_streamfunction(mesh: VoronoiMesh, streamfunction: Array) -> Array:
    """Normal component of k x grad(psi) at edges (n_edges,), from psi at vertices (n_vertices,).

    Minus the difference of psi along the tangent over `dv_edge`; its discrete divergence vanishes to round-off. Edges
    without length get the velocity that the other edges of their two cells have by least squares.
    """
    tail, head = mesh.vertices_on_edge.T
    none = vanishing_edges(mesh)
    length = mesh.dv_edge.copy()
    length[none] = np.inf
    velocity = -(streamfunction[head] - streamfunction[tail]) / length
    for edge in none:
        velocity[edge] = _velocity_of_neighbours(mesh, velocity, np.isfinite(length), edge)
    return velocity


def _velocity_of_neighbours(mesh: VoronoiMesh, velocity: Array, known: NDArray[np.bool_], edge: int) -> float:
    """The velocity along the normal of an edge, the mean of those of its two cells by least squares."""
    centers, surface = mesh.cell_points / mesh.length_unit, surface_of(mesh)
    normals = surface.shortest(centers[mesh.cells_on_edge[:, 1]] - centers[mesh.cells_on_edge[:, 0]])
    of_cells = []
    for cell in mesh.cells_on_edge[edge]:
        edges = mesh.edges_on_cell[cell, : mesh.n_edges_on_cell[cell]]
        edges = edges[known[edges]]
        units = normals[edges] / np.linalg.norm(normals[edges], axis=1)[:, None]
        # The normal of the surface, along which nothing moves, makes the solution one in the tangent plane.
        rows, values = np.vstack([units, surface.outward(centers[cell])]), np.append(velocity[edges], 0.0)
        of_cells.append(np.linalg.lstsq(rows, values, rcond=None)[0])
    unit = normals[edge] / np.linalg.norm(normals[edge])
    return float(np.mean(of_cells, axis=0) @ unit)


def velocity_at_cells(mesh: VoronoiMesh, normal_velocity: Array) -> tuple[Array, Array]:
    """Zonal and meridional velocity at cell centres (n_cells,), from normal velocities (n_edges,).

    On a plane they are along x and along y.

    Least squares over the edges of each cell, the edges' normals projected onto the cell's tangent plane:
    exact for a uniform flow in the plane. The normal of a wall points from the cell to the edge or back.
    """
    return _velocity_at_cells(
        normal_velocity,
        mesh.n_edges_on_cell,
        mesh.edges_on_cell,
        mesh.cells_on_edge,
        mesh.cell_points,
        mesh.edge_points,
        mesh.lon_cell,
        mesh.lat_cell,
        surface_of(mesh).periods,
        surface_of(mesh).is_flat,
    )


@numba.njit(cache=True)
def _end(points: Array, edge_points: Array, cell: int, edge: int, axis: int) -> float:
    """Coordinate of the centre of `cell`, or of the edge where there is none."""
    return points[cell, axis] if cell >= 0 else edge_points[edge, axis]


@numba.njit(cache=True, parallel=True)
def _velocity_at_cells(
    normal_velocity: Array,
    n_edges_on_cell: Index,
    edges_on_cell: Index,
    cells_on_edge: Index,
    points: Array,
    edge_points: Array,
    longitude: Array,
    latitude: Array,
    periods: Array,
    is_flat: bool,
) -> tuple[Array, Array]:
    zonal, meridional = np.empty(len(points)), np.empty(len(points))
    for c in numba.prange(len(points)):
        # The vectors of `mesh.geometry.sphere.east_north`, without arrays of them.
        sin_lon, cos_lon, sin_lat = np.sin(longitude[c]), np.cos(longitude[c]), np.sin(latitude[c])
        cos_lat = np.cos(latitude[c])
        ee = en = nn = right_east = right_north = 0.0
        for j in range(n_edges_on_cell[c]):
            edge = edges_on_cell[c, j]
            first, second = cells_on_edge[edge, 0], cells_on_edge[edge, 1]
            x = _end(points, edge_points, second, edge, 0) - _end(points, edge_points, first, edge, 0)
            y = _end(points, edge_points, second, edge, 1) - _end(points, edge_points, first, edge, 1)
            z = _end(points, edge_points, second, edge, 2) - _end(points, edge_points, first, edge, 2)
            if is_flat:
                x, y, z = nearest_image((x, y, z), periods)
            length = np.sqrt(x * x + y * y + z * z)
            eastward = (cos_lon * y - sin_lon * x) / length
            northward = (cos_lat * z - sin_lat * (cos_lon * x + sin_lon * y)) / length
            if is_flat:
                eastward, northward = x / length, y / length
            ee += eastward * eastward
            en += eastward * northward
            nn += northward * northward
            right_east += eastward * normal_velocity[edge]
            right_north += northward * normal_velocity[edge]
        determinant = ee * nn - en * en
        zonal[c] = (nn * right_east - en * right_north) / determinant
        meridional[c] = (ee * right_north - en * right_east) / determinant
    return zonal, meridional


def normal_component(mesh: VoronoiMesh, zonal: Array | float, meridional: Array | float) -> Array:
    """Components along the normals (n_edges,) of vectors at edges, from the eastward and northward ones.

    Each is one number for all edges, or one for each (n_edges,).
    """
    return zonal * np.cos(mesh.angle_edge) + meridional * np.sin(mesh.angle_edge)


def vertex_to_cell(mesh: VoronoiMesh, values: Array) -> Array:
    """Kite-weighted mean (n_cells,) of values at the vertices (n_vertices,) of each cell."""
    return _vertex_to_cell(
        values,
        mesh.n_edges_on_cell,
        mesh.vertices_on_cell,
        mesh.cells_on_vertex,
        mesh.kite_areas_on_vertex,
        mesh.area_cell,
    )


@numba.njit(cache=True, parallel=True)
def _vertex_to_cell(
    values: Array,
    n_edges_on_cell: Index,
    vertices_on_cell: Index,
    cells_on_vertex: Index,
    kite_areas_on_vertex: Array,
    area_cell: Array,
) -> Array:
    means = np.empty(len(area_cell))
    for c in numba.prange(len(area_cell)):
        total = 0.0
        for j in range(n_edges_on_cell[c]):
            v = vertices_on_cell[c, j]
            for k in range(3):
                if cells_on_vertex[v, k] == c:
                    total += kite_areas_on_vertex[v, k] * values[v]
        means[c] = total / area_cell[c]
    return means

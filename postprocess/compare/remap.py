"""Fields of a mesh at any points of its surface, by a quadratic fit round the nearest cell centre or vertex.

On the tangent plane of that site the field is its value there plus a x + b y + c x^2 + d xy + e y^2, fitted to the
neighbours by least squares: at the site itself the value is kept, and elsewhere the error of a smooth field is of
third order in the mesh spacing, one order better than the scheme's own. The map is linear in the values, hence a
sparse matrix that is made once and applied to any number of fields.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array

from mesh.arrays import Array, Index
from mesh.geometry.sphere import dot
from mesh.geometry.surface import Surface, surface_of
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.places import nearest_sites, points_at

N_TERMS = 5
"""Coefficients of a quadratic polynomial in two variables without its constant; as many neighbours are needed."""

SMALLEST_SINGULAR_VALUE = 0.01
"""Of a fit, relative to the largest one: what is smaller is left out, lest nearly degenerate rings magnify noise."""


@dataclass(frozen=True)
class Remap:
    """Map of fields from the sites of a mesh to other points; see `remap_cells` and `remap_vertices`.

    `matrix` is (n_points, n_sites); longitudes and latitudes of sites and points are in radians. On a plane, here and
    below, x and y in metres take their place, and components along x and y that of zonal and meridional ones.
    """

    surface: Surface
    matrix: csr_array
    from_longitude: Array
    from_latitude: Array
    to_longitude: Array
    to_latitude: Array

    def scalar(self, values: Array) -> Array:
        """Values (n_points,) of a field given at the sites (n_sites,)."""
        return self.matrix @ values

    def vector(self, zonal: Array, meridional: Array) -> tuple[Array, Array]:
        """Zonal and meridional components (n_points,) of a vector field given by those at the sites (n_sites,).

        Remapped through Cartesian components, which unlike the others are smooth at the poles.
        """
        east, north = self.surface.axes(self.from_longitude, self.from_latitude)
        vectors = self.matrix @ (zonal[:, None] * east + meridional[:, None] * north)
        east, north = self.surface.axes(self.to_longitude, self.to_latitude)
        return dot(vectors, east), dot(vectors, north)


def remap_cells(mesh: VoronoiMesh, longitude: Array, latitude: Array) -> Remap:
    """Map from the cell centres of `mesh` to points at `longitude` and `latitude` (n_points,), radians."""
    ring = np.where(mesh.on_ring, mesh.cells_on_cell, -1)
    return _remap(surface_of(mesh), mesh.coordinates("cell"), ring, longitude, latitude)


def remap_vertices(mesh: VoronoiMesh, longitude: Array, latitude: Array) -> Remap:
    """Map from the vertices of `mesh` to points at `longitude` and `latitude` (n_points,), radians.

    A fit to vertices of its own, over two rings of neighbours: the kite-weighted mean over cells would smooth the
    field first, an error of second order like those that are to be measured.
    """
    across = mesh.vertices_on_edge[mesh.edges_on_vertex].sum(axis=2) - np.arange(mesh.n_vertices)[:, None]
    ring = np.where(mesh.edges_on_vertex < 0, -1, across)
    return _remap(surface_of(mesh), mesh.coordinates("vertex"), ring, longitude, latitude)


def _remap(surface: Surface, from_places: tuple[Array, Array], ring: Index, longitude: Array, latitude: Array) -> Remap:
    """Map from sites, whose neighbours are `ring` (n_sites, m) with -1 where there are fewer."""
    sites, points = points_at(surface, *from_places), points_at(surface, longitude, latitude)
    nearest = nearest_sites(surface, sites, points)
    used, fit_of_point = np.unique(nearest, return_inverse=True)
    neighbours = _enough_neighbours(ring, used)
    east, north = surface.axes(*(each[used] for each in from_places))
    coefficients, width = _fits(surface, sites, used, neighbours, east, north)
    to_points = surface.shortest(points - sites[nearest]) / width[fit_of_point, None]
    terms = _terms(dot(to_points, east[fit_of_point]), dot(to_points, north[fit_of_point]))
    weights = np.einsum("pt,ptn->pn", terms, coefficients[fit_of_point])
    columns = np.column_stack([nearest, np.maximum(neighbours[fit_of_point], 0)])
    values = np.column_stack([1.0 - weights.sum(axis=1), weights])
    rows = np.repeat(np.arange(len(points)), columns.shape[1])
    matrix = csr_array(coo_array((values.ravel(), (rows, columns.ravel())), shape=(len(points), len(sites))))
    return Remap(surface, matrix, *from_places, longitude, latitude)


def _fits(
    surface: Surface, sites: Array, used: Index, neighbours: Index, east: Array, north: Array
) -> tuple[Array, Array]:
    """Coefficients (n_used, N_TERMS, m) of the polynomials per difference of each neighbour's value from the site's.

    Coordinates on the tangent plane, along `east` and `north`, are divided by the widths (n_used,) of the rings, given
    too: then no monomial is much smaller than another.
    """
    inside = neighbours >= 0
    to_neighbours = surface.shortest(sites[neighbours] - sites[used][:, None, :])
    x, y = dot(to_neighbours, east[:, None, :]), dot(to_neighbours, north[:, None, :])
    width = np.sqrt(np.sum(inside * (x**2 + y**2), axis=1) / inside.sum(axis=1))
    design = inside[..., None] * _terms(x / width[:, None], y / width[:, None])
    coefficients = np.linalg.pinv(design, rcond=SMALLEST_SINGULAR_VALUE).astype(np.float64, copy=False)
    return coefficients, width


def _terms(x: Array, y: Array) -> Array:
    """Monomials (..., N_TERMS) of degree one and two."""
    return np.stack([x, y, x * x, x * y, y * y], axis=-1)


def _enough_neighbours(ring: Index, sites: Index) -> Index:
    """Neighbours (n, m) of `sites` (n,), with the second ring where the first has too few; -1 where there are fewer."""
    first = ring[sites]
    few = np.count_nonzero(first >= 0, axis=1) < N_TERMS
    if not few.any():
        return first
    both = _two_rings(ring, sites[few])
    wide = np.full((len(sites), max(first.shape[1], both.shape[1])), -1)
    wide[:, : first.shape[1]] = first
    wide[few] = -1
    wide[few, : both.shape[1]] = both
    return wide


def _two_rings(ring: Index, sites: Index) -> Index:
    """Neighbours of `sites` and theirs, each once and without the site itself, -1 where there are fewer."""
    first = ring[sites]
    second = np.where(first[..., None] >= 0, ring[first], -1).reshape(len(sites), -1)
    both = np.sort(np.concatenate([first, second], axis=1), axis=1)
    repeated = np.zeros(both.shape, dtype=bool)
    repeated[:, 1:] = both[:, 1:] == both[:, :-1]
    both[repeated | (both == sites[:, None])] = -1
    both = -np.sort(-both, axis=1)
    return both[:, : np.count_nonzero(both >= 0, axis=1).max()]

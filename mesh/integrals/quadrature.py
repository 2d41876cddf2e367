"""Values of a function at the cells of a mesh: at the centre, or the mean over the Voronoi polygon."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import dot, to_lonlat
from mesh.integrals.weighted_moments import CHUNK, RULE
from mesh.voronoi_mesh import VoronoiMesh

SphereFunction = Callable[[Array, Array], Array]
"""Gives one value for each longitude and latitude, radians, in arrays of any shape."""

Sampling = Literal["point", "mean"]
"""What a value at a cell stands for: the function at the centre, or its mean over the cell."""


def sample_cells(mesh: VoronoiMesh, function: SphereFunction, sampling: Sampling) -> Array:
    """Values (n_cells,) of `function` at cells, at the centres or as means over the cells."""
    if sampling == "point":
        return function(mesh.lon_cell, mesh.lat_cell)
    if sampling == "mean":
        return cell_means(mesh, function)
    raise ValueError(f"there is no sampling named '{sampling}'; choose point or mean")


def cell_means(mesh: VoronoiMesh, function: SphereFunction) -> Array:
    """Means (n_cells,) of `function` over the Voronoi cells, of sixth order in the width of cells where it is smooth.

    Each cell is the union of the spherical triangles of its centre and successive vertices, each triangle integrated
    by the rule of `mesh.integrals.weighted_moments`. The sum of the weights divides, so that a constant has its own
    value for a mean. A chunk of cells is evaluated at a time, to save memory.
    """
    means = np.empty(mesh.n_cells)
    for first in range(0, mesh.n_cells, CHUNK):
        cells = slice(first, first + CHUNK)
        nodes, weights = _nodes_and_weights(mesh, cells)
        values = function(*to_lonlat(nodes))
        means[cells] = np.sum(weights * values, axis=(1, 2)) / np.sum(weights, axis=(1, 2))
    return means


def _nodes_and_weights(mesh: VoronoiMesh, cells: slice) -> tuple[Array, Array]:
    """Quadrature points (cells, max_edges, 7, 3) and their weights (cells, max_edges, 7), on the unit sphere.

    A point p of the flat triangle x + s u + t v has the element of area x.(u x v) / |p|^3 ds dt on the sphere.
    """
    vertices, inside = mesh.vertices_on_cell[cells], mesh.on_ring[cells]
    # What a short ring leaves over becomes its first vertex: it closes the ring, and further triangles have no area.
    ring = np.where(inside, vertices, vertices[:, :1])
    center = mesh.cell_points[cells, None, :] / mesh.sphere_radius
    u = mesh.vertex_points[ring] / mesh.sphere_radius - center
    v = np.roll(u, -1, axis=1)
    s, t, weight = RULE.T
    nodes = center[:, :, None, :] + s[:, None] * u[:, :, None, :] + t[:, None] * v[:, :, None, :]
    area = dot(center, np.cross(u, v))
    return nodes, weight * area[:, :, None] / dot(nodes, nodes) ** 1.5

"""Values of a function at the cells of a mesh: at the centre, or the mean over the Voronoi polygon."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import dot
from mesh.geometry.surface import surface_of
from mesh.integrals.weighted_moments import CHUNK, RULE
from mesh.voronoi_mesh import VoronoiMesh

SphereFunction = Callable[[Array, Array], Array]
"""Gives one value for each longitude and latitude, radians, in arrays of any shape; on a plane for x and y, metres."""

Sampling = Literal["point", "mean"]
"""What a value at a cell stands for: the function at the centre, or its mean over the cell."""


def sample_cells(mesh: VoronoiMesh, function: SphereFunction, sampling: Sampling) -> Array:
    """Values (n_cells,) of `function` at cells, at the centres or as means over the cells."""
    if sampling == "point":
        return function(*mesh.coordinates("cell"))
    if sampling == "mean":
        return cell_means(mesh, function)
    raise ValueError(f"there is no sampling named '{sampling}'; choose point or mean")


def cell_means(mesh: VoronoiMesh, function: SphereFunction) -> Array:
    """Means (n_cells,) of `function` over the Voronoi cells, of sixth order in the width of cells where it is smooth.

    Each cell is the union of the spherical triangles of its centre and successive vertices, each triangle integrated
    by the rule of `mesh.integrals.weighted_moments`. The sum of the weights divides, so that a constant has its own
    value for a mean. A chunk of cells is evaluated at a time, to save memory.
    """
    means, surface = np.empty(mesh.n_cells), surface_of(mesh)
    for first in range(0, mesh.n_cells, CHUNK):
        cells = slice(first, first + CHUNK)
        nodes, weights = _nodes_and_weights(mesh, cells)
        values = function(*surface.coordinates(nodes))
        means[cells] = np.sum(weights * values, axis=(1, 2)) / np.sum(weights, axis=(1, 2))
    return means


def normal_means(mesh: VoronoiMesh, velocity: Callable[[Array, Array], tuple[Array, Array]]) -> Array:
    """Means (n_edges,), over Voronoi edges of a plane, of the component of a velocity along their normals.

    It gives its components along x and y for arrays of x and y. Of sixth order in the lengths of edges. Beside the
    midpoint between two cells, where `x_edge` and `y_edge` are, these are the fluxes that the divergence theorem asks
    for: the two differ by the first order in the spacing where the Voronoi edge has its middle elsewhere.
    """
    surface, ends = surface_of(mesh), mesh.vertex_points[mesh.vertices_on_edge]
    tail, head = (mesh.edge_points + surface.shortest(ends[:, k] - mesh.edge_points) for k in range(2))
    sums = np.zeros((2, mesh.n_edges))
    for node, weight in zip(*np.polynomial.legendre.leggauss(3), strict=True):
        places = tail + 0.5 * (1.0 + node) * (head - tail)
        sums += 0.5 * weight * np.stack(velocity(*surface.coordinates(places)))
    return sums[0] * np.cos(mesh.angle_edge) + sums[1] * np.sin(mesh.angle_edge)


def _nodes_and_weights(mesh: VoronoiMesh, cells: slice) -> tuple[Array, Array]:
    """Quadrature points (cells, max_edges, 7, 3) and their weights (cells, max_edges, 7), in lengths of the unit.

    On the sphere a point p of the flat triangle x + s u + t v has the element of area x.(u x v) / |p|^3 ds dt.
    """
    vertices, inside = mesh.vertices_on_cell[cells], mesh.on_ring[cells]
    # What a short ring leaves over becomes its first vertex: it closes the ring, and further triangles have no area.
    ring = np.where(inside, vertices, vertices[:, :1])
    surface = surface_of(mesh)
    center = mesh.cell_points[cells, None, :] / mesh.length_unit
    u = surface.shortest(mesh.vertex_points[ring] / mesh.length_unit - center)
    v = np.roll(u, -1, axis=1)
    s, t, weight = RULE.T
    nodes = center[:, :, None, :] + s[:, None] * u[:, :, None, :] + t[:, None] * v[:, :, None, :]
    area = dot(surface.outward(center), np.cross(u, v))
    return nodes, weight * area[:, :, None] / surface.stretch(nodes)

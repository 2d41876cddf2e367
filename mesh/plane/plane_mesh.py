"""The mesh of Voronoi cells in a rectangle: across its seams, and up to its walls."""

import numpy as np

from mesh.arrays import Array, Index
from mesh.coast.sea_topology import connected
from mesh.density.named import Density, density_at, uniform
from mesh.density.record import name_of, source_of
from mesh.discrete.build import validated
from mesh.discrete.metrics import AtWalls, compute_metrics
from mesh.errors import MeshError
from mesh.plane.domain import Rectangle
from mesh.plane.moving import PlaneCells
from mesh.plane.sides import CellSides, sides_of
from mesh.voronoi_mesh import Topology, VoronoiMesh

ROUND_OFF = 1e-12
"""Part of a length of the plane: generators nearer to a wall would be on it but for rounding."""


def plane_mesh(points: Array, plane: Rectangle, density: Density = uniform) -> VoronoiMesh:
    """The validated Voronoi mesh of generators `points` (n_cells, 3), metres, z = 0, in a rectangle.

    Points beyond it count as their images within. A cell at a wall has an edge without a second cell there, whose point
    is the foot of its generator, and whose `dc_edge` is the distance to its mirror image. Raises `MeshError` where
    generators coincide, stand on a wall, or are too few.
    """
    within = plane.folded(points)
    _require_off_walls(within, plane)
    cells = PlaneCells(within, plane)
    _require_short(cells, plane)
    sides = sides_of(cells)
    topology = connected(sides.corners, sides.cells_on_vertex, sides.corners.places)
    at_walls = None if all(plane.repeats) else _at_walls(within, plane, cells, sides, topology)
    metrics = compute_metrics(within, topology, at_walls, plane.surface)
    surface = plane.surface
    values = density_at(density, within, surface)
    named = {"density_name": name_of(density), "density_source": source_of(density)}
    periods = {"x_period": surface.x_period, "y_period": surface.y_period}
    return validated(topology, metrics, 0.0, mesh_density=values, **named, **periods)


def _require_off_walls(points: Array, plane: Rectangle) -> None:
    for axis, (length, repeats) in enumerate(zip(plane.lengths, plane.repeats, strict=True)):
        distance = np.minimum(points[:, axis], length - points[:, axis])
        if not repeats and distance.min() <= ROUND_OFF * length:
            raise MeshError(f"generator {np.argmin(distance)} stands on a wall; move it away from there")


def _require_short(cells: PlaneCells, plane: Rectangle) -> None:
    """Raise `MeshError` where a triangle or the way to its circumcentre is longer than half a period.

    The nearest image of one end would then be another one than that in the triangle.
    """
    triangles = np.unique(cells.rings[: cells.ring_starts[-1]])
    corners = cells.places[cells.triangles[triangles]]
    centers = cells.circumcenters[triangles, :2]
    ways = [corners - np.roll(corners, 1, axis=1), corners - centers[:, None]]
    longest = np.max([np.abs(way).max(axis=(0, 1)) for way in ways], axis=0)
    if (2.0 * longest >= plane.lengths)[np.array(plane.repeats)].any():
        raise MeshError(
            "a triangle of the generators is longer than half a period of the plane; give more generators, or spread "
            "them more evenly"
        )


def _at_walls(points: Array, plane: Rectangle, cells: PlaneCells, sides: CellSides, topology: Topology) -> AtWalls:
    """Vertices and points of edges on the walls, and how far from its generator each mirror image is."""
    vertices = cells.circumcenters[sides.centers]
    for axis, length in enumerate(plane.lengths):
        on = sides.walls[:, axis] >= 0
        vertices[on, axis] = np.where(sides.walls[on, axis] % 2, length, 0.0)
    edges, dc_edge = np.zeros((topology.n_edges, 3)), np.zeros(topology.n_edges)
    rows = np.flatnonzero(topology.cells_on_edge[:, 1] < 0)
    cell, wall = topology.cells_on_edge[rows, 0], _walls_of(sides, topology, rows)
    edges[rows] = points[cell]
    edges[rows, wall // 2] = np.where(wall % 2, plane.lengths[wall // 2], 0.0)
    dc_edge[rows] = 2.0 * np.linalg.norm(edges[rows] - points[cell], axis=1)
    return AtWalls(plane.surface.wrapped(vertices), edges, dc_edge, None)


def _walls_of(sides: CellSides, topology: Topology, rows: Index) -> Index:
    """The walls of the edges `rows` (k,): those that both of their vertices are on."""
    first, second = (sides.walls[topology.vertices_on_edge[rows, k]] for k in range(2))
    shared = np.where(first == second, first, -1)
    return shared.max(axis=1)

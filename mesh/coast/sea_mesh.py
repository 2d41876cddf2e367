"""The mesh of clipped cells: the coast itself is its wall."""

import numpy as np

from mesh.arrays import Array, Index
from mesh.coast.portions import Portions, ends_of, portions_of
from mesh.coast.sea_cells import SeaCells
from mesh.coast.sea_topology import sea_topology
from mesh.density.named import Density, density_at, uniform
from mesh.density.record import name_of, source_of
from mesh.discrete.build import validated
from mesh.discrete.metrics import AtWalls, compute_metrics
from mesh.errors import MeshError
from mesh.geometry.surface import Surface
from mesh.voronoi_mesh import Topology, VoronoiMesh

ROUND_OFF = 1e-12
"""Generators nearer to the coast than this, as a part of the extent of points, would be on it but for rounding."""


def sea_mesh(sea: SeaCells, generators: Array, density: Density = uniform) -> VoronoiMesh:
    """The validated mesh, on the unit sphere or in a plane, of the clipped cells that `sea` has.

    These are the cells of `generators` (n_cells, 3). A cell's portion of the coast is one edge without a second cell.
    Its point is that of the coast which is nearest to the generator, its `dc_edge` twice the distance to there, as if
    another generator stood as far behind the coast, and its `dv_edge` the arc between its ends. Areas of cells are
    those of the clipped cells, with all bends of the coast. Raises `MeshError` where a generator stands on land or on
    the coast itself, or where cells and coast are too intricate for such a mesh.
    """
    on_land = np.flatnonzero(~sea.coastline.contains(generators))
    if len(on_land):
        raise MeshError(f"generator {on_land[0]} stands on land: ask for more cells, or for {sea.coastline.wider}")
    topology, places = sea_topology(sea)
    at_walls = _at_walls(sea, generators, topology, portions_of(sea, generators), places)
    surface = sea.coastline.surface
    metrics = compute_metrics(generators, topology, at_walls, surface)
    named = {"density_name": name_of(density), "density_source": source_of(density)}
    radius = 0.0 if surface.is_flat else 1.0
    values = density_at(density, generators, surface)
    return validated(topology, metrics, radius, mesh_density=values, **named)


def _at_walls(sea: SeaCells, generators: Array, topology: Topology, portions: Portions, places: Index) -> AtWalls:
    """What the coast adds to the metrics: its vertices, the points of its edges, and kites beside them.

    Raises `MeshError` where a generator stands on the coast itself.
    """
    vertices, surface = sea.circumcenters[places], sea.coastline.surface
    portion = ends_of(sea, places)
    walls = np.flatnonzero(topology.cells_on_edge[:, 1] < 0)
    of_wall = portion[topology.vertices_on_edge[walls, 0]]
    edges = np.zeros((topology.n_edges, 3))
    edges[walls] = portions.points[of_wall]
    cells = topology.cells_on_edge[walls, 0]
    dc_edge = np.zeros(topology.n_edges)
    dc_edge[walls] = 2.0 * surface.distance(generators[cells], edges[walls])
    ashore = cells[dc_edge[walls] < ROUND_OFF * surface.extent(generators)]
    if len(ashore):
        raise MeshError(f"generator {ashore[0]} stands on the coast itself: ask for another number of cells")
    return AtWalls(vertices, edges, dc_edge, _kites(surface, generators, topology, vertices, portion, portions))


def _kites(
    surface: Surface, generators: Array, topology: Topology, vertices: Array, portion: Index, portions: Portions
) -> Array:
    """Areas (n_vertices, 3) at the vertices on the coast: of the cell that it enters there, and the one that it leaves.

    Each has the triangle of its generator, the vertex and the point of the edge between the two, and its area on this
    side of the point on the coast. At a corner of the coast one cell has its areas on both sides.
    """
    kites = np.zeros((topology.n_vertices, 3))
    arriving = np.full(len(portions.areas), -1)  # all are filled: `portions_of` has seen to it
    arriving[portions.next_end] = np.arange(len(portions.areas))
    both = topology.cells_on_vertex[:, 1] >= 0
    rows, alone = np.flatnonzero((portion >= 0) & both), np.flatnonzero((portion >= 0) & ~both)
    entered, left = (generators[topology.cells_on_vertex[rows, k]] for k in range(2))
    corner, middle = vertices[rows], surface.midpoint(entered, left)
    kites[rows, 0] = surface.triangle_area(entered, middle, corner) + portions.areas[portion[rows], 0]
    kites[rows, 1] = surface.triangle_area(left, corner, middle) + portions.areas[arriving[portion[rows]], 1]
    kites[alone, 0] = portions.areas[portion[alone], 0] + portions.areas[arriving[portion[alone]], 1]
    return kites

"""What a file says of its walls, where generators give nothing: vertices at the boundary, points of walls, kites."""

import numpy as np

from mesh.arrays import Array
from mesh.discrete.metrics import SHORT, AtWalls
from mesh.errors import MeshError, require
from mesh.files.arrange import Arrays, arrange_kites
from mesh.geometry.sphere import dot, from_lonlat
from mesh.geometry.surface import Surface
from mesh.voronoi_mesh import Topology

FARTHEST = 4.0
"""Times the way to a wall's farther vertex: what a wall has of its cell lies no farther away."""


def vertex_points(arrays: Arrays, surface: Surface) -> Array:
    """Points (n_vertices, 3) on the surface of the vertices in a file; raises `MeshError` where it has none."""
    if all(f"{axis}_vertex" in arrays for axis in "xyz"):
        points = np.stack([arrays[f"{axis}_vertex"] for axis in "xyz"], axis=1)
    elif not surface.is_flat and all(f"{angle}_vertex" in arrays for angle in ("lon", "lat")):
        points = from_lonlat(arrays["lon_vertex"], arrays["lat_vertex"])
    else:
        raise MeshError(
            "xVertex, yVertex and zVertex are missing; of a mesh with walls they do not follow from the generators"
        )
    size = dot(points, points)
    placed = np.isfinite(size) & (surface.is_flat | (size > 0.0))
    require(placed, "vertices", f"xVertex, yVertex and zVertex give no place on a {surface.name}")
    return surface.kept_on(points)


def at_walls_in(
    arrays: Arrays, topology: Topology, points: Array, unit: float, replaced: list[str], surface: Surface
) -> AtWalls:
    """What the arrays of a file, in lengths of `unit`, say of the walls of `topology`, of generators (n_cells, 3).

    Points of walls that are missing or lie far off are the feet of their cells, `replaced` says so. Raises `MeshError`
    where a vertex has no place, or where the missing cell of a wall stands nowhere.
    """
    vertices = vertex_points(arrays, surface)
    walls = np.flatnonzero(topology.cells_on_edge[:, 1] < 0)
    cells = points[topology.cells_on_edge[walls, 0]]
    tail, head = (vertices[topology.vertices_on_edge[walls, k]] for k in range(2))
    reach = FARTHEST * np.maximum(surface.distance(cells, tail), surface.distance(cells, head))
    edges = np.full((topology.n_edges, 3), np.nan)
    edges[walls] = feet = surface.feet(cells, tail, head, SHORT)
    if all(f"{axis}_edge" in arrays for axis in "xyz"):
        given = np.stack([arrays[f"{axis}_edge"][walls] for axis in "xyz"], axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            given = surface.kept_on(given)
        near = surface.distance(cells, given) <= reach
        edges[walls] = np.where(near[:, None], given, feet)
        if not near.all():
            replaced.append(
                f"xEdge, yEdge and zEdge of {np.count_nonzero(~near)} walls, which lay far from their cells"
            )
    dc_edge = np.full(topology.n_edges, np.nan)
    dc_edge[walls] = 2.0 * surface.distance(cells, edges[walls])
    if "dc_edge" in arrays:
        dc_edge[walls] = arrays["dc_edge"][walls] / unit
    fits = np.ones(topology.n_edges, np.bool_)
    fits[walls] = (dc_edge[walls] > 0.0) & (dc_edge[walls] <= 2.0 * reach)
    require(fits, "edges", "dcEdge is no distance at which the missing cell of a wall may stand; correct the file")
    kites = arrays.get("kite_areas_on_vertex")
    if kites is not None:
        kites = arrange_kites(kites, arrays["cells_on_vertex"], topology) / unit**2
    return AtWalls(vertices, edges, dc_edge, kites)

"""What a file says of its walls, where generators give nothing: vertices at the boundary, points of walls, kites."""

import numpy as np

from mesh.arrays import Array
from mesh.discrete.metrics import SHORT, AtWalls
from mesh.errors import MeshError, require
from mesh.files.arrange import Arrays, arrange_kites
from mesh.geometry.sphere import arc_length, dot, from_lonlat, normalize
from mesh.voronoi_mesh import Topology

FARTHEST = 4.0
"""Times the way to a wall's farther vertex: what a wall has of its cell lies no farther away."""


def vertex_points(arrays: Arrays) -> Array:
    """Unit vectors (n_vertices, 3) of the vertices in a file; raises `MeshError` where it has none."""
    if all(f"{axis}_vertex" in arrays for axis in "xyz"):
        points = np.stack([arrays[f"{axis}_vertex"] for axis in "xyz"], axis=1)
    elif all(f"{angle}_vertex" in arrays for angle in ("lon", "lat")):
        points = from_lonlat(arrays["lon_vertex"], arrays["lat_vertex"])
    else:
        raise MeshError(
            "xVertex, yVertex and zVertex are missing; of a mesh with walls they do not follow from the generators"
        )
    size = dot(points, points)
    require(np.isfinite(size) & (size > 0.0), "vertices", "xVertex, yVertex and zVertex give no place on a sphere")
    return normalize_but_for_rounding(points)


def normalize_but_for_rounding(points: Array) -> Array:
    """The points (n, 3) on the unit sphere; those that are there but for round-off stay as they are, bit for bit."""
    distance = np.sqrt(dot(points, points))
    there = np.abs(distance - 1.0) <= 2.0 * np.finfo(float).eps
    return np.where(there[:, None], points, normalize(points))


def at_walls_in(arrays: Arrays, topology: Topology, points: Array, radius: float, replaced: list[str]) -> AtWalls:
    """What the arrays of a file say of the walls of `topology`, with generators `points` (n_cells, 3), unit vectors.

    Points of walls that are missing or lie far off are the feet of their cells, `replaced` says so. Raises `MeshError`
    where a vertex has no place, or where the missing cell of a wall stands nowhere.
    """
    vertices = vertex_points(arrays)
    walls = np.flatnonzero(topology.cells_on_edge[:, 1] < 0)
    cells = points[topology.cells_on_edge[walls, 0]]
    tail, head = (vertices[topology.vertices_on_edge[walls, k]] for k in range(2))
    reach = FARTHEST * np.maximum(arc_length(cells, tail), arc_length(cells, head))
    edges = np.full((topology.n_edges, 3), np.nan)
    edges[walls] = feet = _feet(cells, tail, head)
    if all(f"{axis}_edge" in arrays for axis in "xyz"):
        given = np.stack([arrays[f"{axis}_edge"][walls] for axis in "xyz"], axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            given = normalize_but_for_rounding(given)
        near = arc_length(cells, given) <= reach
        edges[walls] = np.where(near[:, None], given, feet)
        if not near.all():
            replaced.append(
                f"xEdge, yEdge and zEdge of {np.count_nonzero(~near)} walls, which lay far from their cells"
            )
    dc_edge = np.full(topology.n_edges, np.nan)
    dc_edge[walls] = 2.0 * arc_length(cells, edges[walls])
    if "dc_edge" in arrays:
        dc_edge[walls] = arrays["dc_edge"][walls] / radius
    fits = np.ones(topology.n_edges, np.bool_)
    fits[walls] = (dc_edge[walls] > 0.0) & (dc_edge[walls] <= 2.0 * reach)
    require(fits, "edges", "dcEdge is no distance at which the missing cell of a wall may stand; correct the file")
    kites = arrays.get("kite_areas_on_vertex")
    if kites is not None:
        kites = arrange_kites(kites, arrays["cells_on_vertex"], topology) / radius**2
    return AtWalls(vertices, edges, dc_edge, kites)


def _feet(cells: Array, tail: Array, head: Array) -> Array:
    """Where the ways (n, 3) from cells square to the great circles through two vertices meet these."""
    pole, middle = np.cross(head - tail, head + tail), normalize(head + tail)
    size = dot(pole, pole)
    short = size < (2.0 * SHORT) ** 2 * dot(middle - cells, middle - cells)
    pole = pole / np.sqrt(np.where(short, 1.0, size))[:, None]
    return np.where(short[:, None], middle, normalize(cells - dot(cells, pole)[:, None] * pole))

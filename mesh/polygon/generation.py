"""From the description of a mesh and a polygon to the mesh of its inside."""

import time
from collections.abc import Sequence
from functools import partial

import numpy as np

from mesh.arrays import Array
from mesh.coast.sea_cells import SeaCells, SeaResult
from mesh.coast.sea_mesh import sea_mesh
from mesh.density.named import Density, uniform
from mesh.density.planar import density_on_plane
from mesh.errors import MeshError
from mesh.generation.optimizer import Callback, Limits, Optimizer
from mesh.generation.scvt import cells_of, check_converged, limits_of
from mesh.mesh_request import MeshRequest
from mesh.plane.domain import Rectangle
from mesh.plane.generation import require_possible_on_plane
from mesh.polygon.lifted import LiftedCells, Lifting
from mesh.polygon.rings import Points, checked_rings
from mesh.polygon.starts import starting_points
from mesh.polygon.walls import Walls
from mesh.voronoi_mesh import VoronoiMesh


def polygon_mesh(
    rings: Sequence[Points], request: MeshRequest, callback: Callback | None = None, name: str = "the polygon"
) -> VoronoiMesh:
    """The validated centroidal Voronoi mesh of a polygon in the plane that the `request` describes.

    `rings` are lists of points (m, 2), metres, round the polygon and round each of its holes, within the plane, which
    is not to be periodic. Walls clip cells as coasts do (`mesh.coast.sea_mesh`). Corners that stick out are vertices
    (`mesh.polygon.walls`); at others an edge bends. Of the request count what counts for a rectangle
    (`mesh.plane.generation.mesh_on_plane`). `name` is that of the polygon in errors. Raises `MeshError` if no such mesh
    can be made.
    """
    begin = time.perf_counter()
    plane = require_possible_in_polygon(request)
    walls = Walls(checked_rings(rings, plane, name), cells_of(request))
    density = density_on_plane(request, plane.lengths)
    limits = limits_of(request)
    points = starting_points(walls, cells_of(request), density, request.start, request.seed)
    found = converge_in_polygon(points, walls, request.method, density, limits.since(begin), callback)
    check_converged(found.result, limits)
    return sea_mesh(found.sea, found.result.points, density)


def require_possible_in_polygon(request: MeshRequest) -> Rectangle:
    """The plane in which a polygon is; raise `MeshError` if the request asks for what a mesh of one cannot have."""
    plane = require_possible_on_plane(request)
    if request.hexagons is not None:
        raise MeshError("regular hexagons do not follow the walls of a polygon; give --cells N in place of --hexagons")
    if any(plane.repeats):
        raise MeshError(
            f"the plane of a polygon cannot be periodic, which it is in {plane.periodic}; give --periodic none"
        )
    return plane


def converge_in_polygon(
    points: Array,
    walls: Walls,
    method: str = MeshRequest.method,
    density: Density = uniform,
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> SeaResult:
    """Move generators `points` (n, 3), z = 0, to the centroids of their cells in a polygon.

    Raises `MeshError` for an unknown method, where points coincide, or where the density cannot be used.
    """
    cells = cells_in_polygon(points, walls)
    optimizer = Optimizer(
        points,
        method=method,
        density=None if density is uniform else density,
        cells=cells,
        spacing=walls.spacing,
        surface=walls.surface,
    )
    return SeaResult(optimizer.run(Limits() if limits is None else limits, callback), cells)


def cells_in_polygon(points: Array, walls: Walls) -> SeaCells:
    """The cells of generators `points` (n, 3), z = 0, that the walls clip; raise `MeshError` where points coincide."""
    lifting = Lifting(np.concatenate([walls.points, points]))
    return SeaCells(points, walls, lifting.far_places, partial(LiftedCells, lifting=lifting))

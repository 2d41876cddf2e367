"""Points to start from in a polygon."""

import math

import numpy as np

from mesh.arrays import Array
from mesh.density.named import Density, density_at, uniform
from mesh.mesh_request import MeshRequest
from mesh.plane.domain import Rectangle
from mesh.plane.starts import FEWEST_IN_BOX, named_start, random_points, rows_of_points
from mesh.polygon.walls import Walls
from mesh.triangulation.ordering import hilbert_order


def starting_points(
    walls: Walls, cells: int, density: Density = uniform, start: str | None = None, seed: int = MeshRequest.seed
) -> Array:
    """Points (cells, 3) in the polygon, numbered along a space-filling curve; see `mesh.plane.starts`.

    Raises `MeshError` for too few cells, an unknown start, or a density that is negative or zero everywhere.
    """
    start = named_start(start, cells, FEWEST_IN_BOX, density)
    points = _rows(walls, cells) if start == "rows" else _drawn(walls, cells, density, start, seed)
    return np.ascontiguousarray(points[hilbert_order(walls.surface.curve_places(points))])


def _box(walls: Walls) -> tuple[Rectangle, Array]:
    """The smallest rectangle round the polygon, and its corner (3,) in the south-west."""
    low, high = walls.points.min(axis=0), walls.points.max(axis=0)
    return Rectangle(float(high[0] - low[0]), float(high[1] - low[1]), "none"), low


def _rows(walls: Walls, cells: int) -> Array:
    """Points of rows through the rectangle; those that are too many are left out where a wall is nearest."""
    box, corner = _box(walls)
    share = walls.area / box.area
    count = math.ceil(cells / share)
    while True:
        points = rows_of_points(box, count) + corner
        distance = walls.distance(points)
        inside = np.flatnonzero(distance > 0.0)
        if len(inside) >= cells:
            return points[np.sort(inside[np.argsort(-distance[inside], kind="stable")[:cells]])]
        count += max(1, int((cells - len(inside)) / share))


def _drawn(walls: Walls, cells: int, density: Density, start: str, seed: int) -> Array:
    """Points drawn from the density, or from its square root."""
    box, corner = _box(walls)

    def inside(places: Array) -> Array:
        points = places + corner
        return np.where(walls.contains(points), density_at(density, points, walls.surface), 0.0)

    return random_points(box, cells, inside, 1.0 if start == "random" else 0.5, seed) + corner

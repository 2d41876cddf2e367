"""Rings of polygons: what users give, checked, and those of a GeoJSON file in metres."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.plane.domain import Rectangle
from mesh.regions.optional import package_for_coasts
from mesh.regions.polygons import polygons_in

Points = Array | Sequence[Sequence[float]]
"""Rows or lists of x and y."""

FEWEST_POINTS = 3

ROUND_OFF = 1e-12
"""Part of a length of the plane by which a polygon may reach beyond it."""


def read_rings(path: Path) -> list[Any]:
    """The rings of the one polygon of a GeoJSON file, as they are there; raise `MeshError` where there is none."""
    polygons = polygons_in(path)
    if len(polygons) != 1:
        raise MeshError(f"{path}: holds {len(polygons)} polygons, and a mesh fills one; leave the others out")
    return polygons[0]


def checked_rings(rings: Sequence[Points], plane: Rectangle, name: str = "the polygon") -> list[Array]:
    """The rings (m, 3) of a polygon, z = 0, with its inside to their left: the one round it, then those of its holes.

    `rings` (m, 2) are in metres, in either direction, and may repeat their first point at the end; more numbers of a
    point, such as its height, are left out. Raises `MeshError` where they are no simple polygon in the plane.
    """
    if not len(rings):
        raise MeshError(f"{name} has no ring; give the points round it")
    shapely = package_for_coasts("shapely", "a mesh of a polygon")
    corners = [_points(ring, f"ring {number} of {name}") for number, ring in enumerate(rings)]
    for number, ring in enumerate(corners):
        _require_within(ring, plane, f"ring {number} of {name}")
    shape = shapely.Polygon(corners[0], corners[1:])
    if not shape.is_valid:
        raise MeshError(f"{name} is not simple ({shapely.is_valid_reason(shape)}); correct it, such as by buffer(0)")
    directions = [1.0, *[-1.0] * (len(corners) - 1)]
    turned = [ring if _area(ring) * sign > 0.0 else ring[::-1] for ring, sign in zip(corners, directions, strict=True)]
    return [np.column_stack([ring, np.zeros(len(ring))]) for ring in turned]


def _points(ring: Points, name: str) -> Array:
    """The points (m, 2) of a ring, the first one not repeated."""
    try:
        points = np.array([position[:2] for position in ring], float).reshape(-1, 2)
    except (TypeError, ValueError, IndexError) as error:
        raise MeshError(f"{name} is no list of points ({error}); give x and y of each, in metres") from error
    if len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    if len(points) < FEWEST_POINTS:
        raise MeshError(f"{name} has {len(points)} points; give at least {FEWEST_POINTS}")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        x, y = points[wrong[0]]
        raise MeshError(f"{name} has its point {wrong[0]} at x = {x:g}, y = {y:g}; give finite numbers, in metres")
    repeated = np.flatnonzero((points == np.roll(points, -1, axis=0)).all(axis=1))
    if len(repeated):
        raise MeshError(f"{name} has its point {repeated[0]} twice in a row; leave one of them out")
    return points


def _require_within(points: Array, plane: Rectangle, name: str) -> None:
    slack = ROUND_OFF * plane.lengths
    outside = np.flatnonzero(((points < -slack) | (points > plane.lengths + slack)).any(axis=1))
    if len(outside):
        x, y = points[outside[0]]
        raise MeshError(
            f"{name} has a point at x = {x:g}, y = {y:g} m, outside of the plane of {plane.width:g} by "
            f"{plane.height:g} m; give coordinates in metres within it, or a larger plane"
        )


def _area(points: Array) -> float:
    """The area of a ring (m, 2), positive if it runs counter-clockwise."""
    x, y = (points - points[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

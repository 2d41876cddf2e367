"""Polygons in longitude and latitude, and those of GeoJSON files.

As RFC 7946 has it, an edge is straight in longitude and latitude, not a great circle. An edge that spans more than half
the circle crosses the date line, where its ends lie near that.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.geometry.sphere import to_lonlat
from mesh.regions.optional import package_for_coasts
from mesh.regions.outline import joined, signed, straight_on_the_map
from mesh.regions.region import Region

TURN, HALF_TURN, QUARTER_TURN = 360.0, 180.0, 90.0

HOLDERS = {"Feature": "geometry", "FeatureCollection": "features", "GeometryCollection": "geometries"}
"""What of the objects of a file holds others."""


def read_polygons(path: Path) -> Region:
    """The region that the polygons of a GeoJSON file cover together, without their holes.

    Raises `MeshError` where the file cannot be read, holds no polygon, or one that crosses itself.
    """
    polygons = [[_positions(ring, path) for ring in rings] for rings in polygons_in(path)]
    return polygon_region(polygons, str(path))


def polygons_in(path: Path) -> list[list[Any]]:
    """The rings of each polygon of a GeoJSON file, as they are there: the one round it, and those of its holes.

    Raises `MeshError` where the file cannot be read, or holds no polygon.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MeshError(f"{path}: {error.strerror}; give a GeoJSON file with a polygon") from error
    except ValueError as error:
        raise MeshError(f"{path}: is not GeoJSON ({error}); give a file with a polygon") from error
    polygons = _polygons(content, path)
    if not polygons:
        raise MeshError(f"{path}: holds no polygon; give a GeoJSON file with a Polygon or a MultiPolygon")
    return polygons


def polygon_region(polygons: list[list[Array]], name: str) -> Region:
    """The region that polygons cover, each the ring (n, 2) round it and those of its holes, in degrees east and north.

    Raises `MeshError` where one crosses itself or goes round a pole.
    """
    shapely = package_for_coasts("shapely", "a region bounded by polygons")
    shapes = [_shape(shapely, rings, f"{name}: polygon {number}") for number, rings in enumerate(polygons)]
    turned = [
        shapely.transform(shape, lambda corners, turn=turn: corners + np.array([turn, 0.0]))
        for shape in shapes
        for turn in _turns(shape.bounds)
    ]
    # The union of three turns has no edge where one turn ends and the next begins.
    whole = shapely.union_all(turned)
    shapely.prepare(whole)

    def inside(points: Array) -> NDArray[np.bool_]:
        longitude, latitude = (np.degrees(angle) for angle in to_lonlat(points))
        return shapely.intersects_xy(whole, longitude, latitude)

    edges = shapely.intersection(whole.boundary, shapely.box(0.0, -QUARTER_TURN, TURN, QUARTER_TURN))
    lines = [shapely.get_coordinates(line) for line in shapely.get_parts(edges) if line.length > 0.0]
    outline = joined([straight_on_the_map(*np.radians(line).T) for line in lines])
    return Region(name, lambda points: signed(outline.distance(points), inside(points)), inside)


def _turns(bounds: tuple[float, float, float, float]) -> list[float]:
    """Degrees by which a shape of these bounds (west, south, east, north) is turned to meet longitudes 0 to 360."""
    first = np.floor((-bounds[2]) / TURN) * TURN
    return [turn for turn in first + TURN * np.arange(5) if bounds[2] + turn >= 0.0 and bounds[0] + turn <= TURN]


def _shape(shapely: Any, rings: list[Array], name: str) -> Any:
    """The polygon of rings, each going on where the date line interrupts it, the holes beside the first."""
    whole = [_without_jumps(ring, name) for ring in rings]
    west = whole[0][:, 0].min()
    for hole in whole[1:]:
        hole[:, 0] += TURN * np.ceil((west - hole[:, 0].min()) / TURN)
    shape = shapely.Polygon(whole[0], whole[1:])
    if not shape.is_valid:
        raise MeshError(f"{name}: is not simple ({shapely.is_valid_reason(shape)}); correct it, such as by buffer(0)")
    if shape.bounds[2] - shape.bounds[0] > TURN:
        raise MeshError(f"{name}: goes round the sphere more than once; divide it")
    return shape


def _without_jumps(ring: Array, name: str) -> Array:
    """The ring (n, 2) with longitudes that go on beyond the date line; edges that go all the way round stay."""
    steps = np.diff(ring[:, 0])
    jumps = (np.abs(steps) > HALF_TURN) & (np.abs(steps) < TURN)
    unclear = jumps & (np.abs(steps) < TURN - QUARTER_TURN)
    if unclear.any():
        first = int(unclear.argmax())
        raise MeshError(
            f"{name}: an edge from {ring[first, 0]:g} to {ring[first + 1, 0]:g} degrees east is longer than half the "
            "circle; put a point between its ends, or count on beyond 180 degrees where it crosses the date line"
        )
    turns = np.concatenate([[0.0], np.cumsum(np.where(jumps, -np.sign(steps), 0.0))])
    if turns[-1] != 0.0:
        raise MeshError(f"{name}: goes round a pole; give it edges along the pole's latitude and one meridian")
    return ring + np.stack([TURN * turns, np.zeros(len(ring))], axis=1)


def _polygons(content: Any, path: Path) -> list[list[Any]]:
    """The rings of each polygon in an object of GeoJSON."""
    kind = content.get("type") if isinstance(content, dict) else None
    if kind in HOLDERS:
        held = content.get(HOLDERS[kind])
        parts = held if isinstance(held, list) else [] if held is None else [held]
        return [rings for part in parts for rings in _polygons(part, path)]
    if kind not in ("Polygon", "MultiPolygon"):
        raise MeshError(f"{path}: holds {_named(kind)}; give a Polygon or a MultiPolygon, or features of these")
    coordinates = content.get("coordinates")
    polygons = [coordinates] if kind == "Polygon" else coordinates
    if not (isinstance(polygons, list) and all(isinstance(rings, list) and rings for rings in polygons)):
        raise MeshError(f"{path}: a {kind} has no list of rings as its coordinates; give it one")
    return polygons


def _named(kind: Any) -> str:
    return f"an object of the type {kind!r}" if kind else "something that is no object of GeoJSON"


def _positions(ring: Any, path: Path) -> Array:
    """The closed ring (n, 2) in degrees; a third number of a position, its height, is left out."""
    try:
        corners = np.array([position[:2] for position in ring], float).reshape(-1, 2)
    except (TypeError, ValueError, IndexError, KeyError) as error:
        raise MeshError(f"{path}: a ring is no list of positions ({error}); give [longitude, latitude] each") from error
    valid = np.isfinite(corners).all() and (np.abs(corners) <= (2.0 * TURN, QUARTER_TURN)).all()
    if len(corners) < 3 or not valid:
        raise MeshError(
            f"{path}: a ring of {len(corners)} positions goes beyond longitudes of 720 or latitudes of 90 degrees, or "
            "has fewer than three; give [longitude, latitude] in degrees"
        )
    return corners if (corners[0] == corners[-1]).all() else np.concatenate([corners, corners[:1]])

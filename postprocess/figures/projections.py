"""Polygons on paper: the sphere on the Mollweide and the cylindrical map and in orthographic views; planes as they are.

The Mollweide and orthographic maps have the sphere's radius as their unit: the Mollweide ellipse has half axes
2 sqrt(2) and sqrt(2), the orthographic disc radius 1. The cylindrical map is in degrees of longitude and latitude, and
planes are in metres.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.angles import TURN, about_zero
from mesh.geometry.sphere import dot, from_lonlat, normalize, to_lonlat
from postprocess.figures.patches import Patches

NEWTON_ITERATIONS = 12
POINTS_ON_LONG_SIDE = 16
LONG_SIDE = np.radians(15.0)
"""Sides that span more longitude than this are drawn as curves of several points: they lie near a pole."""

ON_THE_POLE = 1e-9
"""Sides closer to a pole than this (radians) run through it."""


Box = tuple[float, float, float, float]
"""What is drawn of a plane: left, right, bottom and top, metres."""


@dataclass(frozen=True)
class Polygons:
    """Outlines on a map, each (n_points, 2), and the number of the patch that each shows; one on a seam has two."""

    outlines: list[Array]
    shown: Index


def mollweide(longitude: Array, latitude: Array) -> Array:
    """Map coordinates (..., 2) of longitude from the central meridian, which may pass +-pi, and latitude (rad)."""
    # Newton's method on 2 t + sin 2t = pi sin(latitude), whose derivative vanishes at the poles only.
    angle = np.array(latitude, dtype=float)
    for _ in range(NEWTON_ITERATIONS):
        slope = np.maximum(2.0 + 2.0 * np.cos(2.0 * angle), 1e-12)
        angle = angle - (2.0 * angle + np.sin(2.0 * angle) - np.pi * np.sin(latitude)) / slope
        angle = np.clip(angle, -0.5 * np.pi, 0.5 * np.pi)
    x = 2.0 * np.sqrt(2.0) / np.pi * longitude * np.cos(angle)
    return np.stack([x, np.sqrt(2.0) * np.sin(angle)], axis=-1)


def mollweide_raster(rows: int, columns: int) -> tuple[Array, Array]:
    """Longitudes from the central meridian and latitudes (rows * columns,) of the pixels of the map, from the south.

    The rectangle holds the map's ellipse; pixels beyond the rim have the longitude of the rim.
    """
    x = 2.0 * np.sqrt(2.0) * ((2.0 * np.arange(columns) + 1.0) / columns - 1.0)
    sine = (2.0 * np.arange(rows) + 1.0) / rows - 1.0
    angle = np.arcsin(sine)[:, None]
    latitude = np.arcsin((2.0 * angle + np.sin(2.0 * angle)) / np.pi)
    longitude = np.clip(np.pi * x / (2.0 * np.sqrt(2.0) * np.cos(angle)), -np.pi, np.pi)
    return longitude.ravel(), np.repeat(latitude, columns)


def orthographic(points: Array, longitude: float, latitude: float) -> Array:
    """Coordinates (..., 3) right, up and towards the viewer above `longitude`, `latitude` (rad)."""
    right = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
    towards = from_lonlat(np.array(longitude), np.array(latitude))
    return points @ np.stack([right, np.cross(towards, right), towards], axis=1)


def cylindrical(longitude: Array, latitude: Array) -> Array:
    """Map coordinates (..., 2), degrees, of longitude from the central meridian and latitude (rad)."""
    return np.degrees(np.stack([longitude, latitude], axis=-1))


@dataclass(frozen=True)
class GlobeMap:
    """A map of the whole globe on which meridians end at the poles: how it maps, and the height of the poles on it.

    `project` takes longitude from the central meridian, which may pass +-pi, and latitude, rad.
    """

    project: Callable[[Array, Array], Array]
    pole: float


MOLLWEIDE = GlobeMap(mollweide, np.sqrt(2.0))
CYLINDRICAL = GlobeMap(cylindrical, 90.0)


def globe_polygons(globe_map: GlobeMap, patches: Patches, central_longitude: float) -> Polygons:
    """All patches on a map of the globe; what passes the map's rim is to be clipped there."""
    corners = patches.corners
    center = _from_meridian(patches.longitude, central_longitude)
    longitude, latitude = to_lonlat(corners)
    longitude = center[:, None] + about_zero(longitude - patches.longitude[:, None])
    steps = np.abs(np.diff(longitude, axis=1, append=longitude[:, :1]))
    near_pole = (steps.max(axis=1) > LONG_SIDE) | (np.abs(latitude).max(axis=1) > 0.5 * np.pi - ON_THE_POLE)
    outlines = globe_map.project(longitude, latitude)
    shift = np.where(longitude.max(axis=1) > np.pi, -TURN, TURN)
    on_seam = (np.abs(longitude).max(axis=1) > np.pi) & ~near_pole
    copies = globe_map.project(longitude[on_seam] + shift[on_seam, None], latitude[on_seam])
    polar_outlines, polar = [], []
    for patch in np.flatnonzero(near_pole):
        ring = corners[patch, : patches.counts[patch]]
        for outline in _outlines_near_pole(globe_map, ring, float(patches.longitude[patch]), float(center[patch])):
            polar_outlines.append(outline)
            polar.append(patch)
    return Polygons(
        [*outlines[~near_pole], *copies, *polar_outlines],
        np.concatenate([np.flatnonzero(~near_pole), np.flatnonzero(on_seam), np.array(polar, dtype=int)]),
    )


def orthographic_polygons(patches: Patches, longitude: float, latitude: float) -> Polygons:
    """The patches on the hemisphere that faces the viewer, drawn up to the limb."""
    corners = orthographic(patches.corners, longitude, latitude)
    visible = corners[..., 2].max(axis=1) > 0.0
    flat, depth = corners[visible, :, :2], corners[visible, :, 2]
    at_limb = flat / np.linalg.norm(flat, axis=-1, keepdims=True)
    return Polygons(list(np.where(depth[..., None] > 0.0, flat, at_limb)), np.flatnonzero(visible))


def plane_polygons(patches: Patches, periods: Array, box: Box) -> Polygons:
    """The patches of a plane with these periods (2,), metres, and all their images, that reach into `box`, whole."""
    corners = patches.corners[..., :2]
    least, most = corners.min(axis=1), corners.max(axis=1)
    left, right, bottom, top = box
    outlines: list[Array] = []
    shown = []
    for across in _shifts(least[:, 0], most[:, 0], float(periods[0]), left, right):
        for up in _shifts(least[:, 1], most[:, 1], float(periods[1]), bottom, top):
            shift = np.array([across, up])
            seen = np.all((most + shift > (left, bottom)) & (least + shift < (right, top)), axis=1)
            outlines.extend(corners[seen] + shift)
            shown.append(np.flatnonzero(seen))
    return Polygons(outlines, np.concatenate(shown))


def _shifts(least: Array, most: Array, period: float, low: float, high: float) -> Array:
    """Multiples of a period by which patches, from `least` to `most` (n,), may come between `low` and `high`."""
    if period == 0.0:
        return np.zeros(1)
    first, last = np.ceil((low - most.max()) / period), np.floor((high - least.min()) / period)
    return period * np.arange(first, last + 1.0)


def _from_meridian(longitude: Array, central_longitude: float) -> Array:
    return about_zero(longitude - central_longitude)


def _outlines_near_pole(globe_map: GlobeMap, corners: Array, within: float, center: float) -> list[Array]:
    """Outlines on the map of one patch at or near a pole, its long sides as curves.

    `within` is a longitude within the patch, and `center` the same from the map's central meridian.
    """
    points = np.concatenate(
        [_side(start, end) for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    longitude, latitude = to_lonlat(points)
    longitude = center + about_zero(longitude - within)
    turns = (-TURN, 0.0, TURN)
    if not _surrounds_pole(corners):
        return [globe_map.project(longitude + turn, latitude) for turn in turns]
    # The patch is all that lies poleward of its sides: a strip across the map, closed beyond the rim.
    order = np.argsort(longitude)
    strip = globe_map.project(np.concatenate([longitude[order] + turn for turn in turns]), np.tile(latitude[order], 3))
    top = np.copysign(globe_map.pole, latitude[0])
    return [np.concatenate([strip, [[strip[-1, 0], top], [strip[0, 0], top]]])]


def _side(start: Array, end: Array) -> Array:
    """Points (n, 3) of a side without its end: the start alone, or a great-circle arc where the side is long."""
    normal = np.cross(start, end)
    if abs(normal[2]) < ON_THE_POLE * np.linalg.norm(normal):
        # The side runs through the pole, towards which meridians curve ever more on the map.
        to_pole, beyond = (np.hypot(corner[0], corner[1]) for corner in (start, end))
        pole = to_pole / (to_pole + beyond)
        way = np.linspace(-1.0, 1.0, 4 * POINTS_ON_LONG_SIDE + 1)[:-1]
        fraction = pole + np.where(way < 0.0, -pole, 1.0 - pole) * way**2
    elif abs(about_zero(np.subtract(*to_lonlat(np.stack([start, end]))[0]))) > LONG_SIDE:
        fraction = np.linspace(0.0, 1.0, POINTS_ON_LONG_SIDE, endpoint=False)
    else:
        return start[None, :]
    return normalize((1.0 - fraction)[:, None] * start + fraction[:, None] * end)


def _surrounds_pole(corners: Array) -> bool:
    """Whether a pole lies strictly inside a counter-clockwise patch."""
    pole = np.array([0.0, 0.0, np.copysign(1.0, corners[:, 2].mean())])
    sides = dot(np.cross(corners, np.roll(corners, -1, axis=0)), np.broadcast_to(pole, corners.shape))
    return bool(np.all(sides > ON_THE_POLE * np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1)))

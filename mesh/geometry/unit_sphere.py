"""The unit sphere as a surface of meshes (`mesh.geometry.surface`)."""

import math

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks, row_loop
from mesh.geometry.sphere import (
    arc_length,
    circumcenter,
    dot,
    east_north,
    mean_spacing,
    normalize,
    to_lonlat,
    triangle_area,
)
from mesh.geometry.vectors import area_parts, vector_to


class UnitSphere:
    """See `mesh.geometry.surface.Surface`."""

    name = "sphere"
    is_flat = False
    handles = 0
    area = 4.0 * float(np.pi)
    periods: Array = np.zeros(2)

    def shortest(self, vectors: Array) -> Array:
        """The vectors themselves: a chord has no images."""
        return vectors

    def distance(self, a: Array, b: Array) -> Array:
        """Length (...) of the arc."""
        return arc_length(a, b)

    def midpoint(self, a: Array, b: Array) -> Array:
        """The middle (..., 3) of the arc."""
        return normalize(a + b)

    def circumcenter(self, a: Array, b: Array, c: Array) -> Array:
        """On the side from which a, b, c run counter-clockwise."""
        return circumcenter(a, b, c)

    def triangle_area(self, a: Array, b: Array, c: Array) -> Array:
        """Of the spherical triangle."""
        return triangle_area(a, b, c)

    def kite_areas(self, points: Array, edges: Array, cells: Index, sides: Index, corners: Array) -> Array:
        """Each kite is two spherical triangles."""

        def kites(cells: Index, sides: Index, corners: Array) -> Array:
            triples, denominators = _halves_of_kites(points, edges, cells, sides, corners)
            halves = 2.0 * np.arctan2(triples, denominators)
            return halves[:, 0::2] + halves[:, 1::2]

        return by_blocks(kites, cells, sides, corners)

    def onto(self, points: Array) -> Array:
        """The points, of any length, as unit vectors."""
        return normalize(points)

    def kept_on(self, points: Array) -> Array:
        """The same, those that are unit vectors but for round-off as they are."""
        distance = np.sqrt(dot(points, points))
        there = np.abs(distance - 1.0) <= 2.0 * np.finfo(float).eps
        return np.where(there[:, None], points, normalize(points))

    def is_off(self, points: Array, unit: float, slack: float) -> NDArray[np.bool_]:
        """Whether the distance from the origin is not the radius `unit`."""
        off: NDArray[np.bool_] = ~(np.abs(np.sqrt(dot(points, points)) / unit - 1.0) <= slack)
        return off

    def outward(self, points: Array) -> Array:
        """The points themselves."""
        return points

    def stretch(self, points: Array) -> Array:
        """The cube of the distance from the origin, as the triangle is seen from there."""
        return np.asarray(dot(points, points) ** 1.5)

    def right_of(self, tail: Array, head: Array) -> Array:
        """The normal of the great circle through both."""
        return np.cross(head - tail, head + tail)

    def feet(self, points: Array, tail: Array, head: Array, short: float) -> Array:
        """On the great circle through `tail` and `head`."""
        pole, middle = np.cross(head - tail, head + tail), normalize(head + tail)
        size = dot(pole, pole)
        is_short = size < (2.0 * short) ** 2 * dot(middle - points, middle - points)
        pole = pole / np.sqrt(np.where(is_short, 1.0, size))[:, None]
        return np.where(is_short[:, None], middle, normalize(points - dot(points, pole)[:, None] * pole))

    def angles(self, points: Array) -> tuple[Array, Array]:
        """Longitude and latitude."""
        return to_lonlat(points)

    def coordinates(self, points: Array) -> tuple[Array, Array]:
        """Longitude and latitude."""
        return to_lonlat(points)

    def in_words(self, point: Array) -> str:
        """Longitude and latitude."""
        longitude, latitude = np.degrees(to_lonlat(point))
        return f"longitude {longitude:.2f} and latitude {latitude:.2f} degrees"

    def axes(self, longitude: Array, latitude: Array) -> tuple[Array, Array]:
        """East and north."""
        return east_north(longitude, latitude)

    def seen_from(self, centers: Array, axes: Array, points: Array) -> tuple[Array, Array]:
        """Along great circles; distances in radians."""
        chord = points - centers[:, None]
        seen = np.einsum("nkx,nax->nka", chord, axes)
        length = np.linalg.norm(seen, axis=-1)
        arc = np.arctan2(length, dot(points, centers[:, None]))
        return seen / np.where(length > 0.0, length, 1.0)[..., None], arc

    def extent(self, points: Array) -> float:
        """One."""
        return 1.0

    def mean_spacing(self, n_cells: int, area: float) -> float:
        """Radians, for an area in steradians."""
        return mean_spacing(n_cells) * float(np.sqrt(area / self.area))

    def to_centroid(self, square: float) -> float:
        """The chord that belongs to the tangent."""
        root = math.sqrt(1.0 + square)
        return math.sqrt(2.0 * square / (root * (1.0 + root)))

    def curve_places(self, points: Array) -> Array:
        """The points themselves."""
        return points


@row_loop
def _halves_of_kites(points: Array, edges: Array, cells: Index, sides: Index, corners: Array) -> tuple[Array, Array]:
    """Numerators and denominators (n, 6) of `mesh.geometry.sphere.triangle_area`, two triangles for each kite."""
    triples, denominators = np.empty((len(cells), 6)), np.empty((len(cells), 6))
    for row in range(len(cells)):
        corner = vector_to(corners, row)
        for j in range(3):
            cell = vector_to(points, cells[row, j])
            before, after = vector_to(edges, sides[row, j]), vector_to(edges, sides[row, (j + 1) % 3])
            triples[row, 2 * j], denominators[row, 2 * j] = area_parts(cell, corner, before)
            triples[row, 2 * j + 1], denominators[row, 2 * j + 1] = area_parts(cell, after, corner)
    return triples, denominators

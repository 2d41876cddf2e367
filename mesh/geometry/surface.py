"""What a mesh lies on: the unit sphere, or a plane that may repeat itself in x and in y.

Points are rows of arrays (..., 3). On the sphere they are unit vectors and lengths are radians, in the plane z is zero
and both are metres. `surface_of` alone decides which of the two a mesh is on.
"""

from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.geometry.plane import Plane
from mesh.geometry.unit_sphere import UnitSphere


class Surface(Protocol):
    """The geometry that topology, metrics, checks and the model ask for."""

    @property
    def name(self) -> str:
        """What it is, in a word."""

    @property
    def is_flat(self) -> bool:
        """Whether all normals are parallel; compiled loops ask for it."""

    @property
    def handles(self) -> int:
        """How many handles it has: none but where it repeats itself in both directions, which makes it a torus."""

    @property
    def area(self) -> float:
        """Its whole area; not a number where it has no bounds."""

    @property
    def periods(self) -> Array:
        """Lengths (2,) after which it repeats itself in x and y; zero where it does not."""

    def shortest(self, vectors: Array) -> Array:
        """The shortest of the vectors (..., 3) that join the images of the same two points."""

    def distance(self, a: Array, b: Array) -> Array:
        """Distance (...) along the surface."""

    def midpoint(self, a: Array, b: Array) -> Array:
        """The point (..., 3) midway between two."""

    def circumcenter(self, a: Array, b: Array, c: Array) -> Array:
        """The point (..., 3) equidistant from three that run counter-clockwise."""

    def triangle_area(self, a: Array, b: Array, c: Array) -> Array:
        """Signed area (...), positive where a, b, c run counter-clockwise."""

    def kite_areas(self, points: Array, edges: Array, cells: Index, sides: Index, corners: Array) -> Array:
        """Signed areas (n, 3) of the kites from each corner to edge j, to cell j, to edge j + 1.

        `points`, `edges` and `corners` are of cells, edges and vertices, `cells` and `sides` (n, 3) their numbers.
        """

    def onto(self, points: Array) -> Array:
        """The points (n, 3), given but for a common factor, on the surface."""

    def kept_on(self, points: Array) -> Array:
        """The same, but points that are there but for round-off stay as they are, bit for bit."""

    def is_off(self, points: Array, unit: float, slack: float) -> NDArray[np.bool_]:
        """Whether each point (n, 3), in lengths of `unit`, is off by more than the relative `slack`."""

    def outward(self, points: Array) -> Array:
        """Vectors (..., 3) along the normal of the surface at points, those of the sphere unit vectors."""

    def stretch(self, points: Array) -> Array:
        """How much smaller areas (...) are on the surface than on a flat triangle of points near it, at its points."""

    def right_of(self, tail: Array, head: Array) -> Array:
        """Vectors (..., 3), of any length, to the right of the way from `tail` to `head`."""

    def feet(self, points: Array, tail: Array, head: Array, short: float) -> Array:
        """Where the ways (n, 3) from points square to those from `tail` to `head` meet them.

        The middle of a way that is shorter than `short` times that to the point.
        """

    def angles(self, points: Array) -> tuple[Array, Array]:
        """Longitude and latitude, radians, as files have them; zero in the plane."""

    def coordinates(self, points: Array) -> tuple[Array, Array]:
        """What functions of the place are functions of: longitude and latitude in radians, or x and y in metres."""

    def in_words(self, point: Array) -> str:
        """Where a point (3,) is: degrees east and north, or x and y in metres."""

    def axes(self, longitude: Array, latitude: Array) -> tuple[Array, Array]:
        """Unit vectors (..., 3) to the east and the north at `angles`; along x and y in the plane."""

    def seen_from(self, centers: Array, axes: Array, points: Array) -> tuple[Array, Array]:
        """Unit vectors (n, k, 2) in which points (n, k, 3) are seen from centres (n, 3), and distances (n, k).

        `axes` (n, 2, 3) are those of the centres.
        """

    def extent(self, points: Array) -> float:
        """How far points (n, 3) are from the origin, at most: round-off of coordinates is relative to it."""

    def mean_spacing(self, n_cells: int, area: float) -> float:
        """Distance between neighbours if `n_cells` cells of this total area were equal hexagons."""

    def to_centroid(self, square: float) -> float:
        """Distance from a generator to the centroid of its cell, whose moment about it has this square, over the mass.

        On the sphere that is the square of the tangent of an angle, and the distance a chord.
        """

    def curve_places(self, points: Array) -> Array:
        """Vectors (n, 3) along which Hilbert curves on the faces of a cube number the points (n, 3)."""


class OnSurface(Protocol):
    """What says on which surface a mesh is, as `VoronoiMesh` has it."""

    @property
    def sphere_radius(self) -> float:
        """Radius of the sphere, zero on a plane."""

    @property
    def x_period(self) -> float:
        """Length after which a plane repeats itself in x, zero if it does not."""

    @property
    def y_period(self) -> float:
        """The same in y."""


UNIT_SPHERE: Surface = UnitSphere()


def surface_of(mesh: OnSurface) -> Surface:
    """The surface of a mesh, in lengths of its `length_unit`."""
    return UNIT_SPHERE if mesh.sphere_radius > 0.0 else _plane(mesh.x_period, mesh.y_period)


@lru_cache(maxsize=8)
def _plane(x_period: float, y_period: float) -> Surface:
    return Plane(x_period, y_period)

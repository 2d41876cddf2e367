"""The Voronoi mesh of any generators on a plane that is periodic in both directions.

Copies of the generators beside the borders, as far as triangles may reach, make the seams invisible.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from mesh.arrays import Array, Index
from mesh.discrete.build import plane_mesh
from mesh.errors import MeshError
from mesh.geometry.plane import Plane
from mesh.plain import plain_number
from mesh.voronoi_mesh import VoronoiMesh

REACH = 6.0
"""Mean spacings from the border within which generators have copies at first; twice as many if that was not enough."""

FEWEST = 12


def periodic_mesh(points: Array, periods: Sequence[float]) -> VoronoiMesh:
    """The validated Voronoi mesh of generators `points` (n_cells, 2), metres, on a plane with these two `periods`.

    Points are brought to where the plane begins, from zero up to the periods. Raises `MeshError` where they are not
    finite, coincide, are too few or too uneven for a mesh across the seams, or where four stand on one circle, so that
    their triangles differ from seam to seam.
    """
    plane = Plane(*(plain_number("a period of the plane", period) for period in _two(periods)))
    if not (min(plane.x_period, plane.y_period) > 0.0 and np.isfinite(plane.area)):
        raise MeshError(f"the periods are {plane.x_period:g} and {plane.y_period:g} m; give positive, finite ones")
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < FEWEST:
        raise MeshError(f"generators must have shape (n_cells, 2), at least {FEWEST} of them, not {points.shape}")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise MeshError(f"generator {wrong[0]} is {points[wrong[0]].tolist()}, which is no point of a plane")
    within = plane.wrapped(np.column_stack([points, np.zeros(len(points))]))
    return plane_mesh(within, periodic_triangles(within, plane), plane)


def periodic_triangles(points: Array, plane: Plane) -> Index:
    """The Delaunay triangles (2 n, 3) of points (n, 3) within a periodic plane, counter-clockwise, across its seams.

    Raises `MeshError` where there are none.
    """
    reach, longest = REACH * plane.mean_spacing(len(points), plane.area), float(plane.periods.max())
    while True:
        triangles, covered = _triangles(points, plane, min(reach, longest))
        if covered or reach >= longest:
            return triangles
        reach *= 2.0


def _triangles(points: Array, plane: Plane, reach: float) -> tuple[Index, bool]:
    """Triangles of points with copies within `reach` of the border, and whether these reach beyond all circles."""
    places, numbers, shifted = _with_copies(points, plane, reach)
    try:
        corners = Delaunay(places).simplices
    except QhullError as error:
        raise MeshError("the generators have no triangulation; they stand on one line, or coincide") from error
    # Of the images of a triangle, that one stands for all whose corner of the lowest number is no copy.
    lowest = np.argmin(numbers[corners], axis=1)
    of_lowest = corners[np.arange(len(corners)), lowest]
    corners = corners[~shifted[of_lowest]]
    a, b, c = (np.column_stack([places[corners[:, k]], np.zeros(len(corners))]) for k in range(3))
    for one, other in ((a, b), (b, c), (c, a)):
        _require_short(other - one, plane)
    free = Plane(0.0, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        centers = free.circumcenter(a, b, c)
        radii = free.distance(centers, a)[:, None]
    low, high = centers[:, :2] - radii, centers[:, :2] + radii
    covered = bool(((low >= -reach) & (high <= plane.periods + reach)).all())
    return numbers[corners], covered


def _require_short(sides: Array, plane: Plane) -> None:
    """Raise `MeshError` where a side (n, 3) is longer than half a period, so that its ends have a nearer image."""
    if (2.0 * np.abs(sides[:, :2]) >= plane.periods).any():
        raise MeshError(
            "a triangle of the generators is longer than half a period of the plane; give more generators, or spread "
            "them more evenly"
        )


def _with_copies(points: Array, plane: Plane, reach: float) -> tuple[Array, Index, NDArray[np.bool_]]:
    """Places (m, 2) of the points and of their copies, the numbers (m,) of the points, and which are copies."""
    steps = [(east, north) for east in (0, -1, 1) for north in (0, -1, 1)]
    places, numbers = [], []
    for step in steps:
        moved = points[:, :2] + step * plane.periods
        near = ((moved >= -reach) & (moved <= plane.periods + reach)).all(axis=1)
        places.append(moved[near])
        numbers.append(np.flatnonzero(near))
    shifted = np.arange(sum(map(len, numbers))) >= len(points)
    return np.concatenate(places), np.concatenate(numbers), shifted


def _two(values: Sequence[float]) -> tuple[float, float]:
    try:
        first, second = values
    except (TypeError, ValueError):
        raise MeshError(f"the periods are {values!r}; give two lengths in metres, along x and along y") from None
    return first, second

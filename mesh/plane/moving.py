"""Voronoi cells of moving generators in a rectangle: what an optimiser takes in the place of a triangulation."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.errors import MeshError
from mesh.plane.domain import Rectangle
from mesh.plane.images import Images, images_of
from mesh.plane.lifting import far_points, lift, lowered, to_circumcenter
from mesh.triangulation.moving import Triangulation

REACH = 6.0
"""Mean spacings beyond the border to which there are images at first; twice as far where that was not enough."""

TRIANGLE_BLOCK = 2048


class PlaneCells:
    """The Voronoi cells of n generators `points` (n, 3), z = 0, among their images beyond the borders of a rectangle.

    Generators may leave the rectangle, and need not come back. `circumcenters` (m, 3) are those of the triangles
    (m, 3) of generators, their images, and points far away; those round generator i, counter-clockwise, are
    `rings[ring_starts[i]:ring_starts[i + 1]]`. In the triangles, image k has the number n + k.
    """

    def __init__(self, points: Array, plane: Rectangle) -> None:
        """Make the cells; raise `MeshError` where points coincide."""
        self._plane, self._n = plane, len(points)
        self._reach = REACH * plane.spacing(self._n)
        self._far = far_points()
        self._make_images(points)
        if not self._place():
            self._widen(points)

    @property
    def images(self) -> Images:
        """The images of the generators."""
        return self._images

    @property
    def ring_starts(self) -> Index:
        """Where the ring of each generator begins (n + 1,)."""
        return self._triangulation.ring_starts[: self._n + 1]

    @property
    def rings(self) -> Index:
        """Triangles round generators, one ring after the other."""
        return self._triangulation.rings

    @property
    def triangles(self) -> Index:
        """Triangles (m, 3) of generators, images and points far away."""
        return self._triangulation.triangles

    @property
    def places(self) -> Array:
        """Where all corners of triangles are (k, 2), metres."""
        return self._places

    def update(self, points: Array, previous: Array | None = None) -> None:
        """Make the cells those of `points` (n, 3), which come from the `previous` ones if these are given."""
        before = None
        if previous is not None:
            before = np.empty_like(self._lifted)
            self._lift(previous, before)
        self._move_to(points)
        self._triangulation.update(self._lifted, before)
        if not self._place():
            self._make_images(points)
            if not self._place():
                self._widen(points)

    def _widen(self, points: Array) -> None:
        """Take images from farther away, until circles of the cells' triangles hold none that is missing."""
        farthest = 2.0 * float(self._plane.lengths.max())
        while True:
            self._reach *= 2.0
            self._make_images(points)
            if self._place() or self._reach >= farthest:
                return

    def _make_images(self, points: Array) -> None:
        """Images, and the triangulation, from scratch."""
        self._made_at = points[:, :2].copy()
        self._images = images_of(points, self._plane, self._reach)
        low, high = self._images.low, self._images.high
        self._centre, self._radius = 0.5 * (low + high), 0.5 * float(np.hypot(*(high - low)))
        size = self._n + len(self._images.numbers)
        self._places = np.concatenate([np.empty((size, 2)), lowered(self._far, self._centre, self._radius)])
        self._lifted = np.concatenate([np.empty((size, 3)), self._far])
        self._move_to(points)
        try:
            self._triangulation = Triangulation(self._lifted)
        except MeshError as error:
            raise MeshError(_in_one_place(points)) from error

    def _move_to(self, points: Array) -> None:
        size = self._n + len(self._images.numbers)
        self._places[: self._n] = points[:, :2]
        self._places[self._n : size] = self._images.places(points)
        self._drift = float(np.abs(points[:, :2] - self._made_at).max())
        lift(self._places[:size], self._centre, self._radius, self._lifted[:size])

    def _lift(self, points: Array, lifted: Array) -> None:
        """Write what is triangulated for these points to `lifted`."""
        places = np.concatenate([points[:, :2], self._images.places(points)])
        lift(places, self._centre, self._radius, lifted[: len(places)])
        lifted[len(places) :] = self._far

    def _place(self) -> bool:
        """Set the circumcentres; give whether the images reach beyond the circles of all triangles of generators."""
        triangles = self.triangles
        self.circumcenters = np.zeros((len(triangles), 3))
        extents = np.empty(((len(triangles) + TRIANGLE_BLOCK - 1) // TRIANGLE_BLOCK, 4))
        _circumcenters(self._places, triangles, self._n, self.circumcenters, extents)
        low, high = extents[:, :2].min(axis=0), extents[:, 2:].max(axis=0)
        # Images come as near as those that move farthest.
        return bool((low >= self._images.low + self._drift).all() and (high <= self._images.high - self._drift).all())


def _in_one_place(points: Array) -> str:
    """What is wrong with points (n, 3) that cannot be triangulated."""
    order = np.lexsort(points[:, :2].T)
    same = np.flatnonzero((np.diff(points[order], axis=0) == 0.0).all(axis=1))
    if not len(same):
        return "the generators have no triangulation in the plane, as some of them nearly coincide; move these"
    first, second = np.sort(order[same[0] : same[0] + 2])
    return f"generators {first} and {second} are at the same place; leave one of them out"


@numba.njit(parallel=True, cache=True, error_model="numpy", fastmath=False)
def _circumcenters(places: Array, triangles: Index, n: int, centers: Array, extents: Array) -> None:
    """Write circumcentres, x and y, of triangles of places (k, 2) to `centers` (m, 3).

    `extents` (number of blocks, 4) get the least x and y and the largest x and y of the circles of triangles with a
    corner below n.
    """
    for block in numba.prange(len(extents)):
        west, south, east, north = np.inf, np.inf, -np.inf, -np.inf
        for triangle in range(block * TRIANGLE_BLOCK, min((block + 1) * TRIANGLE_BLOCK, len(triangles))):
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            x, y = to_circumcenter(places, a, b, c)
            centers[triangle, 0], centers[triangle, 1] = places[a, 0] + x, places[a, 1] + y
            if a < n or b < n or c < n:
                radius = np.sqrt(x * x + y * y)
                west, east = min(west, centers[triangle, 0] - radius), max(east, centers[triangle, 0] + radius)
                south, north = min(south, centers[triangle, 1] - radius), max(north, centers[triangle, 1] + radius)
        extents[block, 0], extents[block, 1], extents[block, 2], extents[block, 3] = west, south, east, north

"""The Voronoi cells of moving places in the plane, triangulated on the sphere: what `mesh.coast` then clips."""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.plane.lifting import far_points, lift, lowered, to_circumcenter
from mesh.triangulation.moving import Triangulation

WIDER = 2.0
"""Times the smallest circle round the box of a polygon, the one that is lifted to the equator: so that places far from
there are farther from any point of the polygon than its generators are."""


class Lifting:
    """How places in and around a polygon of these `points` (m, 3) are lifted to the unit sphere."""

    def __init__(self, points: Array) -> None:
        low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
        self._centre, self._radius = 0.5 * (low + high), 0.5 * WIDER * float(np.hypot(*(high - low)))

    @property
    def far_places(self) -> Array:
        """Places (k, 3), z = 0, far from the polygon, which surround the sphere together with those in it."""
        places = lowered(far_points(), self._centre, self._radius)
        return np.column_stack([places, np.zeros(len(places))])

    def lifted(self, places: Array) -> Array:
        """Unit vectors (n, 3) for places (n, 3)."""
        points = np.empty((len(places), 3))
        lift(places[:, :2], self._centre, self._radius, points)
        return points


class LiftedCells:
    """The cells of n places (n, 3), z = 0, as `mesh.triangulation.moving.MovingCells` has them.

    Among the places are `Lifting.far_places`, whose own cells have no meaning.
    """

    def __init__(self, places: Array, lifting: Lifting) -> None:
        """Make the cells; raise `MeshError` where places coincide."""
        self._lifting = lifting
        self._triangulation = Triangulation(lifting.lifted(places))
        self._set_circumcenters(places)

    @property
    def ring_starts(self) -> Index:
        """Where the ring of each place begins (n + 1,)."""
        return self._triangulation.ring_starts

    @property
    def rings(self) -> Index:
        """Triangles round places, one ring after the other."""
        return self._triangulation.rings

    @property
    def triangles(self) -> Index:
        """Triangles (m, 3) of the places."""
        return self._triangulation.triangles

    def update(self, points: Array, previous: Array | None = None) -> None:
        """Make the cells those of places `points` (n, 3), which come from the `previous` ones if these are given."""
        lifted = self._lifting.lifted
        self._triangulation.update(lifted(points), None if previous is None else lifted(previous))
        self._set_circumcenters(points)

    def _set_circumcenters(self, places: Array) -> None:
        self.circumcenters = np.zeros((len(self.triangles), 3))
        _circumcenters(places, self.triangles, self.circumcenters)


@numba.njit(parallel=True, cache=True, error_model="numpy", fastmath=False)
def _circumcenters(places: Array, triangles: Index, centers: Array) -> None:
    """Write x and y of the circumcentres of triangles of places (n, 3) to `centers` (m, 3)."""
    for triangle in numba.prange(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        x, y = to_circumcenter(places, a, b, c)
        centers[triangle, 0], centers[triangle, 1] = places[a, 0] + x, places[a, 1] + y

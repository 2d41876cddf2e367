"""The walls of a polygon in the plane: what a coastline is on the sphere (`mesh.coast.coastline.Coast`)."""

from collections.abc import Sequence
from functools import cached_property

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.coast.coastline import joined_rings
from mesh.geometry.plane import Plane
from mesh.geometry.sphere import hexagon_spacing
from mesh.geometry.surface import Surface

SHARP = np.radians(30.0)
"""How much a polygon turns, at least, where two of its walls meet in a vertex of the mesh."""


class Walls:
    """Closed rings of straight walls between `points` (m, 3), metres, z = 0; the polygon, in one part, to their left.

    Ring r has the points `ring_starts[r]` to `ring_starts[r + 1] - 1`; `following` (m,) is the next point of the ring.
    The mesh is to have so many `cells`.
    """

    surface: Surface = Plane(0.0, 0.0)
    wider = "a polygon without such narrow parts"

    def __init__(self, rings: Sequence[Array], cells: int) -> None:
        """Take rings (m_r, 3), without repetition of points, the one round the polygon and those of its holes."""
        self.points, self.ring_starts, self.following = joined_rings(rings)
        self._cells = cells

    @property
    def n_rings(self) -> int:
        """Number of closed rings."""
        return len(self.ring_starts) - 1

    @cached_property
    def area(self) -> float:
        """Area of the polygon, m2."""
        x, y = (self.points - self.points[0]).T[:2]
        return 0.5 * float(np.sum(x * y[self.following] - y * x[self.following]))

    @cached_property
    def spacing(self) -> float:
        """Distance of neighbours if that many equal hexagons filled the polygon, metres."""
        return float(hexagon_spacing(np.array(self.area / self._cells)))

    @cached_property
    def corners(self) -> NDArray[np.bool_]:
        """The corners (m,) that stick out, where two walls meet that are at least a spacing long each.

        Where a polygon turns inwards no area would belong to such a vertex, and what turns oftener than there are cells
        would give them more sides than they can use; so edges bend there.
        """
        steps = self.points[self.following] - self.points
        before = np.empty_like(steps)
        before[self.following] = steps
        turn = np.arctan2(before[:, 0] * steps[:, 1] - before[:, 1] * steps[:, 0], (before * steps).sum(axis=1))
        shorter = np.minimum(np.linalg.norm(before, axis=1), np.linalg.norm(steps, axis=1))
        sticking_out: NDArray[np.bool_] = (turn > SHARP) & (shorter >= self.spacing)
        return sticking_out

    def distance(self, points: Array) -> Array:
        """Distance (n,) of points (n, 3) from the nearest wall, metres, positive inside and negative outside."""
        distances = np.empty(len(points))
        _signed_distances(points, self.points, self.following, distances)
        return distances

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in the polygon."""
        return self.distance(points) > 0.0


@numba.njit(parallel=True, cache=True, fastmath=False)
def _signed_distances(points: Array, walls: Array, following: Index, distances: Array) -> None:
    """Write the distances of points (n, 3) from all walls; from inside, a ray along x crosses an odd number of them."""
    for row in numba.prange(len(points)):
        x, y = points[row, 0], points[row, 1]
        least, sign = np.inf, -1.0
        for start in range(len(walls)):
            end = following[start]
            ux, uy = walls[end, 0] - walls[start, 0], walls[end, 1] - walls[start, 1]
            vx, vy = x - walls[start, 0], y - walls[start, 1]
            part = min(max((ux * vx + uy * vy) / (ux * ux + uy * uy), 0.0), 1.0)
            across, up = vx - part * ux, vy - part * uy
            least = min(least, across * across + up * up)
            if (walls[start, 1] > y) != (walls[end, 1] > y) and vx < ux * vy / uy:
                sign = -sign
        distances[row] = sign * np.sqrt(least)

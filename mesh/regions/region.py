"""A region of the sphere: which points lie in it, how far its coast is, and its coastline for a mesh."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.regions.coastline import smooth_coastline
from mesh.regions.outline import Outline
from mesh.shown import Rows, Shown, in_words

HALF_WIDTH = 0.6
"""In spacings, of an isthmus: more than half, so that it stays where spits that are as narrow as a cell go."""


@dataclass(frozen=True, eq=False, repr=False)
class Region(Shown):
    """A part of the sphere, called the sea; the rest is land, and between them runs the coast.

    `signed_distance` takes unit vectors (n, 3) and gives radians (n,) to the coast, positive in the sea and negative
    on land. `inside`, where there is one, tells exactly which of them lie in the sea (n,). `isthmuses` are lines on
    land that keep seas apart, however coarse the mesh.
    """

    name: str
    signed_distance: Callable[[Array], Array]
    inside: Callable[[Array], NDArray[np.bool_]] | None = None
    isthmuses: Outline | None = None

    def contains(self, points: Array, reach: Array | float = 0.0) -> NDArray[np.bool_]:
        """Which of the unit vectors (n, 3) lie in the sea (n,), and not within `reach`, radians, of an isthmus.

        With the radii (n,) of cells as their reach, no two seas touch across an isthmus that is narrower than cells.
        """
        at_sea = self.signed_distance(points) > 0.0 if self.inside is None else self.inside(points)
        return at_sea if self.isthmuses is None else at_sea & (self.isthmuses.distance(points) > reach)

    def distance(self, points: Array) -> Array:
        """Distance (n,) of unit vectors (n, 3) to the coast, radians, positive in the sea and negative on land."""
        return self.signed_distance(points)

    def coastline(self, spacing: float, all_seas: bool = False) -> list[Array]:
        """Closed rings (m, 3) of unit vectors, the sea to their left, smoothed for cells of a `spacing` in radians.

        The coast of the largest connected sea, the longest ring first, or of `all_seas`; see `smooth_coastline`.
        Raises `MeshError` where no sea is as wide as the spacing.
        """

        def with_isthmuses(points: Array) -> Array:
            distance = self.distance(points)
            if self.isthmuses is None:
                return distance
            return np.minimum(distance, self.isthmuses.distance(points) - HALF_WIDTH * spacing)

        return smooth_coastline(with_isthmuses, spacing, all_seas, self.name)

    def _title_and_rows(self) -> tuple[str, Rows]:
        rows = {"points in it": "by the sign of the distance to its coast" if self.inside is None else "told exactly"}
        if self.isthmuses is not None:
            rows["isthmuses"] = f"{len(self.isthmuses.starts)} arcs on land that keep seas apart"
        return f"Region {in_words(self.name)}", rows

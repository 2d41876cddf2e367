"""Rectangles of the plane that repeat themselves, or have walls, in each direction."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.geometry.plane import Plane
from mesh.plain import plain_number

PERIODIC = ("xy", "x", "none")
"""Directions in which a plane may repeat itself; there are walls at the other ends."""

SHORTEST, LONGEST = 1e-6, 1e15
"""Lengths of planes, metres; far beyond these, areas and their products leave the range of floats."""


@dataclass(frozen=True)
class Rectangle:
    """Points with x from zero to `width` and y from zero to `height`, metres.

    It is `periodic` in "xy", in "x" (a channel between two walls) or in no direction, "none" (a closed box).
    """

    width: float
    height: float
    periodic: str = "xy"

    def __post_init__(self) -> None:
        if self.periodic not in PERIODIC:
            raise MeshError(f"a plane cannot be periodic in '{self.periodic}'; choose one of {', '.join(PERIODIC)}")
        for length in (self.width, self.height):
            if not SHORTEST <= length <= LONGEST:
                raise MeshError(
                    f"a length of the plane is {length:g} m; it must be {SHORTEST:g} m at least and {LONGEST:g} m "
                    "at most"
                )

    @cached_property
    def lengths(self) -> Array:
        """Width and height (2,)."""
        return np.array([self.width, self.height])

    @property
    def repeats(self) -> tuple[bool, bool]:
        """Whether it repeats itself in x, and in y."""
        return "x" in self.periodic, "y" in self.periodic

    @property
    def area(self) -> float:
        """Its area, m2."""
        return self.width * self.height

    @cached_property
    def surface(self) -> Plane:
        """The plane with its periods."""
        return Plane(*(length if repeats else 0.0 for length, repeats in zip(self.lengths, self.repeats, strict=True)))

    def spacing(self, cells: int) -> float:
        """Distance of neighbours if so many equal hexagons filled it, metres."""
        return self.surface.mean_spacing(cells, self.area)

    def folded(self, points: Array) -> Array:
        """The points (n, 3) of the rectangle that are images of `points`: shifted by periods, mirrored by walls."""
        inside = points.copy()
        for axis, (length, repeats) in enumerate(zip(self.lengths, self.repeats, strict=True)):
            if repeats:
                inside[:, axis] %= length
                inside[inside[:, axis] >= length, axis] = 0.0
            else:
                along = inside[:, axis] % (2.0 * length)
                inside[:, axis] = np.minimum(along, 2.0 * length - along)
        return inside


def rectangle(lengths: Sequence[float], periodic: str) -> Rectangle:
    """The rectangle of lengths (LX, LY), metres; raises `MeshError` where there is none."""
    width, height = (plain_number("a length of the plane", length) for length in pair("the plane", lengths))
    return Rectangle(width, height, periodic)


def pair(what: str, values: Sequence[float]) -> tuple[float, float]:
    """Two values, along x and along y; raise `MeshError` where `values` are not two."""
    try:
        first, second = values
    except (TypeError, ValueError):
        raise MeshError(f"{what} is {values!r}; give two numbers, along x and along y") from None
    return first, second

"""Points to start from in rectangles and polygons: how they are drawn from a density, and numbered."""

from collections.abc import Callable

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.plane.domain import Rectangle
from mesh.plane.starts import rows_of_points, starting_points
from mesh.polygon import starts
from mesh.polygon.walls import Walls

RIGHT, TOP = 4.0, 6.0
"""A room that is not at the origin, so that places in its box are others than places in the plane."""


def in_rectangle(count: int, density: Callable[[Array], Array], start: str | None, seed: int) -> Array:
    return starting_points(Rectangle(RIGHT, TOP, "none"), count, density, start, seed)


def in_room(count: int, density: Callable[[Array], Array], start: str | None, seed: int) -> Array:
    corners = np.array([[1.0, 2.0, 0.0], [RIGHT, 2.0, 0.0], [RIGHT, TOP, 0.0], [1.0, TOP, 0.0]])
    return starts.starting_points(Walls([corners], count), count, density, start, seed)


def denser_in_the_corner(points: Array) -> Array:
    """Sixteen in a square of an area of one, one elsewhere."""
    return np.where((points[:, 0] > RIGHT - 1.0) & (points[:, 1] > TOP - 1.0), 16.0, 1.0)


@pytest.mark.parametrize(("drawn", "area"), [(in_rectangle, 24.0), (in_room, 12.0)])
@pytest.mark.parametrize(("start", "value"), [("random", 16.0), ("random-root", 4.0), (None, 4.0)])
def test_points_are_drawn_from_the_density_or_its_root(
    drawn: Callable[..., Array], area: float, start: str | None, value: float
) -> None:
    points = drawn(20_000, denser_in_the_corner, start, 1)
    share = (denser_in_the_corner(points) > 1.0).mean()
    # Four standard deviations.
    assert share == pytest.approx(value / (value + area - 1.0), abs=0.015)
    assert not np.array_equal(points, drawn(20_000, denser_in_the_corner, start, 2))


@pytest.mark.parametrize("drawn", [in_rectangle, in_room])
def test_points_are_numbered_along_a_curve(drawn: Callable[..., Array]) -> None:
    points = drawn(1000, denser_in_the_corner, "random", 1)
    assert np.median(np.linalg.norm(np.diff(points, axis=0), axis=1)) < 0.2


def test_rows_of_periodic_planes_are_even_in_number() -> None:
    """Else the first and the last, neighbours across the seam, would not be shifted to each other."""
    for count in range(20, 400, 7):
        plane = Rectangle(1.0, 1.3)
        assert len(np.unique(rows_of_points(plane, count)[:, 1])) % 2 == 0
    boxes = {len(np.unique(rows_of_points(Rectangle(1.0, 1.3, "x"), count)[:, 1])) % 2 for count in range(20, 400, 7)}
    assert boxes == {0, 1}

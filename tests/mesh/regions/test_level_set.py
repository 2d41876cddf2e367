"""Lines where a function is zero: a circle, two of them, nothing; and the connected parts between."""

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, from_lonlat
from mesh.regions.level_set import level_set
from mesh.regions.outline import Outline
from tests.mesh.regions.rings import area_within, crossings

CENTER = from_lonlat(np.array(1.0), np.array(0.3))


def cap(points: Array) -> Array:
    """Positive within half a radian of `CENTER`."""
    return 0.5 - arc_length(points, CENTER)


def test_a_circle() -> None:
    found = level_set(cap, 0.02)
    (ring,) = (found.vertices[ring] for ring in found.rings())
    assert np.abs(cap(ring)).max() < 0.02**2
    assert np.isclose(area_within([ring]), 2 * np.pi * (1 - np.cos(0.5)), rtol=1e-3)
    assert set(found.sea) == {found.largest_sea}
    assert crossings([ring]) == 0


def test_it_costs_what_is_near_the_line() -> None:
    counts = []

    def counted(points: Array) -> Array:
        counts.append(len(points))
        return cap(points)

    level_set(counted, 0.005)
    assert sum(counts) < 20 * np.pi / 0.005  # a whole sphere of such triangles has 600 000 corners


def test_a_small_island_between_coarse_triangles_is_found() -> None:
    found = level_set(lambda points: arc_length(points, CENTER) - 0.001, 0.0005)
    (ring,) = (found.vertices[ring] for ring in found.rings())
    assert np.isclose(-area_within([ring]), np.pi * 0.001**2, rtol=0.05)


def test_a_ring_belongs_to_the_sea_on_its_left() -> None:
    """A sea round the north pole, a land with a lake, and another sea beyond."""

    def bands(points: Array) -> Array:
        latitude = np.arcsin(points[:, 2])
        return np.maximum(np.maximum(latitude - 1.0, 0.2 - np.abs(latitude - 0.4)), -latitude - 0.1)

    found = level_set(bands, 0.03)
    height = {float(np.round(found.vertices[ring][:, 2].mean(), 2)): int(found.sea[ring[0]]) for ring in found.rings()}
    levels = [float(np.round(np.sin(latitude), 2)) for latitude in (1.0, 0.6, 0.2, -0.1)]
    assert sorted(height) == sorted(levels)
    pole, north, south, largest = (height[level] for level in levels)
    assert north == south
    assert len({pole, north, largest}) == 3
    assert found.largest_sea == largest


@pytest.mark.parametrize("value", [1.0, -1.0])
def test_no_line(value: float) -> None:
    found = level_set(lambda points: np.full(len(points), value), 0.1)
    assert found.rings() == []
    assert (found.largest_sea is None) == (value < 0.0)


def test_the_distance_to_arcs_is_that_to_their_inside_and_ends() -> None:
    equator = from_lonlat(np.radians([0.0, 1.0, 2.0]), np.zeros(3))
    outline = Outline(equator[:-1], equator[1:])
    points = from_lonlat(np.radians([0.3, 1.5, -2.0, 179.0]), np.radians([1.0, -2.0, 0.0, 0.0]))
    np.testing.assert_allclose(np.degrees(outline.distance(points)), [1.0, 2.0, 2.0, 177.0], rtol=1e-9)
    assert (Outline(equator[:0], equator[:0]).distance(points) == np.pi).all()

"""Coastlines: distances to them, the area of the sea, and points to start from."""

import numpy as np
import pytest

from mesh import MeshError
from mesh.coast.coastline import Coastline
from mesh.coast.start import fillers, sea_spacing, starting_points
from mesh.geometry.sphere import fibonacci_points, from_lonlat
from tests.mesh.coast.shores import POLE, RADIUS, wavy_ring, wavy_sea


@pytest.mark.parametrize("sea_within", [True, False])
def test_area_and_distance_of_a_cap(sea_within: bool) -> None:
    coast = Coastline([wavy_ring(2000, amplitude=0.0, sea_within=sea_within)])
    cap = 2.0 * np.pi * (1.0 - np.cos(RADIUS))
    assert coast.area == pytest.approx(cap if sea_within else 4.0 * np.pi - cap, rel=1e-5)
    points = fibonacci_points(3000)
    exact = 2.0 * np.sin(0.5 * (RADIUS - np.arccos(points @ POLE))) * (1.0 if sea_within else -1.0)
    np.testing.assert_allclose(coast.distance(points), exact, atol=1e-5)


def test_distance_is_that_to_the_nearest_of_all_arcs() -> None:
    coast = wavy_sea(600)
    points = fibonacci_points(500)
    along = np.linspace(0.0, 1.0, 60)[:, None, None]
    samples = (coast.points + along * (coast.points[coast.following] - coast.points)).reshape(-1, 3)
    nearest = np.array([np.linalg.norm(samples - point, axis=1).min() for point in points])
    np.testing.assert_allclose(np.abs(coast.distance(points)), nearest, atol=2e-4)


def test_an_acute_corner_has_land_all_round_but_within_it() -> None:
    corners = from_lonlat(np.radians(np.array([0.0, 20.0, 20.0])), np.radians(np.array([0.0, 0.0, 5.0])))
    coast = Coastline([corners])
    beyond = from_lonlat(np.radians(np.array([-1.0, -1.0, -1.0, 15.0])), np.radians(np.array([0.0, 1.0, -1.0, 1.0])))
    np.testing.assert_array_equal(coast.contains(beyond), [False, False, False, True])


@pytest.mark.parametrize("start", ["fibonacci", "random", "random-root"])
def test_starting_points_lie_in_the_sea(start: str) -> None:
    coast = wavy_sea(300)
    points = starting_points(coast, 300, lambda x: 1.0 + 9.0 * (x[:, 2] > 0.6), start)
    assert points.shape == (300, 3)
    assert coast.contains(points).all()
    at_dense = {"fibonacci": 0.49, "random": 0.88, "random-root": 0.70}
    assert np.mean(points[:, 2] > 0.6) == pytest.approx(at_dense[start], abs=0.06)


def test_fillers_stand_far_inland() -> None:
    coast = wavy_sea(300)
    spacing = sea_spacing(coast, 300)
    assert coast.distance(fillers(coast, spacing)).max() < -2.9 * spacing


def test_what_cannot_be_a_coast_is_refused() -> None:
    with pytest.raises(MeshError, match="no coast"):
        Coastline([])
    with pytest.raises(MeshError, match="ring 0 of the coast has 2 points"):
        Coastline([fibonacci_points(2)])
    with pytest.raises(MeshError, match="point 1 twice"):
        Coastline([fibonacci_points(5)[[0, 1, 1, 3]]])


def test_unknown_starts_and_too_few_cells_are_refused() -> None:
    with pytest.raises(MeshError, match="cannot start from 'icosahedral'"):
        starting_points(wavy_sea(300), 300, start="icosahedral")
    with pytest.raises(MeshError, match="too small"):
        starting_points(wavy_sea(300), 5)

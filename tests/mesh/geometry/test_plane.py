"""The plane as a surface: nearest images, and what follows from them across the seams."""

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.geometry.plane import Plane
from mesh.geometry.surface import UNIT_SPHERE, surface_of
from mesh.geometry.unit_sphere import UnitSphere
from mesh.geometry.vectors import nearest_image
from mesh.plane.hexagons import hexagon_mesh

PLANE = Plane(10.0, 6.0)


def point(x: float, y: float) -> Array:
    return np.array([[x, y, 0.0]])


def test_ways_lead_to_the_nearest_image() -> None:
    np.testing.assert_allclose(PLANE.distance(point(0.5, 0.5), point(9.5, 5.5)), np.sqrt(2.0), rtol=1e-15)
    np.testing.assert_array_equal(PLANE.shortest(point(9.0, -5.0)), point(-1.0, 1.0))
    np.testing.assert_array_equal(Plane(10.0, 0.0).shortest(point(9.0, -5.0)), point(-1.0, -5.0))
    assert nearest_image((9.0, -5.0, 0.0), PLANE.periods) == (-1.0, 1.0, 0.0)


def test_middles_and_circumcentres_are_found_across_seams() -> None:
    np.testing.assert_allclose(PLANE.midpoint(point(9.5, 1.0), point(1.5, 1.0)), point(0.5, 1.0), atol=1e-15)
    corners = (point(9.0, 5.0), point(1.0, 5.0), point(0.0, 1.0))
    center = PLANE.circumcenter(*corners)
    assert (center >= 0.0).all()
    assert (center[0, :2] < PLANE.periods).all()
    distances = [PLANE.distance(center, corner)[0] for corner in corners]
    np.testing.assert_allclose(distances, distances[0], rtol=1e-14)


def test_a_foot_is_on_the_line_across_a_seam() -> None:
    foot = PLANE.feet(point(9.0, 2.0), point(1.0, 0.5), point(1.0, 5.5), 1e-6)
    np.testing.assert_allclose(foot, point(1.0, 2.0), atol=1e-15)
    short = PLANE.feet(point(9.0, 2.0), point(1.0, 0.5), point(1.0, 0.5), 1e-6)
    np.testing.assert_array_equal(short, point(1.0, 0.5))


def test_the_right_is_clockwise_of_the_way() -> None:
    np.testing.assert_array_equal(PLANE.right_of(point(9.0, 1.0), point(1.0, 1.0)), point(0.0, -2.0))


def test_points_off_the_plane_are_told() -> None:
    points = np.array([[0.0, 0.0, 0.0], [5.0, 1.0, 1e-3]])
    assert PLANE.is_off(points, 1.0, 1e-6).tolist() == [False, True]
    # The slack is beside the extent of the points, as round-off is.
    assert PLANE.is_off(points * [1e4, 1e4, 1.0], 1.0, 1e-6).tolist() == [False, False]


def test_which_surface_a_mesh_is_on_and_its_handles() -> None:
    mesh = hexagon_mesh((4.0, 2.0 * np.sqrt(3.0)), (4, 4))
    assert surface_of(mesh) == Plane(4.0, mesh.y_period)
    assert [Plane(*periods).handles for periods in ((1.0, 1.0), (1.0, 0.0), (0.0, 0.0))] == [1, 0, 0]
    assert np.isnan(Plane(1.0, 0.0).area)
    assert not UNIT_SPHERE.is_flat


@pytest.mark.parametrize("shift", [0.0, 1e7])
def test_a_curve_through_a_plane_keeps_neighbours(shift: float) -> None:
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(8.0), np.arange(8.0)))
    places = PLANE.curve_places(np.column_stack([x + shift, y, np.zeros(64)]))
    assert (np.abs(places[:, 1:]) <= 1.0).all()
    np.testing.assert_allclose(np.ptp(places, axis=0), [0.0, 2.0, 2.0])


def test_triangles_that_run_clockwise_have_negative_areas() -> None:
    a, b, c = np.array([[9.0, 1.0, 0.0], [1.0, 1.0, 0.0], [9.0, 5.0, 0.0]])
    assert Plane(0.0, 0.0).triangle_area(a, b, c) == -16.0
    assert Plane(10.0, 0.0).triangle_area(a, b, c) == 4.0


def test_places_are_told_in_the_coordinates_of_their_surface() -> None:
    assert Plane(0.0, 0.0).in_words(np.array([2.5e5, 1.0, 0.0])) == "x = 250000, y = 1 m"
    assert UnitSphere().in_words(np.array([0.0, 0.6, 0.8])) == "longitude 90.00 and latitude 53.13 degrees"

import numpy as np
import pytest

from mesh.geometry.sphere import arc_length, circumcenter, east_north, from_lonlat, normalize, to_lonlat, triangle_area

X, Y, Z = np.eye(3)


def test_octant_has_an_eighth_of_the_area_with_the_sign_of_its_orientation() -> None:
    assert triangle_area(X, Y, Z) == pytest.approx(np.pi / 2, rel=1e-15)
    assert triangle_area(X, Z, Y) == pytest.approx(-np.pi / 2, rel=1e-15)


@pytest.mark.parametrize("size", [1e-1, 1e-3, 1e-5])
def test_small_triangles_keep_their_relative_precision(size: float) -> None:
    a = normalize(np.array([0.3, 0.5, -0.8]))
    east, north = east_north(*to_lonlat(a))
    b, c = normalize(a + size * east), normalize(a + size * north)
    plane = 0.5 * size**2
    assert triangle_area(a, b, c) == pytest.approx(plane, rel=2 * size**2 + 1e-10, abs=0.0)
    assert arc_length(a, b) == pytest.approx(np.arctan(size), rel=1e-10)


def test_arc_between_opposite_points_is_pi() -> None:
    assert arc_length(X, -X) == np.pi


def test_circumcenter_is_equidistant_and_on_the_side_of_the_triangle() -> None:
    corners = normalize(np.random.default_rng(0).normal(size=(50, 3, 3)))
    center = circumcenter(corners[:, 0], corners[:, 1], corners[:, 2])
    distances = [arc_length(center, corners[:, k]) for k in range(3)]
    np.testing.assert_allclose(distances[1], distances[0], rtol=1e-12)
    np.testing.assert_allclose(distances[2], distances[0], rtol=1e-12)
    np.testing.assert_array_equal(
        np.sign(triangle_area(corners[:, 0], corners[:, 1], corners[:, 2])), np.sign((center * corners[:, 0]).sum(1))
    )


def test_longitude_and_latitude_round_trip() -> None:
    points = normalize(np.random.default_rng(1).normal(size=(100, 3)))
    lon, lat = to_lonlat(points)
    assert lon.min() >= 0.0
    assert lon.max() < 2 * np.pi
    np.testing.assert_allclose(from_lonlat(lon, lat), points, atol=1e-15)


def test_longitude_just_below_zero_stays_in_range() -> None:
    lon, _ = to_lonlat(np.array([1.0, -1e-20, 0.0]))
    assert 0.0 <= lon < 2 * np.pi


def test_east_and_north_are_right_handed() -> None:
    lon, lat = np.array([0.3, 4.0]), np.array([-0.7, 1.2])
    east, north = east_north(lon, lat)
    np.testing.assert_allclose(np.cross(east, north), from_lonlat(lon, lat), atol=1e-15)

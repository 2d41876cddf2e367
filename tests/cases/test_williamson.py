from dataclasses import replace

import numpy as np
import pytest

from cases import Williamson1, Williamson2, Williamson5, Williamson6
from mesh import VoronoiMesh
from mesh.discrete.operators import velocity_at_cells
from mesh.geometry.sphere import arc_length, from_lonlat
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError

ANGLES = (0.0, 0.05, np.pi / 2 - 0.05, np.pi / 2)


def everywhere() -> tuple[np.ndarray, np.ndarray]:
    longitude, latitude = np.meshgrid(np.linspace(0, 2 * np.pi, 121), np.linspace(-np.pi / 2, np.pi / 2, 61))
    return longitude.ravel(), latitude.ravel()


@pytest.mark.parametrize("angle", ANGLES)
def test_bell_goes_round_in_twelve_days(angle: float) -> None:
    case = Williamson1(angle=angle)
    longitude, latitude = everywhere()
    start = case.thickness(longitude, latitude)
    assert start.max() == pytest.approx(2000.0)
    assert start.min() == 1000.0
    np.testing.assert_allclose(case.thickness(longitude, latitude, 12 * SECONDS_PER_DAY), start, atol=1e-9)
    assert np.abs(case.thickness(longitude, latitude, 6 * SECONDS_PER_DAY) - start).max() > 999.0


@pytest.mark.parametrize(
    ("angle", "longitude", "latitude"), [(0.0, 0.0, 0.0), (np.pi / 2, 1.5 * np.pi, np.pi / 2)], ids=["east", "north"]
)
def test_bell_is_a_quarter_of_the_way_after_three_days(angle: float, longitude: float, latitude: float) -> None:
    """Eastward along the equator, or over the north pole; not the other way round."""
    case = Williamson1(angle=angle)
    lon, lat = np.array([longitude]), np.array([latitude])
    assert case.thickness(lon, lat, 3 * SECONDS_PER_DAY)[0] == pytest.approx(2000.0)
    halfway = case.thickness(lon, lat + (case.bell_radius / 2 if latitude == 0 else -case.bell_radius / 2), 259200.0)
    assert halfway[0] == pytest.approx(1500.0)


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_bell_is_carried_by_the_wind(angle: float) -> None:
    """The derivative in time is minus wind times gradient, by differences."""
    case = Williamson1(angle=angle, bell_latitude=0.4)
    random = np.random.default_rng(0)
    longitude, latitude = 1.5 * np.pi + random.uniform(-0.3, 0.3, 200), 0.4 + random.uniform(-0.3, 0.3, 200)
    distance = arc_length(from_lonlat(longitude, latitude), from_lonlat(np.array(1.5 * np.pi), np.array(0.4)))
    inside = np.abs(distance - case.bell_radius) > 0.01  # where the second derivative does not jump
    longitude, latitude = longitude[inside], latitude[inside]
    zonal, meridional = case.velocity(longitude, latitude)
    step, seconds = 1e-4, 60.0
    by_time = (case.thickness(longitude, latitude, seconds) - case.thickness(longitude, latitude, -seconds)) / 120.0
    east = (case.thickness(longitude + step, latitude) - case.thickness(longitude - step, latitude)) / (2 * step)
    north = (case.thickness(longitude, latitude + step) - case.thickness(longitude, latitude - step)) / (2 * step)
    carried = -(zonal * east / np.cos(latitude) + meridional * north) / case.radius
    np.testing.assert_allclose(by_time, carried, atol=1e-5 * np.abs(carried).max())
    assert np.abs(carried).max() > 0.01


def test_mountain_is_a_cone_of_the_given_height() -> None:
    case = Williamson5()
    lon = np.array([1.5 * np.pi, 1.5 * np.pi, 1.5 * np.pi + np.pi / 18, 0.0])
    lat = np.array([np.pi / 6, np.pi / 6 + np.pi / 9, np.pi / 6, np.pi / 6])
    np.testing.assert_allclose(case.topography(lon, lat), [2000.0, 0.0, 1000.0, 0.0], atol=1e-9)
    surface = case.thickness(lon, lat) + case.topography(lon, lat)
    np.testing.assert_allclose(surface[[0, 2, 3]], surface[0], rtol=1e-14)
    assert case.thickness(np.array([0.0]), np.array([0.0]))[0] == 5960.0


def test_mountain_may_stand_on_the_prime_meridian() -> None:
    case = Williamson5(mountain_longitude=0.0)
    east, west = case.topography(np.array([0.1, 2 * np.pi - 0.1]), np.array([0.5, 0.5]))
    assert east == pytest.approx(west)
    assert east > 0.0


def test_wind_blows_eastward_at_its_speed(larger_mesh: VoronoiMesh) -> None:
    case = Williamson5()
    mesh = larger_mesh.scaled(case.radius)
    zonal, meridional = velocity_at_cells(mesh, case.initial_state(mesh).normal_velocity)
    np.testing.assert_allclose(zonal, 20.0 * np.cos(mesh.lat_cell), atol=0.05)
    np.testing.assert_allclose(meridional, 0.0, atol=0.05)


def test_turned_wind_blows_over_the_poles() -> None:
    case = Williamson2(angle=np.pi / 2)
    zonal, meridional = case.velocity(np.array([0.5 * np.pi, 1.5 * np.pi, 0.0]), np.zeros(3))
    np.testing.assert_allclose(meridional, [-case.wind_speed, case.wind_speed, 0.0], atol=1e-14)
    np.testing.assert_allclose(zonal, 0.0, atol=1e-14)


def test_rossby_haurwitz_wave_where_its_formulae_are_short() -> None:
    """At the equator and the poles, worked out by hand from the paper."""
    case = Williamson6()
    a, g, omega = case.radius, case.gravity, case.angular_velocity
    crest, trough, pole = np.array([0.0, np.pi / 4, 1.0]), np.array([0.0, 0.0, np.pi / 2]), np.array([8000.0])
    depth = case.thickness(crest, trough)
    zonal_part = 0.5 * omega * (2 * case.rotation_rate + omega) - 0.5 * omega**2
    wave_part = 2 * (case.rotation_rate + omega) * omega / 30
    np.testing.assert_allclose(depth[0], 8000.0 + a**2 / g * (zonal_part + wave_part), rtol=1e-14)
    np.testing.assert_allclose(depth[1], 8000.0 + a**2 / g * (zonal_part - wave_part), rtol=1e-14)
    np.testing.assert_allclose(depth[2:], pole, rtol=1e-14)
    zonal, meridional = case.velocity(crest, trough)
    np.testing.assert_allclose(zonal, [0.0, 2 * a * omega, 0.0], atol=1e-12)
    np.testing.assert_allclose(meridional, 0.0, atol=1e-12)


def test_rossby_haurwitz_wave_has_four_crests() -> None:
    case = Williamson6()
    longitude, latitude = everywhere()
    np.testing.assert_allclose(
        case.thickness(longitude + np.pi / 2, latitude), case.thickness(longitude, latitude), rtol=1e-13
    )
    assert np.abs(case.thickness(longitude + np.pi / 4, latitude) - case.thickness(longitude, latitude)).max() > 500.0
    with pytest.raises(InputError, match="wave_number is 0; it must be 1 to 200"):
        replace(case, wave_number=0)

"""What cases declare, beside the papers: parameters, days, accepted orders, and words about units."""

import numpy as np
import pytest

from cases import CASES, find_case
from cases.parameters import units_and_meanings
from swe import constants
from swe.errors import InputError

EARTH = {"radius": (6371220.0, "m"), "gravity": (9.80616, "m/s2"), "rotation_rate": (7.292e-5, "1/s")}
ROTATION = {"wind_speed": (38.61068276698372, "m/s"), "angle": (0.0, "rad")}
MOUNTAIN = {
    "mountain_height": (2000.0, "m"),
    "mountain_radius": (0.3490658503988659, "rad"),
    "mountain_longitude": (4.71238898038469, "rad"),
    "mountain_latitude": (0.5235987755982989, "rad"),
}
SECTOR = {
    "depth": (1000.0, "m"),
    "west": (0.0, "rad"),
    "east": (1.0471975511965976, "rad"),
    "south": (0.17453292519943295, "rad"),
    "north": (0.8726646259971648, "rad"),
    "wind_stress": (0.01, "N/m2"),
}
WAVE = {"depth": (1000.0, "m"), "amplitude": (0.1, "m")}
PARAMETERS = {
    "williamson1": {
        **ROTATION,
        "bell_height": (1000.0, "m"),
        "bell_radius": (0.3333333333333333, "rad"),
        "bell_longitude": (4.71238898038469, "rad"),
        "bell_latitude": (0.0, "rad"),
        "background_depth": (1000.0, "m"),
    },
    "williamson2": {**ROTATION, "reference_depth": (2998.1154702758267, "m")},
    "williamson5": {**MOUNTAIN, "wind_speed": (20.0, "m/s"), "reference_depth": (5960.0, "m")},
    "williamson6": {
        "wave_number": (4, ""),
        "angular_velocity": (7.848e-6, "1/s"),
        "wave_amplitude": (7.848e-6, "1/s"),
        "polar_depth": (8000.0, "m"),
    },
    "galewsky": {
        "perturbed": (True, ""),
        "wind_speed": (80.0, "m/s"),
        "southern_edge": (0.4487989505128276, "rad"),
        "northern_edge": (1.1219973762820692, "rad"),
        "mean_depth": (10000.0, "m"),
        "bump_height": (120.0, "m"),
        "bump_latitude": (0.7853981633974483, "rad"),
        "bump_width": (0.3333333333333333, "rad"),
        "bump_length": (0.06666666666666667, "rad"),
    },
    "lake-at-rest": {**MOUNTAIN, "surface_height": (5960.0, "m")},
    "hollingsworth": {**ROTATION, "depth": (50.0, "m")},
    "stommel": {**SECTOR, "drag_rate": (1.25e-5, "1/s")},
    "munk": {**SECTOR, "viscosity": (2.2e6, "m2/s")},
    "kelvin-wave": {**WAVE, "wave_number": (4, "")},
    "seiche": {**WAVE, "rotation_rate": (0.0, "1/s"), "degree": (2, ""), "order": (0, "")},
    "double-gyre": {
        "gravity": (0.1, "m/s2"),
        "depth": (500.0, "m"),
        "wind_stress": (0.1, "N/m2"),
        "wind_south": (0.2617993877991494, "rad"),
        "wind_north": (1.1344640137963142, "rad"),
        "drag_rate": (1e-7, "1/s"),
        "viscosity": (300.0, "m2/s"),
    },
}
"""Default and unit of every parameter; Williamson et al. (1992), Galewsky et al. (2004)."""

DECLARED = {
    "williamson1": (12.0, 1.5, True, True),
    "williamson2": (5.0, 1.85, True, False),
    "williamson5": (15.0, None, False, False),
    "williamson6": (14.0, None, False, False),
    "galewsky": (6.0, None, False, False),
    "lake-at-rest": (5.0, None, True, False),
    "hollingsworth": (20.0, None, True, False),
    "stommel": (15.0, None, True, False),
    "munk": (20.0, None, True, False),
    "kelvin-wave": (5.0, None, True, False),
    "seiche": (10.0, None, True, False),
    "double-gyre": (3650.0, None, False, False),
}
"""Days of the paper, accepted order, whether the solution is known, whether the wind is prescribed."""

BACKGROUND = {
    **dict.fromkeys(("williamson1", "stommel", "munk", "kelvin-wave", "seiche"), 1000.0),
    "double-gyre": 500.0,
}
"""Thickness that norms leave out, m, where there is any."""

CORIOLIS = {
    "stommel": lambda latitude: 1.4584e-4 * np.arctanh(np.sin(latitude)),
    "kelvin-wave": lambda latitude: np.full_like(latitude, 1.4584e-4),
    "seiche": np.zeros_like,
}
"""Of cases that have another one than the Earth."""


def test_constants_are_those_of_williamson_et_al() -> None:
    assert constants.EARTH_RADIUS == 6.37122e6
    assert constants.ROTATION_RATE == 7.292e-5
    assert constants.GRAVITY == 9.80616
    assert constants.SECONDS_PER_DAY == 24 * 60 * 60


@pytest.mark.parametrize("name", DECLARED)
def test_days_and_orders(name: str) -> None:
    case = CASES[name]()
    found = case.recommended_days, case.convergence_order, case.has_exact_solution, case.prescribed_wind
    assert found == DECLARED[name]
    assert case.background_depth == BACKGROUND.get(name, 0.0)


def test_every_case_is_declared_here() -> None:
    assert set(CASES) == set(DECLARED) == set(PARAMETERS)


@pytest.mark.parametrize("name", PARAMETERS)
def test_parameters_have_their_defaults_and_units(name: str) -> None:
    case, expected = CASES[name](), {**EARTH, **PARAMETERS[name]}
    assert {key: value for key, (value, _) in expected.items()} == pytest.approx(case.parameters(), rel=1e-15, abs=0.0)
    assert {key: units for key, (_, units) in expected.items()} == {
        key: units for key, (units, _) in units_and_meanings(case).items()
    }


@pytest.mark.parametrize("name", CASES)
def test_constants_of_the_planet_enter_once(name: str) -> None:
    """Radius, gravity and rotation as the equations have them: halving each changes what it should."""
    case = CASES[name]()
    longitude, latitude = np.array([0.3, 4.6, 5.0]), np.array([0.9, 0.5, -0.4])
    bare = CASES[name](rotation_rate=0.5 * case.rotation_rate)
    np.testing.assert_allclose(case.coriolis(longitude, latitude), 2.0 * bare.coriolis(longitude, latitude))
    expected = CORIOLIS.get(name, lambda latitude: 1.4584e-4 * np.sin(latitude))(latitude)
    np.testing.assert_allclose(case.coriolis(longitude, latitude), expected, rtol=1e-14)


def test_thickness_of_the_jet_by_plain_quadrature() -> None:
    """Galewsky et al. (2004), equations (2) to (4): balance from south to north by the trapezoidal rule."""
    case = CASES["galewsky"]()
    phi = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 400001)
    south, north = np.pi / 7.0, 5.0 * np.pi / 14.0
    inside = (phi > south) & (phi < north)
    u = np.zeros(phi.size)
    u[inside] = 80.0 * np.exp(1.0 / ((phi[inside] - south) * (phi[inside] - north)) + 4.0 / (north - south) ** 2)
    slope = u * (6371220.0 * 2.0 * 7.292e-5 * np.sin(phi) + u * np.tan(np.where(inside, phi, 0.0))) / 9.80616
    step = phi[1] - phi[0]
    drop = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * step)])
    mean = np.sum(drop * np.cos(phi)) / np.sum(np.cos(phi))
    places = np.array([50000, 250000, 300000, 310000, 330000, 390000])
    longitude = np.array([0.0, 1.0, 0.0, 0.2, 6.2, 3.0])
    east = np.where(longitude > np.pi, longitude - 2.0 * np.pi, longitude)
    bump = (
        120.0 * np.cos(phi[places]) * np.exp(-((3.0 * east) ** 2)) * np.exp(-((15.0 * (np.pi / 4 - phi[places])) ** 2))
    )
    expected = 10000.0 + mean - drop[places] + bump
    np.testing.assert_allclose(case.thickness(longitude, phi[places]), expected, atol=1e-4)
    zonal, meridional = case.velocity(longitude, phi[places])
    np.testing.assert_allclose(zonal, u[places], rtol=1e-12)
    assert not meridional.any()
    assert bump.max() > 80.0
    assert zonal.max() > 70.0


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_solid_rotation_by_vectors(angle: float) -> None:
    """Wind, vorticity, depth and Coriolis parameter of test case 2 from the axis of the flow."""
    case = CASES["williamson2"](angle=angle)
    random = np.random.default_rng(4)
    longitude, latitude = random.uniform(0.0, 2.0 * np.pi, 50), random.uniform(-1.4, 1.4, 50)
    point = np.stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], 1)
    axis = np.array([-np.sin(angle), 0.0, np.cos(angle)])
    speed = 2.0 * np.pi * 6371220.0 / (12.0 * 86400.0)
    wind = speed * np.cross(axis, point)
    east = np.stack([-np.sin(longitude), np.cos(longitude), np.zeros(50)], axis=1)
    zonal, meridional = case.velocity(longitude, latitude)
    np.testing.assert_allclose(zonal, (wind * east).sum(axis=1), atol=1e-12)
    np.testing.assert_allclose(meridional, (wind * np.cross(point, east)).sum(axis=1), atol=1e-12)
    height = point @ axis
    np.testing.assert_allclose(case.vorticity(longitude, latitude), 2.0 * speed / 6371220.0 * height, rtol=1e-12)
    np.testing.assert_allclose(case.coriolis(longitude, latitude), 2.0 * 7.292e-5 * height, rtol=1e-12)
    depth = 29400.0 - (6371220.0 * 7.292e-5 * speed + 0.5 * speed**2) * height**2
    np.testing.assert_allclose(case.thickness(longitude, latitude), depth / 9.80616, rtol=1e-13)


def test_lake_is_level_and_at_rest() -> None:
    case = CASES["lake-at-rest"]()
    longitude, latitude = np.array([4.7, 1.0, 4.8]), np.array([0.5, 0.2, 0.6])
    surface = case.thickness(longitude, latitude) + case.topography(longitude, latitude)
    np.testing.assert_allclose(surface, 5960.0, rtol=1e-15)
    assert case.topography(longitude, latitude)[0] > 1800.0
    for values in (*case.velocity(longitude, latitude), case.vorticity(longitude, latitude)):
        assert not values.any()


@pytest.mark.parametrize(
    ("name", "parameter"),
    [("williamson1", "bell_radius"), ("williamson5", "radius"), ("williamson5", "gravity")],
)
def test_nothing_is_not_positive(name: str, parameter: str) -> None:
    with pytest.raises(InputError, match=f"^{parameter} is 0; it must be positive$"):
        find_case(name, {parameter: 0.0})

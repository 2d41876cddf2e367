from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, simpson

from cases import Galewsky
from swe.errors import InputError

STEADY = Galewsky(perturbed=False)


def wind(latitude: float) -> float:
    """Equation (2), as it stands in the paper."""
    south, north = np.pi / 7, np.pi / 2 - np.pi / 7
    if not south < latitude < north:
        return 0.0
    return 80.0 / np.exp(-4 / (north - south) ** 2) * np.exp(1 / ((latitude - south) * (latitude - north)))


def slope(latitude: float) -> float:
    """The integrand of equation (3)."""
    coriolis = 2 * STEADY.rotation_rate * np.sin(latitude)
    return STEADY.radius * wind(latitude) * (coriolis + np.tan(latitude) / STEADY.radius * wind(latitude))


@pytest.mark.parametrize("latitude", [-1.0, 0.45, 0.6, np.pi / 4, 1.0, 1.12, 1.5])
def test_height_and_streamfunction_are_the_integrals_to_round_off(latitude: float) -> None:
    top = min(max(latitude, np.pi / 7), np.pi / 2 - np.pi / 7)
    options = {"epsabs": 1e-9, "epsrel": 1e-14, "limit": 500}
    drop, _ = quad(slope, np.pi / 7, top, **options)
    flow, _ = quad(wind, np.pi / 7, top, **options)
    south, here = STEADY.thickness(np.zeros(2), np.array([-np.pi / 2, latitude]))
    assert south - here == pytest.approx(drop / STEADY.gravity, abs=1e-10)
    psi = STEADY.streamfunction(np.zeros(1), np.array([latitude]))[0]
    assert psi == pytest.approx(-STEADY.radius * flow, rel=1e-13, abs=1e-13 * STEADY.radius)


def test_mean_depth_is_ten_kilometres() -> None:
    latitude = np.linspace(-np.pi / 2, np.pi / 2, 20001)
    mean = simpson(0.5 * np.cos(latitude) * STEADY.thickness(np.zeros(20001), latitude), x=latitude)
    assert mean == pytest.approx(10000.0, abs=1e-7)
    assert STEADY.thickness(np.zeros(1), np.zeros(1))[0] == pytest.approx(10158.186, abs=1e-3)


def test_wind_is_eighty_metres_a_second_in_the_middle_and_nothing_outside() -> None:
    middle = 0.5 * (STEADY.southern_edge + STEADY.northern_edge)
    latitude = np.array([middle, STEADY.southern_edge, STEADY.northern_edge, 0.0, np.pi / 2, -0.8])
    zonal, meridional = STEADY.velocity(np.zeros(6), latitude)
    np.testing.assert_allclose(zonal, [80.0, 0.0, 0.0, 0.0, 0.0, 0.0], rtol=1e-14)
    assert not meridional.any()
    for x in (0.5, 0.7, 1.0):
        assert STEADY.velocity(np.zeros(1), np.array([x]))[0][0] == pytest.approx(wind(x), rel=1e-13, abs=0.0)


def test_bump_stands_on_the_jet_at_longitude_zero() -> None:
    perturbed = Galewsky()
    longitude = np.array([0.0, 2 * np.pi - 1 / 3, 1 / 3, 0.0, np.pi])
    latitude = np.array([np.pi / 4, np.pi / 4, np.pi / 4, np.pi / 4 + 1 / 15, np.pi / 4])
    bump = perturbed.thickness(longitude, latitude) - STEADY.thickness(longitude, latitude)
    at_top = 120 * np.cos(np.pi / 4)
    beside = 120 * np.cos(np.pi / 4 + 1 / 15) / np.e
    np.testing.assert_allclose(bump, [at_top, at_top / np.e, at_top / np.e, beside, 0.0], rtol=1e-10, atol=1e-10)


def test_solution_is_known_without_the_bump_only() -> None:
    assert STEADY.has_exact_solution
    assert not Galewsky().has_exact_solution


def test_edges_the_wrong_way_round_are_refused() -> None:
    with pytest.raises(InputError, match=r"edges at 1.3 and 1.122 rad; southern_edge must be less"):
        replace(STEADY, southern_edge=1.3)

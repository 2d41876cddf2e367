"""Interpolation on a grid against that of scipy."""

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from mesh.density.grid_interpolation import density_on_grid
from mesh.geometry.sphere import fibonacci_points, to_lonlat


def test_bilinear_interpolation_agrees_with_scipy() -> None:
    latitude = np.radians([-90.0, -61.0, -20.0, 3.0, 40.0, 77.0, 90.0])
    longitude = np.radians(np.arange(0.0, 360.0, 12.0))
    values = np.random.default_rng(0).uniform(1.0, 2.0, (len(latitude), len(longitude)))
    values[[0, -1]] = 1.5  # one value at a pole
    density = density_on_grid(latitude, longitude, values, lambda values, smooth: values, "field")
    closed = np.append(longitude, 2.0 * np.pi), np.append(values, values[:, :1], axis=1)
    plain = RegularGridInterpolator((latitude, closed[0]), closed[1])
    points = np.concatenate([fibonacci_points(20_000), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]])
    east, north = to_lonlat(points)
    np.testing.assert_allclose(density(points), plain(np.stack([north, east], axis=-1)), rtol=1e-11)


def test_equal_values_give_just_that_value() -> None:
    """So that plateaus of a field are found."""
    latitude, longitude = np.radians(np.arange(-80.0, 81.0, 20.0)), np.radians(np.arange(0.0, 360.0, 20.0))
    density = density_on_grid(latitude, longitude, np.full((9, 18), 0.3), lambda values, smooth: values, "field")
    assert (density(fibonacci_points(10_000)) == 0.3).all()

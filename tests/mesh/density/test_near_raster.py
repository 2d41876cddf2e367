"""Functions that vanish but near some places, looked up in samples."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density import near_raster
from mesh.density.near_raster import NearRaster
from mesh.geometry.sphere import from_lonlat, normalize

WIDTH = 0.05
COAST = from_lonlat(np.linspace(0.0, 6.28, 1000), np.linspace(-1.5, 1.5, 1000))
"""A line over all faces of the cube, their sides and some of its corners."""

TREE = cKDTree(COAST)


def bell(points: Array) -> Array:
    away = TREE.query(points)[0] / WIDTH
    return np.where(away < 4.0, np.exp(-(away**2)), 0.0)


def anywhere(count: int) -> Array:
    return normalize(np.random.default_rng(1).normal(size=(count, 3)))


def test_values_are_those_of_the_function_to_the_square_of_the_step() -> None:
    points = anywhere(3000)
    errors = [
        np.abs(NearRaster(bell, COAST, 4.0 * WIDTH, step * WIDTH)(points) - bell(points)).max()
        for step in (0.25, 0.125)
    ]
    # Second derivatives of the bell are at most 2 / width^2 in either direction.
    assert errors[0] < 0.25**2 / 4.0 * 2.0
    assert errors[1] < 0.3 * errors[0]


def test_it_is_continuous_between_patches_and_zero_where_there_is_no_place() -> None:
    raster = NearRaster(bell, COAST, 4.0 * WIDTH, 0.25 * WIDTH)
    points = anywhere(20_000)
    nearby = normalize(points + 1e-9)
    assert np.abs(raster(points) - raster(nearby)).max() < 1e-7
    far = bell(points) == 0.0
    assert np.count_nonzero(raster(points[far])) < 0.02 * np.count_nonzero(far)
    assert (raster.block < 0).any()


def test_a_tiny_step_does_not_fill_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(near_raster, "MOST_PATCHES", 64)
    place = np.array([[1.0, 0.0, 0.0]])
    raster = NearRaster(lambda points: np.ones(len(points)), place, 1e-5, 1e-6)
    assert raster.resolution == 64
    np.testing.assert_array_equal(raster(np.concatenate([place, -place])), [1.0, 0.0])

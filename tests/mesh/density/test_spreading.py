"""Points spread as a density asks."""

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.density.spreading import spread_points
from mesh.errors import MeshError

COUNT = 4000


def cap(points: Array) -> Array:
    """Distance from the border of the northern half."""
    return points[:, 2]


def steep(points: Array) -> Array:
    return np.where(points[:, 0] > 0.0, 50.0, 1.0)


def test_their_number_follows_the_density_within_the_part() -> None:
    points = spread_points(COUNT, steep, cap, 3)
    assert points.shape == (COUNT, 3)
    assert (points[:, 2] > 0.0).all()
    assert len(np.unique(points, axis=0)) == COUNT
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)
    dense = np.count_nonzero(points[:, 0] > 0.0)
    # Points drawn at random would miss this by some 9.
    assert dense == pytest.approx(COUNT * 50.0 / 51.0, abs=3)
    # Bands of equal height have equal areas, and are filled evenly up to the border.
    bands = np.histogram(points[points[:, 0] > 0.0, 2], bins=8, range=(0.0, 1.0))[0]
    np.testing.assert_allclose(bands, dense / 8, rtol=0.07)


def test_the_seed_moves_them_within_their_squares() -> None:
    first, again, other = (spread_points(300, steep, cap, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert 0.0 < np.abs(first - other).max() < 0.2


def test_no_place_inside() -> None:
    with pytest.raises(MeshError, match="no place was found"):
        spread_points(100, steep, lambda points: np.full(len(points), -1.0), 1)

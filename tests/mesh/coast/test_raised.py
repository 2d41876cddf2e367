"""A density that rises towards the coast."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mesh.coast.raised import RaisedDensity
from mesh.errors import MeshError
from mesh.geometry.sphere import fibonacci_points, from_lonlat


def test_values_fall_like_a_bell_from_the_coast() -> None:
    coast = from_lonlat(np.radians(np.linspace(-30.0, 30.0, 601)), np.zeros(601))
    raised = RaisedDensity(lambda points: np.full(len(points), 3.0), coast, np.radians(10.0), 5.0)
    points = from_lonlat(np.zeros(3), np.radians([10.0, 0.0, -40.0]))
    np.testing.assert_allclose(raised(points), [3.0 * (1.0 + 4.0 / np.e), 15.0, 3.0], rtol=4e-3)
    assert raised.__name__ == "function <lambda> raised 5 times at the coast"


def test_what_is_looked_up_is_what_a_search_for_the_nearest_point_gives() -> None:
    longitude = np.linspace(0.0, 2.0 * np.pi, 3000)
    coast = from_lonlat(longitude, 0.5 + 0.2 * np.sin(5.0 * longitude))
    width, factor = 0.1, 16.0
    raised = RaisedDensity(lambda points: np.ones(len(points)), coast, width, factor)
    points = fibonacci_points(20_000)
    away = cKDTree(coast).query(points)[0] / width
    exact = 1.0 + (factor - 1.0) * np.exp(-(away**2))
    assert np.abs(raised(points) - exact).max() < 0.004 * factor
    # What matters of it: spacings.
    assert np.abs((raised(points) / exact) ** -0.25 - 1.0).max() < 0.004
    # Cells far from the coast are on a plateau, where no quadrature is needed.
    np.testing.assert_array_equal(raised(points[away > 5.5]), 1.0)


@pytest.mark.parametrize(("width", "factor"), [(0.0, 2.0), (float("nan"), 2.0), (0.1, 0.5), (0.1, float("inf"))])
def test_wrong_widths_and_factors(width: float, factor: float) -> None:
    with pytest.raises(MeshError, match="give"):
        RaisedDensity(lambda points: points[:, 0], np.eye(3), width, factor)

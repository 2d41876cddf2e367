"""A density that rises towards the coast."""

import numpy as np
import pytest

from mesh.coast.raised import RaisedDensity
from mesh.errors import MeshError
from mesh.geometry.sphere import from_lonlat


def test_values_fall_like_a_bell_from_the_coast() -> None:
    coast = from_lonlat(np.radians(np.linspace(-30.0, 30.0, 601)), np.zeros(601))
    raised = RaisedDensity(lambda points: np.full(len(points), 3.0), coast, np.radians(10.0), 5.0)
    points = from_lonlat(np.zeros(3), np.radians([10.0, 0.0, -40.0]))
    np.testing.assert_allclose(raised(points), [3.0 * (1.0 + 4.0 / np.e), 15.0, 3.0], rtol=2e-3)
    assert raised.__name__ == "function <lambda> raised 5 times at the coast"


@pytest.mark.parametrize(("width", "factor"), [(0.0, 2.0), (float("nan"), 2.0), (0.1, 0.5), (0.1, float("inf"))])
def test_wrong_widths_and_factors(width: float, factor: float) -> None:
    with pytest.raises(MeshError, match="give"):
        RaisedDensity(lambda points: points[:, 0], np.eye(3), width, factor)

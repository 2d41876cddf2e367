"""A density that rises towards the coast."""

import numpy as np
import pytest

from mesh.coast.raised import RaisedDensity
from mesh.errors import MeshError
from mesh.geometry.sphere import from_lonlat
from mesh.regions.find import find_region


def test_values_fall_like_a_bell_from_the_coast() -> None:
    """Ten degrees from the southern side of a box, whose other sides are farther away, and on land."""
    region = find_region("0,60,0,60")
    raised = RaisedDensity(lambda points: np.full(len(points), 3.0), region, np.radians(10.0), 5.0)
    points = from_lonlat(np.radians([30.0, 30.0, 30.0]), np.radians([10.0, 1e-9, -20.0]))
    np.testing.assert_allclose(raised(points), [3.0 * (1.0 + 4.0 / np.e), 15.0, 15.0], rtol=2e-3)
    assert raised.__name__.startswith("function <lambda> raised 5 times")


@pytest.mark.parametrize(("width", "factor"), [(0.0, 2.0), (float("nan"), 2.0), (0.1, 0.5), (0.1, float("inf"))])
def test_wrong_widths_and_factors(width: float, factor: float) -> None:
    with pytest.raises(MeshError, match="give"):
        RaisedDensity(lambda points: points[:, 0], find_region("0,60,0,60"), width, factor)

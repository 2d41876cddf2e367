import math

import numpy as np
import pytest

from swe.parallel.exact_sum import exact_sum

RANDOM = np.random.default_rng(0)


@pytest.mark.parametrize("decades", [0, 12, 300])
def test_sum_is_that_of_exact_arithmetic_in_any_order(decades: int) -> None:
    values = RANDOM.normal(size=5000) * 10.0 ** RANDOM.integers(-decades, decades + 1, 5000)
    assert exact_sum(values) == math.fsum(values)
    assert exact_sum(values[::-1]) == exact_sum(np.sort(values)) == math.fsum(values)


def test_sum_keeps_what_cancellation_leaves() -> None:
    assert exact_sum(np.array([1e16, 1.0, -1e16])) == 1.0
    assert exact_sum(np.array([1e300, 5e-324, -1e300])) == 5e-324
    assert exact_sum(np.full(100_000, 0.1)) == math.fsum([0.1] * 100_000)


def test_extremes() -> None:
    tiny, largest = 5e-324, np.finfo(float).max
    assert exact_sum(np.array([tiny, tiny, -0.0])) == 2 * tiny
    assert exact_sum(np.array([largest])) == largest
    assert exact_sum(np.array([-largest, -2.5])) == -largest
    assert exact_sum(np.empty(0)) == 0.0
    assert math.isnan(exact_sum(np.array([1.0, np.nan])))
    assert exact_sum(np.array([1.0, -np.inf])) == -np.inf
    assert exact_sum(np.array([largest, largest])) == np.inf
    assert exact_sum(np.array([-largest, 1.0, -largest])) == -np.inf
    assert exact_sum(np.array([largest, largest, -largest])) == largest

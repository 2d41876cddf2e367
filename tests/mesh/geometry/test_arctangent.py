"""The arctangent of compiled loops against that of numpy."""

import numba
import numpy as np

from mesh.arrays import Array
from mesh.geometry.arctangent import arctangent


@numba.njit
def angles(y: Array, x: Array) -> Array:
    result = np.empty(len(x))
    for row in range(len(x)):
        result[row] = arctangent(y[row], x[row])
    return result


def test_arctangent_is_that_of_numpy_in_all_directions() -> None:
    turn = np.concatenate([np.linspace(-np.pi, np.pi, 10_001), np.linspace(-1e-9, 1e-9, 100)])
    lengths = np.geomspace(1e-6, 1e6, len(turn))
    y, x = lengths * np.sin(turn), lengths * np.cos(turn)
    np.testing.assert_allclose(angles(y, x), np.arctan2(y, x), rtol=1e-15, atol=0.0)


def test_arctangent_along_the_axes_and_of_nothing() -> None:
    y, x = np.array([0.0, 1.0, 0.0, -1.0, 0.0]), np.array([1.0, 0.0, -1.0, 0.0, 0.0])
    np.testing.assert_array_equal(angles(y, x), [0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi, 0.0])

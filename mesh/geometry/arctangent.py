"""The angle of a direction for compiled loops over many points, without branches, so that processors take several.

The library's arctangent is called point by point and takes most of the time of a density in longitude and latitude.
"""

import numba
import numpy as np

EIGHTH = 0.25 * np.pi
RATIO = np.sqrt(2.0) - 1.0
"""Tangent of a sixteenth of a turn."""

TINY = 1.0e-300
"""Added to lengths that divide, so that the direction of no length has the angle zero."""


@numba.njit(cache=True, error_model="numpy", fastmath=False)
def arctangent(y: float, x: float) -> float:
    """The angle of (x, y) from the x axis, in [-pi, pi], that of `numpy.arctan2` but for round-off."""
    width, height = abs(x), abs(y)
    larger, smaller = max(width, height), min(width, height)
    # The tangent of the angle to the nearer axis, or of that to the diagonal.
    diagonal = smaller > RATIO * larger
    above = smaller - larger if diagonal else smaller
    tangent = above / ((smaller + larger if diagonal else larger) + TINY)
    angle = tangent * _series(tangent * tangent) + (EIGHTH if diagonal else 0.0)
    angle = 2.0 * EIGHTH - angle if height > width else angle
    angle = 4.0 * EIGHTH - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@numba.njit(cache=True, error_model="numpy", fastmath=False)
def _series(square: float) -> float:
    """The value of arctan(t) / t at t^2, for t up to RATIO: powers of t^2 through twelve Chebyshev points."""
    value = 0.03796525745386593 - 0.017805397205419446 * square
    value = 0.05846878297330872 + square * (square * value - 0.05035102456601552)
    value = 0.07692045330902225 + square * (square * value - 0.06662951813629191)
    value = 0.11111110744919658 + square * (square * value - 0.09090896809064027)
    value = 0.19999999999940893 + square * (square * value - 0.14285714279250245)
    return 1.0 + square * (square * value - 0.3333333333333312)

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

SERIES = (
    1.0,
    -0.3333333333333312,
    0.19999999999940893,
    -0.14285714279250245,
    0.11111110744919658,
    -0.09090896809064027,
    0.07692045330902225,
    -0.06662951813629191,
    0.05846878297330872,
    -0.05035102456601552,
    0.03796525745386593,
    -0.017805397205419446,
)
"""Coefficients of arctan(t) / t in powers of t^2, interpolated at twelve Chebyshev points of 0 <= t <= RATIO."""


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
    """The value of arctan(t) / t at t^2."""
    value = SERIES[11]
    for power in range(10, -1, -1):
        value = value * square + SERIES[power]
    return value

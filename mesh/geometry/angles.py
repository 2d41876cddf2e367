"""The only place where angles are wrapped into one turn. All are in radians, in arrays of any shape."""

import numpy as np

from mesh.arrays import Array

TURN = 2.0 * np.pi
"""A full turn."""


def about_zero(angle: Array) -> Array:
    """The angle in [-pi, pi): differences of longitudes."""
    return (angle + np.pi) % TURN - np.pi


def eastward(angle: Array) -> Array:
    """The angle in [0, 2 pi): longitudes, which count eastward from the meridian of zero."""
    return _below_a_turn(angle % TURN)


def eastward_of_half_turns(angle: Array) -> Array:
    """The angle in [0, 2 pi) of one in [-pi, pi], as `arctan2` gives it; minus zero stays what it is."""
    return _below_a_turn(np.where(angle < 0.0, angle + TURN, angle))


def degrees_eastward(angle: Array) -> Array:
    """The angle, in degrees, in [0, 360)."""
    return np.where((wrapped := angle % 360.0) < 360.0, wrapped, 0.0)


def whole_degrees_east(longitude: float) -> int:
    """The longitude in degrees, 0 to 359, as labels of maps have it."""
    return round(np.degrees(longitude)) % 360


def _below_a_turn(angle: Array) -> Array:
    """What rounding made a full turn, of an angle just below zero, becomes zero."""
    return np.where(angle >= TURN, 0.0, angle)

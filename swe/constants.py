"""Physical constants of Williamson et al. (1992), section 2.2, in SI units."""

EARTH_RADIUS = 6371220.0
"""Mean radius of the Earth, m."""

ROTATION_RATE = 7.292e-5
"""Angular velocity of the Earth's rotation, 1/s."""

GRAVITY = 9.80616
"""Acceleration of gravity, m/s2."""

SECONDS_PER_DAY = 86400.0
"""Length of a day, s."""

SQUARE_METRES_PER_SQUARE_KILOMETRE = 1e6
"""Area of a square kilometre, m2."""

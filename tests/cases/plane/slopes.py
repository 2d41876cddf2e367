"""Derivatives of the functions of a case, by differences of fourth order in metres and seconds."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array

WEIGHTS = {-2: 1.0 / 12.0, -1: -2.0 / 3.0, 1: 2.0 / 3.0, 2: -1.0 / 12.0}


@dataclass(frozen=True, eq=False)
class Slopes:
    """Positions and the time at which `in_time`, `in_x` and `in_y` differentiate, and steps, m and s."""

    x: Array
    y: Array
    time: float
    metres: float = 100.0
    seconds: float = 1.0

    def in_time(self, function: Callable[..., Array]) -> Array:
        """Change of a function of x, y and time in a second."""
        return self._sum(lambda step: function(self.x, self.y, self.time + step), self.seconds)

    def in_x(self, function: Callable[..., Array]) -> Array:
        """Its change along x in a metre."""
        return self._sum(lambda step: function(self.x + step, self.y, self.time), self.metres)

    def in_y(self, function: Callable[..., Array]) -> Array:
        """Its change along y in a metre."""
        return self._sum(lambda step: function(self.x, self.y + step, self.time), self.metres)

    def _sum(self, values: Callable[[float], Array], step: float) -> Array:
        return np.asarray(sum(weight * values(number * step) for number, weight in WEIGHTS.items()) / step)


def component(velocity: Callable[..., tuple[Array, Array]], number: int) -> Callable[..., Array]:
    """The function that gives the component along x, 0, or along y, 1, of the velocity of a case."""
    return lambda x, y, time: velocity(x, y, time)[number]


def relative_error(found: Array, expected: Array, weights: Array) -> float:
    """The l2 norm of the difference over that of what is expected."""
    return float(np.sqrt(weights @ (found - expected) ** 2 / (weights @ expected**2)))

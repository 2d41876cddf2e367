"""The integrators by name: how they step, and how long a step they stand."""

from dataclasses import dataclass
from typing import Literal

Integrator = Literal["rk4", "rrk4", "fbrk3", "rfbrk3"]
"""Classical Runge-Kutta, and forward-backward Runge-Kutta; relaxed, each conserves total energy to round-off."""

FASTEST_WAVE = 6.0**0.5
"""The largest frequency of gravity waves on regular hexagons, in sqrt(g h) / d, d the distance between cells."""

DEFAULT_COURANT_NUMBER = 0.8
"""Courant number of the default time step of RK4, 70 percent of the limit for gravity waves (`courant_number`)."""


@dataclass(frozen=True)
class ForwardBackwardStage:
    """One stage of a step from h, u, with the slopes at the state h_a, u_a that the stage before it left.

    Thickness goes first, h_b = h + `fraction` dt H(u_a, h_a); velocity follows with the new thickness in its slope,
    u_b = u + `fraction` dt U(u_a, `new` h_b + `last` h_a + `start` h).
    """

    fraction: float
    new: float
    last: float
    start: float


FB_RK32 = (
    ForwardBackwardStage(1 / 3, 0.531, 0.0, 1.0 - 0.531),
    ForwardBackwardStage(1 / 2, 0.531, 0.0, 1.0 - 0.531),
    ForwardBackwardStage(1.0, 0.313, 1.0 - 2.0 * 0.313, 0.313),
)
"""FB-RK(3,2) of Lilly et al. (2023): of order two, and stable for longer steps than RK4 with three stages for four."""


@dataclass(frozen=True)
class Stepping:
    """How an integrator steps.

    `stable_courant_number` is the limit for linear gravity waves on regular hexagons: the largest phase, frequency
    times time step, of a wave that does not grow, over `FASTEST_WAVE`.
    """

    forward_backward: bool
    relaxed: bool
    stable_courant_number: float

    @property
    def default_courant_number(self) -> float:
        """Courant number of the default time step: the same fraction of the limit for every integrator."""
        return DEFAULT_COURANT_NUMBER * (self.stable_courant_number / RK4_LIMIT)


RK4_LIMIT = 2.0 / 3.0**0.5
"""2 sqrt(2), the limit of RK4 on the imaginary axis, over `FASTEST_WAVE`."""

FB_RK32_LIMIT = 3.862153245892104 / FASTEST_WAVE
"""A step multiplies a wave of phase z, whose slopes are -i z u and -i z h, by a matrix. Up to this z, none of its
eigenvalues leaves the unit circle."""

STEPPINGS: dict[Integrator, Stepping] = {
    "rk4": Stepping(forward_backward=False, relaxed=False, stable_courant_number=RK4_LIMIT),
    "rrk4": Stepping(forward_backward=False, relaxed=True, stable_courant_number=RK4_LIMIT),
    "fbrk3": Stepping(forward_backward=True, relaxed=False, stable_courant_number=FB_RK32_LIMIT),
    "rfbrk3": Stepping(forward_backward=True, relaxed=True, stable_courant_number=FB_RK32_LIMIT),
}

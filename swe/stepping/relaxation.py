"""Relaxation of a Runge-Kutta step: its increment is scaled so that total energy stays exactly what it was.

Ketcheson (2019), Relaxation Runge-Kutta methods. Along an increment (p, v) of thickness and velocity the total energy
of the scheme is a cubic in the factor, without a constant term once the energy at the start is subtracted:

    E(h + c p, u + c v) - E(h, u) = c (e_1 + c e_2 + c^2 e_3)

so the factor is the root near 1 of a quadratic, whose coefficients are sums of products with the increment.

Nothing here asks how the increment came about (Ranocha et al. 2020). The scheme itself conserves energy, so a step of
a method of order p, Runge-Kutta or forward-backward, changes it by O(dt^(p+1)), while e_2 is O(dt^2) where the flow
changes at all. The factor is therefore 1 + O(dt^(p-1)), and the scaled state misses the exact one at the scaled time by
O(dt^(p+1)), as before. The mass of the increment is zero, and so is that of any multiple of it.
"""

import numpy as np

from mesh.arrays import Array
from swe.diagnostics.invariants import mean_level
from swe.equations.model import ShallowWaterModel
from swe.parallel.folding import bounded_sums, folds
from swe.state import State

EXCESS = 8.0
"""The terms of the energy change in a step may add up to this many times the initial energy; none came near it."""

NEWTON_STEPS = 4
"""Newton steps for the quadratic, whose root is at most some 1e-2 (RK4) or 1e-1 from 1 at the default time step."""

FARTHEST = 0.1
"""A root farther from 1 is an artefact of round-off in a flow at rest or steady; the step is then left unscaled."""


class Relaxation:
    """Finds the factors that conserve the energy of `model`, a flow over topography whose wind is not prescribed."""

    def __init__(self, model: ShallowWaterModel, state: State) -> None:
        self._model = model
        # Mass is conserved, so heights may be measured from any level; from the mean level their products are small.
        self._height = model.topography - mean_level(model, state)
        self._folds = np.array([folds(EXCESS * self._energy(state), model.entities)] * 3)

    def _energy(self, state: State) -> float:
        """A scale of energy, m5/s2: kinetic energy, plus potential energy with all terms taken as positive."""
        model, h = self._model, state.thickness
        terms = np.empty((2, h.size))
        terms[0] = model.measures.area_cell * h * model.diagnose(state).kinetic_energy
        terms[1] = model.gravity * model.measures.area_cell * h * (h + np.abs(self._height))
        return sum(model.processes.exact_sums(terms))

    def coefficients(self, state: State, after: State) -> tuple[float, float, float]:
        """e_1, e_2 and e_3 of the energy change along the increment from `state` to `after`, m5/s2."""
        model = self._model

        def along(coarse: Array, fine: Array, parts: Array) -> None:
            model.scheme.energy_along(state, after, self._height, model.gravity, model.measures, (coarse, fine), parts)

        first, second, third = bounded_sums(along, self._folds, model.processes)
        return first, second, third

    def factor(self, state: State, after: State) -> float:
        """The factor that scales the increment from `state` to `after` so that the energy stays that of `state`."""
        first, second, third = self.coefficients(state, after)
        off = 0.0  # the factor minus one
        for _ in range(NEWTON_STEPS):
            slope = second + 2.0 * third * (1.0 + off)
            if slope == 0.0:
                return 1.0
            off -= ((first + second + third) + off * (second + 2.0 * third) + off * off * third) / slope
        return 1.0 + off if abs(off) <= FARTHEST else 1.0

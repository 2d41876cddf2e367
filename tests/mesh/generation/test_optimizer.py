"""What the line search goes by: energies, their slopes, and directions that descend."""

import numpy as np
import pytest

from mesh.density.named import NAMED
from mesh.generation.optimizer import History, Limits, Optimizer
from mesh.geometry.sphere import normalize


def started(density: str | None, iterations: int = 3) -> Optimizer:
    """An optimiser of 100 random points after a few iterations."""
    points = normalize(np.random.default_rng(1).normal(size=(100, 3)))
    optimizer = Optimizer(points, density=NAMED[density] if density else None)
    optimizer.run(Limits(1e-12, iterations))
    return optimizer


@pytest.mark.parametrize("density", [None, "smooth-transition"])
def test_slopes_are_the_derivatives_of_the_energy_along_a_direction(density: str | None) -> None:
    optimizer = started(density)
    slot = optimizer._memory.spare_slot()
    direction = optimizer._memory.steps[slot]
    direction[:] = np.random.default_rng(2).normal(size=direction.shape)
    found = {}
    for length in (-1e-5, 0.0, 1e-5):
        optimizer._move(slot, length)
        optimizer._evaluate_trial(direction)
        found[length] = optimizer._trial.energy, optimizer._trial.slope
    difference = (found[1e-5][0] - found[-1e-5][0]) / 2e-5
    # Under a density the energy carries the error of its quadrature.
    assert found[0.0][1] == pytest.approx(difference, rel=1e-4 if density is None else 1e-2)


def test_new_directions_have_the_slope_they_say() -> None:
    optimizer = started(None)
    slot, slope, _ = optimizer._direction()
    assert len(optimizer._memory.slots) > 0
    assert slope < 0.0
    assert slope == pytest.approx(np.dot(optimizer._current.gradient.ravel(), optimizer._memory.steps[slot]), rel=1e-9)


def test_pairs_that_give_no_descent_are_forgotten() -> None:
    """Then the direction is minus the preconditioned gradient, whose slope is minus the square of the gradient."""
    optimizer = started(None)
    assert len(optimizer._memory.slots) == 3
    optimizer._memory.step_dots, optimizer._memory.change_dots = np.ones(3), np.full(3, 1e3)
    slot, slope, _ = optimizer._direction()
    assert len(optimizer._memory.slots) == 0
    gradient, step = optimizer._current.gradient.ravel(), optimizer._memory.steps[slot]
    assert slope == pytest.approx(-np.dot(gradient, optimizer._current.preconditioned.ravel()), rel=1e-12)
    assert slope == pytest.approx(np.dot(gradient, step), rel=1e-9)
    assert slope < 0.0


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        (Limits(0.5, 9, 9.0), "tolerance"),
        (Limits(0.5, 2, 3.0), "tolerance"),
        (Limits(0.4, 2, 9.0), "iterations"),
        (Limits(0.4, 2, 3.0), "iterations"),
        (Limits(0.4, 3, 3.0), "seconds"),
        (Limits(0.4, 3, 3.5), None),
    ],
)
def test_limits_are_reached_where_they_are_met(limits: Limits, reason: str | None) -> None:
    """After two iterations, at a residual of 0.5, after 3 s."""
    assert limits.reason_to_stop(History([3.0, 2.0, 1.0], [0.9, 0.3, 0.5], [0.0, 1.0, 3.0])) == reason

import numpy as np
import pytest

from swe.state import State
from swe.stepping.time_stepping import RK4, ButcherTableau, RungeKutta


def decay(state: State, result: State, time: float) -> None:
    """h' = -h^2, u' = -h u^2: from h = u = 1, h = 1/(1 + t) and u = 1/(1 + log(1 + t))."""
    h, u = state.thickness, state.normal_velocity
    result.thickness[:] = -(h**2)
    result.normal_velocity[:] = -h * u**2


def orders(tableau: ButcherTableau) -> np.ndarray:
    """Orders of convergence of h and u at t = 2, from 40, 80 and 160 steps."""
    errors = []
    for steps in (40, 80, 160):
        state = State(np.array([1.0]), np.array([1.0]))
        stepper = RungeKutta(decay, state, tableau)
        for _ in range(steps):
            stepper.step(state, 2.0 / steps)
        exact = 1 / 3, 1 / (1 + np.log(3))
        errors.append([abs(state.thickness[0] - exact[0]), abs(state.normal_velocity[0] - exact[1])])
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_classical_method_is_of_order_four() -> None:
    np.testing.assert_allclose(orders(RK4), 4.0, atol=0.25)


def test_tableau_of_another_method_gives_its_order() -> None:
    midpoint = ButcherTableau(stages=((), (0.5,)), weights=(0.0, 1.0))
    np.testing.assert_allclose(orders(midpoint), 2.0, atol=0.25)


def test_tableau_is_consistent() -> None:
    assert sum(RK4.weights) == pytest.approx(1.0)
    assert [sum(stage) for stage in RK4.stages] == [0.0, 0.5, 0.5, 1.0]


def test_a_step_allocates_nothing_that_grows_with_the_mesh() -> None:
    import tracemalloc

    size = 200_000
    state = State(np.ones(size), np.zeros(size))
    stepper = RungeKutta(lambda state, result, time: None, state)
    stepper.step(state, 1.0)
    tracemalloc.start()
    stepper.step(state, 1.0)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < size

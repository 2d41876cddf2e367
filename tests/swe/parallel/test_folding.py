"""Folded sums are the same in any order and any division, and as good as exact ones."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe import ShallowWaterModel, Simulation
from swe.diagnostics.budgets import measure_rates
from swe.parallel.folding import NOTHING, UNFOLDED, add, bounded_sums, folded_sums, folds
from swe.parallel.processes import ONE_PROCESS
from swe.stepping.relaxation import Relaxation


def summing(terms: Array) -> object:
    """A kernel that adds up `terms`, in as many parts as it is given."""

    def kernel(coarse: Array, fine: Array, parts: Array) -> None:
        for part, piece in zip(parts, np.array_split(terms, len(parts)), strict=True):
            total = NOTHING
            for term in piece:
                total = add.py_func(total, term, coarse[0], fine[0])
            part[0] = total

    return kernel


@settings(deadline=None)
@given(seed=st.integers(0, 10_000), spread=st.floats(0.0, 20.0), size=st.integers(1, 300))
def test_the_order_of_terms_changes_nothing(seed: int, spread: float, size: int) -> None:
    random = np.random.default_rng(seed)
    terms = random.normal(size=size) * np.exp(spread * random.normal(size=size))
    (found,) = folded_sums(summing(terms), 1, size, ONE_PROCESS)  # type: ignore[arg-type]
    (shuffled,) = folded_sums(summing(random.permutation(terms)), 1, size, ONE_PROCESS)  # type: ignore[arg-type]
    assert found == shuffled
    exact = math.fsum(terms)
    assert abs(found - exact) <= 2.0**-53 * abs(exact) + size * 2.0**-80 * size * np.abs(terms).max()


def test_a_known_bound_spares_a_pass() -> None:
    random = np.random.default_rng(1)
    terms = random.normal(size=1000)
    numbers = np.array([folds(np.abs(terms).sum(), len(terms))])
    (found,) = bounded_sums(summing(terms), numbers, ONE_PROCESS)  # type: ignore[arg-type]
    assert found == math.fsum(terms)


def test_sums_that_cannot_be_folded() -> None:
    assert folds(0.0, 10) == folds(math.inf, 10) == folds(math.nan, 10) == folds(1e308, 10) == UNFOLDED
    assert folded_sums(summing(np.zeros(5)), 1, 5, ONE_PROCESS) == [0.0]  # type: ignore[arg-type]
    for wrong in (math.inf, math.nan):
        with np.errstate(invalid="ignore"):
            (found,) = folded_sums(summing(np.array([1.0, wrong])), 1, 2, ONE_PROCESS)  # type: ignore[arg-type]
        assert not math.isfinite(found)


@pytest.mark.parametrize("blocks", [1, 7, 500])
def test_no_rate_and_no_factor_depends_on_the_parts(
    larger_mesh: VoronoiMesh, blocks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bit for bit: rates of all integrals, and the coefficients of the relaxation."""
    simulation = Simulation(larger_mesh, Williamson5(), anticipation=0.5, dissipation=1e15)
    simulation.run(days=0.25, progress=False)
    model, state = simulation.model, simulation.state

    def found() -> tuple[dict[str, float], tuple[float, float, float]]:
        slope = state.empty_like()
        model.tendency(state, slope)
        after = state.copy()
        after.thickness[:] += 600.0 * slope.thickness
        after.normal_velocity[:] += 600.0 * slope.normal_velocity
        plain = ShallowWaterModel(model.mesh, model.topography, model.coriolis, model.gravity)
        coefficients = Relaxation(plain, state).coefficients(state, after)
        return measure_rates(model, state, model.diagnose(state), slope), coefficients

    expected = found()
    monkeypatch.setattr("swe.parallel.folding.BLOCKS", blocks)
    assert found() == expected
    assert all(value != 0.0 for value in expected[1])

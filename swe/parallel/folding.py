"""Sums of many terms that come out the same in whatever order, and in however many parts, the terms are added.

Adding M = 3/2 2^p to a double and subtracting it again rounds the double to a multiple of 2^(p - 52). Multiples of one
quantum add without rounding as long as their sum stays below 2^53 quanta. Two such numbers therefore fold each term
into a coarse and a fine part, and the remainder is far below the round-off of the terms: Demmel and Nguyen (2013),
Fast reproducible floating-point summation.
"""

import math
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from mesh.arrays import Array
from swe.parallel.processes import Processes

BLOCKS = 64
"""Number of parts in which sums are taken, so that threads share the work; results do not depend on it."""

DIGITS = 53
"""Binary digits of a double."""

Folded = tuple[float, float, float]
"""Coarse and fine sum, and the largest magnitude of a term."""

NOTHING: Folded = (0.0, 0.0, 0.0)
"""The sum of no terms."""

UNFOLDED = (0.0, 0.0)
"""Folds that leave the terms as they are, for a first pass that finds the largest one."""


options: dict[str, Any] = {"error_model": "numpy", "fastmath": False, "forceinline": True}


@numba.njit(**options)
def _fold(term: float, coarse: float, fine: float) -> tuple[float, float]:
    """Coarse and fine part of a `term`."""
    part = (term + coarse) - coarse
    return part, ((term - part) + fine) - fine


@numba.njit(**options)
def add(total: Folded, term: float, coarse: float, fine: float) -> Folded:
    """`total` with one more `term`; `coarse` and `fine` are those of `folds`, or `UNFOLDED`."""
    part, rest = _fold(term, coarse, fine)
    return total[0] + part, total[1] + rest, max(total[2], abs(term))


@numba.njit(**{**options, "fastmath": {"reassoc"}})
def _sum_of_parts(parts: Array, count: int) -> float:
    """Sum of the first `count` of `parts`, multiples of one quantum, in as many lanes as the processor has."""
    total = 0.0
    for i in range(count):
        total += parts[i]
    return total


@numba.njit(**options)
def add_all(total: Array, terms: Array, count: int, coarse: float, fine: float, spare: Array) -> None:
    """Add the first `count` of `terms` to the coarse and fine sums, `total[0]` and `total[1]`; see `add`.

    The terms are overwritten, and so is `spare`, of the same size.
    """
    for i in range(count):
        terms[i], spare[i] = _fold(terms[i], coarse, fine)
    total[0] += _sum_of_parts(terms, count)
    total[1] += _sum_of_parts(spare, count)


def folds(bound: float, count: int) -> tuple[float, float]:
    """The numbers that fold up to `count` terms whose magnitudes add up to no more than `bound`."""
    if not 0.0 < bound < math.inf:
        return UNFOLDED  # all terms are zero, or they have no finite sum
    coarse = math.frexp(bound)[1] + 1
    fine = coarse - DIGITS + math.frexp(count)[1] + 1
    try:
        return math.ldexp(1.5, coarse), math.ldexp(1.5, fine)
    except OverflowError:
        return UNFOLDED


def folded_sums(
    kernel: Callable[[Array, Array, Array], None], sums: int, count: int, processes: Processes
) -> list[float]:
    """The `sums` that a kernel adds up, whatever the order; `count` bounds the number of terms of all processes.

    `kernel(coarse, fine, parts)` writes the results of `add` into `parts` (BLOCKS, sums, 3), with the folds (sums,) of
    each sum. It is called twice, first to find the largest terms, which bound the sums.
    """
    parts = np.empty((BLOCKS, sums, 3))
    kernel(np.zeros(sums), np.zeros(sums), parts)
    largest = processes.largest(parts[:, :, 2].max(axis=0))
    numbers = np.array([folds(count * bound, count) for bound in largest.tolist()])
    return bounded_sums(kernel, numbers, processes)


def bounded_sums(kernel: Callable[[Array, Array, Array], None], numbers: Array, processes: Processes) -> list[float]:
    """The same in one pass, where the `folds` (sums, 2) are already known."""
    parts = np.empty((BLOCKS, len(numbers), 3))
    kernel(numbers[:, 0].copy(), numbers[:, 1].copy(), parts)
    return [coarse + fine for coarse, fine in processes.sums(parts[:, :, :2].sum(axis=0)).tolist()]

"""Sums of the energy along an increment: the same bits whatever part of the mesh they are taken over."""

from collections.abc import Callable

import numpy as np
import pytest

from mesh.arrays import Array
from swe.equations.energy_along import sum_over_cells, sum_over_edges
from swe.parallel.folding import BLOCKS, folds

SIZE = 4001
LARGEST = 100.0
"""No term is larger; folds for no more keep nearly all of the bits of every term."""


def values(seed: int, count: int) -> list[Array]:
    """So many fields (SIZE,) of random numbers of magnitude one."""
    return list(np.random.default_rng(seed).normal(size=(count, SIZE)))


def over_cells(part: slice) -> Array:
    fields = [each[part].copy() for each in values(1, 7)]
    h, h_after, *energies, height, area = fields
    return summed(lambda *folded: sum_over_cells(h, h_after, *energies, height, 9.8, area, *folded))


def over_edges(part: slice) -> Array:
    """Each edge between two cells of its own, so that its terms follow from it alone; cells have no area."""
    u, u_after, half = (each[part].copy() for each in values(2, 3))
    h, h_after, height = (np.repeat(each[part], 2) for each in values(3, 3))
    h[::2] *= 0.7
    cells = np.arange(2 * len(u), dtype=np.int32).reshape(-1, 2)
    nothing = np.zeros(len(h))
    return summed(lambda *folded: sum_over_edges(h, u, h_after, u_after, height, 9.8, nothing, half, cells, *folded))


def summed(kernel: Callable[[Array, Array, Array], None]) -> Array:
    coarse, fine = np.array([folds(LARGEST * SIZE, SIZE)] * 3).T
    parts = np.empty((BLOCKS, 3, 3))
    kernel(coarse.copy(), fine.copy(), parts)
    return parts[:, :, :2].sum(axis=0)


@pytest.mark.parametrize("sums", [over_cells, over_edges])
def test_parts_add_up_to_the_whole_to_the_last_bit(sums: Callable[[slice], Array]) -> None:
    """Parts of one entity are what is left over of a vector; those of many are vectors."""
    whole = sums(slice(None))
    assert np.abs(whole).min() > 0.0
    for size in (1, 13, 700):
        total = np.zeros((3, 2))
        for first in range(0, SIZE, size):
            total += sums(slice(first, first + size))
        np.testing.assert_array_equal(total, whole)

"""Array types, the one scatter-add (sums of values by the index of an entity), and functions taken block by block."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.integer]
Signs = NDArray[np.int8]

BLOCK = 8192
"""Rows that are taken together: what lies between two operations on them stays in the cache."""


def sum_by_index(index: Index, values: Array, size: int) -> Array:
    """Sum `values` to the entities `index` (same shape) of which there are `size`; result (size,)."""
    return np.bincount(index.ravel(), values.ravel(), size).astype(np.float64, copy=False)


def by_blocks(function: Callable[..., NDArray[Any]], *rows: NDArray[Any]) -> NDArray[Any]:
    """`function(*rows)` of arrays with equally many rows, each row of the result made of one row of each.

    Blocks of rows are shared among threads, which numpy lets run side by side; the bits are those of a single call.
    """
    size = len(rows[0])
    if size <= BLOCK:
        return function(*rows)
    with ThreadPoolExecutor(numba.get_num_threads()) as pool:
        starts = range(0, size, BLOCK)
        return np.concatenate(
            list(pool.map(lambda start: function(*(each[start : start + BLOCK] for each in rows)), starts))
        )

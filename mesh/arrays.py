"""Array types, the one scatter-add (sums of values by the index of an entity), and functions taken block by block."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.integer]
Signs = NDArray[np.int8]

BLOCK = 8192
"""Rows that are taken together: what lies between two operations on them stays in the cache."""


Loop = TypeVar("Loop", bound=Callable[..., Any])


def row_loop(function: Loop) -> Loop:
    """A compiled loop over rows for `by_blocks`: threads run it side by side; it loads sooner than a parallel one."""
    return cast(Loop, numba.njit(cache=True, nogil=True, fastmath=False)(function))


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
    first = function(*(each[:BLOCK] for each in rows))
    result = np.empty((size, *first.shape[1:]), first.dtype)
    result[:BLOCK] = first

    def fill(start: int) -> None:
        block = slice(start, start + BLOCK)
        result[block] = function(*(each[block] for each in rows))

    with ThreadPoolExecutor(numba.get_num_threads()) as pool:
        for _ in pool.map(fill, range(BLOCK, size, BLOCK)):
            pass
    return result

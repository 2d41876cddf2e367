"""Array types, and the one scatter-add: sums of values by the index of an entity."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.integer]
Signs = NDArray[np.int8]


def sum_by_index(index: Index, values: Array, size: int) -> Array:
    """Sum `values` to the entities `index` (same shape) of which there are `size`; result (size,)."""
    return np.bincount(index.ravel(), values.ravel(), size).astype(np.float64, copy=False)

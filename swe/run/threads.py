"""How many threads a mesh can keep busy."""

from collections.abc import Iterator
from contextlib import contextmanager

import numba

CELLS_PER_THREAD = 4000
"""A thread pays off only if it has this many cells to itself; results do not depend on the number of threads."""


@contextmanager
def worthwhile_threads(n_cells: int) -> Iterator[int]:
    """Within the context, use no more threads than `n_cells` can keep busy; yields their number."""
    available = numba.get_num_threads()
    numba.set_num_threads(max(1, min(available, n_cells // CELLS_PER_THREAD)))
    try:
        yield numba.get_num_threads()
    finally:
        numba.set_num_threads(available)

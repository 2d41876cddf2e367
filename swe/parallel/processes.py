"""What a model needs from the processes that hold the rest of its mesh: sums, extremes and neighbouring values.

Here is the implementation for one process that holds the whole mesh; `swe.parallel.mpi` has that for many. Results
depend neither on how the entities are divided among processes nor on their order.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mesh.arrays import Array, Index
from swe.parallel.exact_sum import exact_sums
from swe.state import State

Selection = slice | Index
"""Some of the entities of one kind, as arrays are indexed."""


@dataclass(frozen=True, eq=False)
class Own:
    """Cells, edges and vertices of a process's mesh that no other process counts."""

    cells: Selection
    edges: Selection
    vertices: Selection


EVERYTHING = Own(slice(None), slice(None), slice(None))


class Processes(Protocol):
    """The processes that share a mesh, seen from one of them; all of them call the same functions in the same order."""

    @property
    def alone(self) -> bool:
        """Whether this is the only one."""

    @property
    def own(self) -> Own:
        """The entities that this one counts in sums and extremes."""

    def exact_sums(self, rows: Array) -> list[float]:
        """Sum of each of `rows` (k, n) over the entities of all processes, rounded once."""

    def sums(self, values: Array) -> Array:
        """Sums over all processes of `values` that add without rounding (`swe.parallel.folding`)."""

    def largest(self, values: Array) -> Array:
        """Largest of each of `values` over all processes; NaN if any is NaN."""

    def exchange(self, state: State) -> None:
        """Write into `state` the values that other processes have computed at entities which this one only reads."""

    def exchange_in(self, cell_order: Index | None, edge_order: Index | None) -> Callable[[State], None]:
        """The same exchange of states whose values are in another order than the mesh's (None: in the mesh's)."""


class OneProcess:
    """A process that holds the whole mesh."""

    alone = True
    own = EVERYTHING

    def exact_sums(self, rows: Array) -> list[float]:
        """See `Processes`."""
        return exact_sums(rows)

    def sums(self, values: Array) -> Array:
        """See `Processes`."""
        return values

    def largest(self, values: Array) -> Array:
        """See `Processes`."""
        return values

    def exchange(self, state: State) -> None:
        """See `Processes`; there is nothing to write."""

    def exchange_in(self, cell_order: Index | None, edge_order: Index | None) -> Callable[[State], None]:
        """See `Processes`."""
        return self.exchange


ONE_PROCESS = OneProcess()


def anywhere(processes: Processes, count: int) -> int:
    """The largest `count` that any process has, the same on all of them."""
    return count if processes.alone else int(processes.largest(np.array([float(count)]))[0])

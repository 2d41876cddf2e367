"""What a model needs from the processes that hold the rest of its mesh: sums, extremes and neighbouring values.

The only implementation today is for one process that holds the whole mesh. Results depend neither on how the entities
are divided among processes nor on their order.
"""

from typing import Protocol

from mesh.arrays import Array
from swe.parallel.exact_sum import exact_sums
from swe.state import State


class Processes(Protocol):
    """The processes that share a mesh, seen from one of them; all of them call the same functions in the same order."""

    @property
    def alone(self) -> bool:
        """Whether this is the only one."""

    def exact_sums(self, rows: Array) -> list[float]:
        """Sum of each of `rows` (k, n) over the entities of all processes, rounded once."""

    def sums(self, values: Array) -> Array:
        """Sums over all processes of `values` that add without rounding (`swe.parallel.folding`)."""

    def largest(self, values: Array) -> Array:
        """Largest of each of `values` over all processes; NaN if any is NaN."""

    def exchange(self, state: State) -> None:
        """Write into `state` the values that other processes have computed at entities which this one only reads."""


class OneProcess:
    """A process that holds the whole mesh."""

    alone = True

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


ONE_PROCESS = OneProcess()

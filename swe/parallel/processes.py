"""What a run needs from the processes that hold the rest of its mesh: sums, neighbouring values, whole fields, errors.

Here is the implementation for one process that holds the whole mesh; `swe.parallel.mpi` has that for many. Results
depend neither on how the entities are divided among processes nor on their order.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeVar

import numpy as np

from mesh.arrays import Array, Index
from mesh.files.whole_mesh import MeshInMemory, WholeMesh
from mesh.voronoi_mesh import VoronoiMesh
from swe.parallel.exact_sum import exact_sums
from swe.state import State

Result = TypeVar("Result")

Place = Literal["cells", "edges", "vertices"]
"""Where the values of a field are."""

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
    def count(self) -> int:
        """How many there are."""

    @property
    def alone(self) -> bool:
        """Whether this is the only one."""

    @property
    def first(self) -> bool:
        """Whether this is the one that writes files and messages."""

    @property
    def own(self) -> Own:
        """The entities that this one counts in sums and extremes."""

    def number(self, place: Place, local: int) -> int:
        """The number in the whole mesh of an entity that has the number `local` in this process's."""

    def whole_mesh(self, mesh: VoronoiMesh) -> WholeMesh:
        """The mesh of all processes, of which this one holds `mesh`."""

    def on_first(self, action: Callable[[], Result]) -> Result:
        """What `action` returns on the first process, which alone calls it; what it raises there is raised on all."""

    def together(self, action: Callable[[], Result]) -> Result:
        """What `action`, which must not wait for other processes, returns; what it raises on one is raised on all."""

    def gathered(self, place: Place, values: Array) -> Array:
        """The whole field of `values`, in the order of the whole mesh, on the first process; empty on others."""

    def scattered(self, place: Place, values: Array) -> Array:
        """The values at the entities of this process's mesh of a whole field, given on the first process."""

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

    count = 1
    alone = True
    first = True
    own = EVERYTHING

    def number(self, _place: Place, local: int) -> int:
        """See `Processes`."""
        return local

    def whole_mesh(self, mesh: VoronoiMesh) -> WholeMesh:
        """See `Processes`."""
        return MeshInMemory(mesh)

    def on_first(self, action: Callable[[], Result]) -> Result:
        """See `Processes`."""
        return action()

    def together(self, action: Callable[[], Result]) -> Result:
        """See `Processes`."""
        return action()

    def gathered(self, _place: Place, values: Array) -> Array:
        """See `Processes`."""
        return values

    def scattered(self, _place: Place, values: Array) -> Array:
        """See `Processes`."""
        return values

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

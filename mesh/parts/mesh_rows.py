"""A mesh of which rows are asked for: one in memory, or one that stays in its file (`mesh.files.stamped_file`)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.voronoi_mesh import VoronoiMesh


class MeshRows(Protocol):
    """What cutting needs to know of a mesh."""

    @property
    def n_cells(self) -> int:
        """Number of its cells."""

    def rows(self, name: str, numbers: Index) -> NDArray:
        """The rows of an array of the mesh with these numbers, which ascend."""

    def with_arrays(self, arrays: Mapping[str, NDArray], cells: Index) -> VoronoiMesh:
        """A mesh of other `arrays`, with all else that is said of this one; it has the `cells` (n,) of this one."""


@dataclass(frozen=True, eq=False)
class RowsInMemory:
    """The rows of a mesh in memory."""

    mesh: VoronoiMesh

    @property
    def n_cells(self) -> int:
        """Number of its cells."""
        return self.mesh.n_cells

    def rows(self, name: str, numbers: Index) -> NDArray:
        """The rows of an array with these numbers."""
        values: NDArray = getattr(self.mesh, name)[numbers]
        return values

    def with_arrays(self, arrays: Mapping[str, NDArray], cells: Index) -> VoronoiMesh:
        """The mesh with other `arrays`, those of its `cells` (n,)."""
        fixed = None if self.mesh.fixed_cells is None else self.mesh.fixed_cells[cells]
        return replace(self.mesh, **arrays, fixed_cells=fixed)  # type: ignore[arg-type]

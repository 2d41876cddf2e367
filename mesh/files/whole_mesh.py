"""A whole mesh as what is written of it needs it, wherever its arrays are."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from mesh.conventions import MeshOutline
from mesh.files.io import Slabs, mesh_hash, whole_arrays, write_mesh
from mesh.files.part_of_file import write_scaled_copy
from mesh.files.stamped_file import opened_stamped_file
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import VoronoiMesh


class WholeMesh(Protocol):
    """A mesh of which a program may hold only a part."""

    @property
    def n_cells(self) -> int:
        """Number of cells."""

    @property
    def n_edges(self) -> int:
        """Number of edges."""

    def identity(self) -> str:
        """Its `mesh_hash`."""

    def opened(self) -> AbstractContextManager[tuple[MeshOutline, Slabs]]:
        """What is asked of it to define and fill the variables of a file (`mesh.files.io`)."""

    def write(self, path: AnyPath, history: str, identity: str) -> None:
        """Write it to a mesh file, see `write_mesh`; `identity` is its `mesh_hash`."""


@dataclass(frozen=True, eq=False)
class MeshInMemory:
    """A `WholeMesh` whose arrays are those of `mesh`."""

    mesh: VoronoiMesh

    @property
    def n_cells(self) -> int:
        """See `WholeMesh`."""
        return self.mesh.n_cells

    @property
    def n_edges(self) -> int:
        """See `WholeMesh`."""
        return self.mesh.n_edges

    def identity(self) -> str:
        """See `WholeMesh`."""
        return mesh_hash(self.mesh)

    def opened(self) -> AbstractContextManager[tuple[MeshOutline, Slabs]]:
        """See `WholeMesh`."""
        return nullcontext((self.mesh, whole_arrays(self.mesh)))

    def write(self, path: AnyPath, history: str, identity: str) -> None:
        """See `WholeMesh`."""
        write_mesh(self.mesh, path, history, known_hash=identity)


@dataclass(frozen=True)
class MeshInFile:
    """A `WholeMesh` in a stamped file at `path`, on a sphere of `radius` metres, zero on a plane; nobody holds it all.

    `scaled_hash` is its `mesh_hash` on that sphere (`mesh.files.part_of_file.scaled_hash_of_file`).
    """

    path: Path
    radius: float
    scaled_hash: str
    n_cells: int
    n_edges: int

    def identity(self) -> str:
        """See `WholeMesh`."""
        return self.scaled_hash

    @contextmanager
    def opened(self) -> Iterator[tuple[MeshOutline, Slabs]]:
        """See `WholeMesh`."""
        with opened_stamped_file(self.path) as file:
            scaled = file.scaled(self.radius)
            yield scaled, scaled.slabs

    def write(self, path: AnyPath, history: str, identity: str) -> None:
        """See `WholeMesh`."""
        write_scaled_copy(self.path, path, self.radius, identity, history)


def mesh_in_file(path: Path, radius: float, scaled_hash: str) -> MeshInFile:
    """The mesh of a stamped file; raises `MeshError` if that cannot be read."""
    with opened_stamped_file(path) as file:
        return MeshInFile(path, radius, scaled_hash, file.n_cells, file.n_edges)

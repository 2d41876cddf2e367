"""A whole mesh as what is written of it needs it, wherever its arrays are."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import netCDF4

from mesh.files.io import define_mesh_variables, fill_mesh_variables, mesh_attributes, mesh_hash, read_mesh, write_mesh
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

    def attributes(self, history: str, identity: str) -> dict[str, object]:
        """See `mesh_attributes`."""

    def define(self, file: netCDF4.Dataset, names: frozenset[str]) -> None:
        """See `define_mesh_variables`."""

    def fill(self, file: netCDF4.Dataset, names: frozenset[str]) -> None:
        """See `fill_mesh_variables`."""

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

    def attributes(self, history: str, identity: str) -> dict[str, object]:
        """See `WholeMesh`."""
        return mesh_attributes(self.mesh, history, identity)

    def define(self, file: netCDF4.Dataset, names: frozenset[str]) -> None:
        """See `WholeMesh`."""
        define_mesh_variables(file, self.mesh, names)

    def fill(self, file: netCDF4.Dataset, names: frozenset[str]) -> None:
        """See `WholeMesh`."""
        fill_mesh_variables(file, self.mesh, names)

    def write(self, path: AnyPath, history: str, identity: str) -> None:
        """See `WholeMesh`."""
        write_mesh(self.mesh, path, history, known_hash=identity)


@dataclass(frozen=True)
class MeshInFile:
    """INTERIM"""

    path: Path
    radius: float
    known: str
    n_cells: int
    n_edges: int

    def _mesh(self):
        return read_mesh(self.path).scaled(self.radius)

    def identity(self) -> str:
        return self.known

    def attributes(self, history: str, identity: str) -> dict[str, object]:
        return mesh_attributes(self._mesh(), history, identity)

    def define(self, file, names) -> None:
        define_mesh_variables(file, self._mesh(), names)

    def fill(self, file, names) -> None:
        fill_mesh_variables(file, self._mesh(), names)

    def write(self, path, history, identity) -> None:
        write_mesh(self._mesh(), path, history, known_hash=identity)


def mesh_in_file(path, radius, identity):
    mesh = read_mesh(path)
    return MeshInFile(path, radius, identity, mesh.n_cells, mesh.n_edges)

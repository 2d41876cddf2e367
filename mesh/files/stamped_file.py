"""A mesh file with the stamp of a validated mesh, of which no more than a slab is in memory."""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.conventions import BY_NAME, DIMENSIONS, MESH_VARIABLES
from mesh.density.record import read_generation
from mesh.errors import MeshError
from mesh.files.mesh_file import opened_mesh_file, periods_of, positive_number, read_variable
from mesh.files.stamp import stamp_of
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import AREA_NAMES, LENGTH_NAMES, VoronoiMesh, scale_factor

SLAB = 4 * 1024 * 1024
"""Bytes that are read together."""


class NotValidatedError(MeshError):
    """The file has no stamp, so that its mesh must be read whole."""


@dataclass(frozen=True, eq=False)
class StampedFile:
    """The mesh of an open file, taken as it is: whether it has the hash of the `stamp` is not checked.

    `sphere_radius` is that of the mesh, to which lengths are multiplied by `factor` where there is one; it is zero on a
    plane, of which `x_period` and `y_period` are the periods.
    """

    path: Path
    file: netCDF4.Dataset
    stamp: str
    sphere_radius: float
    factor: float | None = None
    x_period: float = 0.0
    y_period: float = 0.0

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return self._size("n_cells")

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return self._size("n_edges")

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return self._size("n_vertices")

    @property
    def max_edges(self) -> int:
        """Width of the rings of cells."""
        return self._size("max_edges")

    @property
    def density_name(self) -> str:
        """The name of the density that the mesh was generated for."""
        return self._generation[0]

    @property
    def density_source(self) -> str:
        """Where that density is found."""
        return self._generation[1]

    @property
    def fixed_cells(self) -> NDArray[np.bool_] | None:
        """Which generators were held (n_cells,), None if none were."""
        return self._generation[2]

    def scaled(self, radius: float) -> "StampedFile":
        """The same mesh on a sphere of another radius, in metres, with the bits of `VoronoiMesh.scaled`."""
        return replace(self, sphere_radius=float(radius), factor=scale_factor(self.sphere_radius, radius))

    def rescale(self, name: str, values: NDArray) -> NDArray:
        """Values of an array as the file has them, on the sphere of this mesh."""
        if self.factor is not None and name in LENGTH_NAMES:
            return values * self.factor
        if self.factor is not None and name in AREA_NAMES:
            return values * self.factor**2
        return values

    def rows(self, name: str, numbers: Index) -> NDArray:
        """The rows of an array with these numbers, which ascend; only slabs that hold one of them are read."""
        variable, height, first = BY_NAME[name], self._slab_height(name), 0
        shape = (len(numbers), *self.file.variables[variable.file_name].shape[1:])
        result: NDArray = np.empty(shape, np.int32 if variable.integer else np.float64)
        while first < len(numbers):
            low = int(numbers[first])
            last = int(np.searchsorted(numbers, low + height))
            values = self._read(name, low, int(numbers[last - 1]) + 1)
            result[first:last] = values[numbers[first:last] - low]
            first = last
        return result

    def slabs(self, name: str) -> Iterator[NDArray]:
        """An array as consecutive rows of it."""
        size, height = self._size(BY_NAME[name].dimensions[0]), self._slab_height(name)
        for low in range(0, size, height):
            yield self._read(name, low, min(low + height, size))

    def with_arrays(self, arrays: Mapping[str, NDArray], cells: Index) -> VoronoiMesh:
        """A mesh of these `arrays`, which has the `cells` (n,) of this one."""
        return VoronoiMesh(
            **arrays,
            sphere_radius=self.sphere_radius,
            density_name=self.density_name,
            density_source=self.density_source,
            fixed_cells=None if self.fixed_cells is None else self.fixed_cells[cells],
            x_period=self.x_period,
            y_period=self.y_period,
        )

    @cached_property
    def _generation(self) -> tuple[str, str, NDArray[np.bool_] | None]:
        return read_generation(self.file, self.n_cells)

    def _size(self, dimension: str) -> int:
        return len(self.file.dimensions[DIMENSIONS[dimension]])

    def _slab_height(self, name: str) -> int:
        source = self.file.variables[BY_NAME[name].file_name]
        width = int(np.prod(source.shape[1:])) * source.dtype.itemsize
        return max(SLAB // width, 1)

    def _read(self, name: str, low: int, high: int) -> NDArray:
        variable = BY_NAME[name]
        try:
            values = read_variable(self.file, variable, slice(low, high))
        except (OSError, RuntimeError, IndexError, ValueError) as error:
            raise MeshError(
                f"{self.path}: {variable.file_name} cannot be read ({error}); make the file anew"
            ) from error
        if values is None:
            raise MeshError(f"{self.path}: {variable.file_name} is missing or no array of numbers; make the file anew")
        return self.rescale(name, values)


@contextmanager
def opened_stamped_file(path: AnyPath) -> Iterator[StampedFile]:
    """A mesh file with a stamp; raises `NotValidatedError` where it has none, `MeshError` where it cannot be read."""
    path = Path(path)
    with ExitStack() as stack:
        try:
            file = stack.enter_context(opened_mesh_file(path))
        except MeshError as error:
            raise MeshError(f"{path}: {error}") from error
        stamp, periods = stamp_of(file), periods_of(file)
        radius = positive_number(getattr(file, "sphere_radius", None)) if periods is None else 0.0
        whole = all(variable.file_name in file.variables for variable in MESH_VARIABLES)
        if not stamp or radius is None or not whole:
            raise NotValidatedError(
                f"{path}: the file has no stamp of a validated mesh; read the mesh with read_mesh and write it anew"
            )
        yield StampedFile(path, file, stamp, radius, None, *(periods or ()))

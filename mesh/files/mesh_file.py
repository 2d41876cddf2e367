"""The content of an MPAS mesh file in the conventions of memory: arrays of any type, not yet checked."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.conventions import DIMENSIONS, MESH_VARIABLES, MeshVariable
from mesh.discrete.topology import FILL
from mesh.errors import MeshError
from mesh.files.stamp import stamp_of
from mesh.geometry.surface import Surface, surface_of
from mesh.safe_files import dataset

SIZES = {"two": 2, "vertex_degree": 3}
"""Of dimensions that have one size in all meshes."""

EVERY_ROW = slice(None)

LARGEST_INDEX = np.iinfo(np.int32).max - 1

SPARE = frozenset(
    {
        *(f"{axis}_{place}" for axis in ("lat", "lon") for place in ("cell", "edge", "vertex")),
        *("x_edge", "y_edge", "z_edge", "angle_edge", "mesh_density", "boundary_vertex"),
    }
)
"""Arrays that no step of the solver depends on: they are rebuilt where they are missing, unreadable or wrong."""


@dataclass(frozen=True)
class FileContent:
    """The arrays that a file holds, by their names in memory, and what its attributes say.

    What stands beyond the rings is what the file has there. `radius` is as the attribute has it, None where there is
    none. `single_precision` says whether coordinates of the generators were rounded to 32 bits. `stamp` is that of a
    validated mesh (`mesh.files.stamp`), empty where there is none. `periods` are those of a plane, metres, None on a
    sphere.
    """

    arrays: dict[str, NDArray]
    radius: object
    n_cells: int
    single_precision: bool
    stamp: str
    periods: tuple[float, float] | None = None

    @property
    def on_a_sphere(self) -> bool:
        """Whether the mesh is on a sphere, and not on a plane."""
        return self.periods is None

    @property
    def surface(self) -> Surface:
        """What the mesh is on."""
        return surface_of(self._Outline(1.0) if self.periods is None else self._Outline(0.0, *self.periods))

    class _Outline(NamedTuple):
        """See `mesh.geometry.surface.OnSurface`."""

        sphere_radius: float
        x_period: float = 0.0
        y_period: float = 0.0


@contextmanager
def opened_mesh_file(path: Path) -> Iterator[netCDF4.Dataset]:
    """A mesh file to be read; raises `MeshError`, which does not name it, where it is none."""
    try:
        with dataset(path) as file:
            file.set_auto_mask(False)
            yield file
    except MeshError:
        raise
    except (OSError, RuntimeError, IndexError, ValueError) as error:
        reason = f"not a readable NetCDF file ({error})" if path.is_file() else "no such file"
        raise MeshError(f"{reason}; give an MPAS mesh file") from error


def read_content(file: netCDF4.Dataset, names: frozenset[str] | None = None) -> FileContent:
    """All parts of a mesh that the file holds, or those of `names` alone.

    Indices count from 0, and what is no index is -1; angles are in radians. Raises `MeshError` where a periodic plane
    has no periods, or where a variable that the solver needs has other dimensions or no numbers.
    """
    periods, arrays = periods_of(file), {}
    for variable in MESH_VARIABLES:
        values = read_variable(file, variable) if names is None or variable.name in names else None
        if values is not None:
            arrays[variable.name] = values
    sources = [file.variables[name] for name in ("xCell", "yCell", "zCell") if name in file.variables]
    sources = sources or [file.variables[name] for name in ("lonCell", "latCell") if name in file.variables]
    return FileContent(
        arrays=arrays,
        radius=getattr(file, "sphere_radius", None),
        n_cells=len(file.dimensions["nCells"]) if "nCells" in file.dimensions else 0,
        single_precision=any(source.dtype == np.float32 for source in sources),
        stamp=stamp_of(file),
        periods=periods,
    )


def periods_of(file: netCDF4.Dataset) -> tuple[float, float] | None:
    """Periods of the plane that the mesh of a file is on, metres, zero for none; None on a sphere.

    Raises `MeshError` where a periodic plane does not say after which lengths it repeats itself.
    """
    if _says_yes(file, "on_a_sphere", "YES"):
        return None
    if not _says_yes(file, "is_periodic", "NO"):
        return 0.0, 0.0
    given = {name: getattr(file, name, 0.0) for name in ("x_period", "y_period")}
    x_period, y_period = (positive_number(value) or 0.0 for value in given.values())
    if x_period == y_period == 0.0:
        raise MeshError(
            f"is_periodic is YES, but x_period and y_period are {given['x_period']} and {given['y_period']}; give the "
            "lengths after which the plane repeats itself, in metres"
        )
    return x_period, y_period


def _says_yes(file: netCDF4.Dataset, name: str, default: str) -> bool:
    return str(getattr(file, name, default)).strip().upper() == "YES"


def positive_number(attribute: object) -> float | None:
    """The attribute as a positive number, None if it is not one."""
    try:
        number = float(attribute)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) and number > 0.0 else None


def read_variable(file: netCDF4.Dataset, variable: MeshVariable, rows: slice = EVERY_ROW) -> NDArray | None:
    """One array, or some rows of it; None where it is absent, or spare and unreadable."""
    if variable.file_name not in file.variables:
        return None
    source = file.variables[variable.file_name]
    problem = _problem(source, variable)
    if problem and variable.name in SPARE:
        return None
    if problem:
        raise MeshError(f"{variable.file_name} {problem}")
    values = np.asarray(source[rows])
    if variable.integer:
        return _whole_numbers(values, 1 if variable.is_index else 0)
    numbers = np.ascontiguousarray(values, dtype=np.float64)
    return np.deg2rad(numbers) if _in_degrees(source) else numbers


def _problem(source: netCDF4.Variable, variable: MeshVariable) -> str:
    """Why a variable cannot be read, in words; empty if it can."""
    expected = tuple(DIMENSIONS[dimension] for dimension in variable.dimensions)
    if source.dimensions != expected:
        return f"has dimensions {source.dimensions} instead of {expected}"
    for name, size in zip(variable.dimensions, source.shape, strict=True):
        if size != SIZES.get(name, size):
            return f"has a dimension {DIMENSIONS[name]} of {size} instead of {SIZES[name]}"
    if source.dtype is str or source.dtype.kind not in "iuf":
        return f"holds {source.dtype} instead of numbers"
    return ""


def _in_degrees(source: netCDF4.Variable) -> bool:
    return str(getattr(source, "units", "")).strip().lower().startswith("deg")


def _whole_numbers(values: NDArray, first: int) -> NDArray:
    """Values of any type as int32 that count from 0 where the file counts from `first`; -1 what is no whole number.

    `values` may be changed in place.
    """
    if values.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            values = np.where(np.abs(values) <= LARGEST_INDEX, values, np.nan)
            values = np.where(values == np.rint(values), values, first - 1.0)
    elif (
        values.dtype.itemsize >= np.dtype(np.int32).itemsize
        and values.size
        and not 0 <= values.min() <= values.max() <= LARGEST_INDEX
    ):
        values = np.where((values <= LARGEST_INDEX) & (values >= 0), values, first - 1)
    numbers = np.ascontiguousarray(values, dtype=np.int32)
    return np.subtract(numbers, first, out=numbers) if first else numbers


def fill_rings(arrays: dict[str, NDArray]) -> None:
    """Replace all entries beyond the count of each ring, by arrays of their own."""
    for count, rings in (
        ("n_edges_on_cell", ("cells_on_cell", "edges_on_cell", "vertices_on_cell")),
        ("n_edges_on_edge", ("edges_on_edge", "weights_on_edge")),
    ):
        for ring in rings:
            if count in arrays and ring in arrays:
                values = arrays[ring]
                beyond = np.arange(values.shape[1]) >= arrays[count][:, None]
                fill = 0.0 if ring == "weights_on_edge" else FILL
                arrays[ring] = np.where(beyond, values.dtype.type(fill), values)

"""The content of an MPAS mesh file in the conventions of memory: arrays of any type, not yet checked."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.conventions import DIMENSIONS, MESH_VARIABLES, MeshVariable
from mesh.discrete.topology import FILL
from mesh.errors import MeshError
from mesh.files.stamp import stamp_of
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
    validated mesh (`mesh.files.stamp`), empty where there is none.
    """

    arrays: dict[str, NDArray]
    radius: object
    n_cells: int
    single_precision: bool
    stamp: str


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

    Indices count from 0, and what is no index is -1; angles are in radians. Raises `MeshError` where the mesh is on no
    sphere, or where a variable that the solver needs has other dimensions or no numbers.
    """
    if str(getattr(file, "on_a_sphere", "YES")).strip().upper() != "YES":
        raise MeshError("the mesh is not on a sphere (on_a_sphere is not YES); only global meshes are supported")
    arrays = {}
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
    )


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

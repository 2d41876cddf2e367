"""Reading and writing MPAS mesh files; the only place with indices that start at 1."""

import hashlib
import math
import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.conventions import (
    BY_NAME,
    DIMENSIONS,
    MESH_VARIABLES,
    MeshOutline,
    MeshVariable,
    coordinates_on,
    dimension_sizes,
)
from mesh.density.record import define_generation, fill_generation, read_generation
from mesh.discrete.validate import OUTSIDE_TOLERANCE, OWN_TOLERANCE, validate_metrics
from mesh.errors import MeshError, MeshWarning
from mesh.files.assembly import assembled_mesh
from mesh.files.mesh_file import FileContent, opened_mesh_file, positive_number, read_content
from mesh.files.stamp import stamp_attributes
from mesh.safe_files import AnyPath, dataset, definitions, written_aside
from mesh.validated import is_validated, remember_validated
from mesh.voronoi_mesh import VoronoiMesh

PLACES = {"cell": "n_cells", "edge": "n_edges", "vertex": "n_vertices"}
STANDARD_NAMES = {"lon": "longitude", "lat": "latitude"}

SINGLE_DIMENSIONS = ("nVertLevels", "nTracers")
"""Of length 1: VTK's reader looks for the first, MPAS's shallow-water core for both. No array of a mesh has them."""

Slabs = Callable[[str], Iterable[NDArray]]
"""The array of this name, as consecutive rows of it."""

Generation = tuple[str, str, NDArray[np.bool_] | None]
"""Name and source of the density that a mesh was generated for, and which of its generators were held."""

SLAB = 1 << 18
"""Rows of an array of indices that are written together."""

FORMATS: dict[str, Literal["NETCDF4", "NETCDF3_64BIT_DATA", "NETCDF3_64BIT_OFFSET"]] = {
    "netcdf4": "NETCDF4",
    "cdf5": "NETCDF3_64BIT_DATA",
    "classic": "NETCDF3_64BIT_OFFSET",
}
"""Formats of mesh files: HDF5, and what programs read that are built with PnetCDF."""

LARGEST_CLASSIC = 2**32 - 4
"""Bytes of the largest array that a file of the format `classic` can hold."""

FEWEST_EDGES = 6
"""Width of the narrowest rings of a global mesh of more than 12 cells."""


def mesh_hash(mesh: VoronoiMesh) -> str:
    """SHA-256, in hexadecimal, of every array of the mesh and its radius, or the periods of its plane."""
    digest = hash_of_surface(mesh)
    for variable in MESH_VARIABLES:
        digest.update(np.ascontiguousarray(getattr(mesh, variable.name)).reshape(-1).data)
    return digest.hexdigest()


def hash_of_surface(mesh: MeshOutline) -> "hashlib._Hash":
    """What `mesh_hash` begins with."""
    on = [mesh.sphere_radius] if mesh.sphere_radius > 0.0 else [0.0, mesh.x_period, mesh.y_period]
    return hashlib.sha256(np.array(on, np.float64).tobytes())


def write_mesh(
    mesh: VoronoiMesh, path: AnyPath, history: str = "", file_format: str = "netcdf4", known_hash: str | None = None
) -> None:
    """Write an MPAS mesh file (MPAS Mesh Specification 1.0) in one of `FORMATS`.

    `history` tells how the mesh was made; `known_hash` is its `mesh_hash`, where that is known. A mesh that has passed
    validation as it is gets the stamp of `mesh.files.stamp`. Raises `MeshError` where the file cannot be written.
    """
    identity = known_hash or mesh_hash(mesh)
    write_arrays(mesh, whole_arrays(mesh), Path(path), history, file_format, identity, is_validated(mesh))


def write_arrays(
    mesh: MeshOutline, slabs: Slabs, path: Path, history: str, file_format: str, identity: str, validated: bool
) -> None:
    """Write a mesh file of arrays that come in `slabs`; `identity` is their hash, the stamp if they are `validated`."""
    require_format(file_format, dimension_sizes(mesh))
    try:
        with written_aside(path) as aside, dataset(aside, "w", format=FORMATS[file_format]) as file:
            stamp = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
            history = f"{stamp}: {history or 'written by trisk'}"
            with definitions(file):
                file.createDimension("Time", None)  # of no length; some readers of the format ask for it
                file.setncatts(mesh_attributes(mesh, history, identity))
                if validated:
                    file.setncatts(stamp_attributes(identity))
                define_mesh_variables(file, mesh)
                define_generation(file, mesh)
            fill_variables(file, mesh, slabs)
            fill_generation(file, mesh)
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MeshError(f"{path}: cannot be written ({reason}); choose another place, or make room") from error


def require_format(file_format: str, sizes: dict[str, int] | None = None) -> None:
    """Raise `MeshError` where there is no such format of mesh files, or it holds no mesh of these dimensions."""
    if file_format not in FORMATS:
        raise MeshError(f"there is no format of mesh files named '{file_format}'; choose one of {', '.join(FORMATS)}")
    if sizes is None or file_format != "classic":
        return
    for variable in MESH_VARIABLES:
        size = math.prod((4 if variable.integer else 8, *(sizes[dimension] for dimension in variable.dimensions)))
        if size > LARGEST_CLASSIC:
            raise MeshError(
                f"{variable.file_name} of {sizes['n_cells']} cells takes {size / 1e9:.1f} GB, and files of the format "
                f"classic hold arrays of {LARGEST_CLASSIC / 1e9:.1f} GB at most; choose the format cdf5 or netcdf4"
            )


def least_sizes(n_cells: int) -> dict[str, int]:
    """Size of every dimension that a global mesh of so many cells has at least."""
    return {
        "n_cells": n_cells,
        "n_edges": 3 * n_cells - 6,
        "n_vertices": 2 * n_cells - 4,
        "max_edges": FEWEST_EDGES,
        "max_edges_2": 2 * FEWEST_EDGES,
        "two": 2,
        "vertex_degree": 3,
    }


def mesh_attributes(mesh: MeshOutline, history: str, identity: str) -> dict[str, object]:
    """Global attributes that MPAS readers expect; `identity` is the hash of the mesh."""
    return {
        **surface_attributes(mesh),
        "mesh_spec": "1.0",
        "Conventions": "MPAS",
        "source": "trisk",
        "history": history,
        "file_id": identity[:10],
        "density_name": mesh.density_name,
    }


def surface_attributes(mesh: MeshOutline) -> dict[str, object]:
    """Global attributes that say what a mesh is on."""
    if mesh.sphere_radius > 0.0:
        return {"on_a_sphere": "YES", "sphere_radius": float(mesh.sphere_radius), "is_periodic": "NO"}
    periodic = max(mesh.x_period, mesh.y_period) > 0.0
    return {
        "on_a_sphere": "NO",
        "sphere_radius": 0.0,
        "is_periodic": "YES" if periodic else "NO",
        "x_period": float(mesh.x_period),
        "y_period": float(mesh.y_period),
    }


def define_mesh_variables(file: netCDF4.Dataset, mesh: MeshOutline, names: frozenset[str] | None = None) -> None:
    """Define the mesh's dimensions in an open file and its arrays, or those in `names` only.

    All of their values are written, so none is filled before.
    """
    sizes = dimension_sizes(mesh)
    for name, size in sizes.items():
        file.createDimension(DIMENSIONS[name], size)
    for name in SINGLE_DIMENSIONS:
        file.createDimension(name, 1)
    for place, dimension in PLACES.items():
        identifier = file.createVariable(
            f"indexTo{place.capitalize()}ID", "i4", (DIMENSIONS[dimension],), fill_value=False
        )
        identifier.long_name = f"number of each {place}"
    for variable in _variables(names):
        dimensions = tuple(DIMENSIONS[dimension] for dimension in variable.dimensions)
        target = file.createVariable(
            variable.file_name, "i4" if variable.integer else "f8", dimensions, fill_value=False
        )
        target.setncatts({"units": variable.units, "long_name": variable.long_name, **_coordinates(variable, mesh)})


def whole_arrays(mesh: VoronoiMesh) -> Slabs:
    """The arrays of a mesh in memory."""
    return lambda name: _slabs(getattr(mesh, name), BY_NAME[name])


def _slabs(values: NDArray, variable: MeshVariable) -> list[NDArray]:
    """The library takes whole arrays of numbers as they are; those of indices go in slabs, each a little copy."""
    rows = SLAB if variable.is_index else max(len(values), 1)
    return [values[low : low + rows] for low in range(0, len(values), rows)]


def fill_variables(file: netCDF4.Dataset, mesh: MeshOutline, slabs: Slabs, names: frozenset[str] | None = None) -> None:
    """Write what `define_mesh_variables` has defined, of arrays that come in `slabs`."""
    sizes = dimension_sizes(mesh)
    for place, dimension in PLACES.items():
        file[f"indexTo{place.capitalize()}ID"][:] = np.arange(1, sizes[dimension] + 1, dtype=np.int32)
    for variable in _variables(names):
        target, start = file[variable.file_name], 0
        for values in slabs(variable.name):
            target[start : start + len(values)] = values + 1 if variable.is_index else values
            start += len(values)


def _variables(names: frozenset[str] | None) -> list[MeshVariable]:
    return [variable for variable in MESH_VARIABLES if names is None or variable.name in names]


def _coordinates(variable: MeshVariable, mesh: MeshOutline) -> dict[str, str]:
    """Attributes by which readers of the CF conventions find the place of an array's values."""
    kind, *_ = variable.name.split("_")
    on_a_sphere = mesh.sphere_radius > 0.0
    if kind in STANDARD_NAMES:
        return {"standard_name": STANDARD_NAMES[kind]} if on_a_sphere else {}
    if kind in ("x", "y") and not on_a_sphere:
        return {}
    return {"coordinates": coordinates_on(mesh)[DIMENSIONS[variable.dimensions[0]]]}


def read_mesh(path: AnyPath, recompute_metrics: bool = False) -> VoronoiMesh:
    """Read and validate an MPAS mesh file of any origin: classic, 64-bit or NetCDF-4, of any sphere radius or planar.

    A file that holds exactly what was validated before trisk wrote it is not validated again.

    Rings in another order are sorted, and what is missing or no step depends on is rebuilt from the generators and
    triangles. With `recompute_metrics`, all lengths, areas, kites, angles and weights are. Warns with `MeshWarning`, in
    one line, of what was changed and where the identities of the mesh hold to `OUTSIDE_TOLERANCE` but not to
    `OWN_TOLERANCE`; raises `MeshError` where the file cannot be read or is not a valid mesh.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        raise MeshError(f"{path}: not a file; give an MPAS mesh file")
    try:
        content, generation = _read(path)
        stamped = None if recompute_metrics else _stamped_mesh(content)
        if stamped is not None:
            mesh = _made_for(stamped, generation)
            remember_validated(mesh)
            return mesh
        mesh, changes = assembled_mesh(content, recompute_metrics)
        residuals = validate_metrics(mesh, None, OUTSIDE_TOLERANCE)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error
    mesh = _made_for(mesh, generation)
    said = [changes.in_words] if changes.in_words else []
    worst = max(residuals, key=lambda name: residuals[name])
    if residuals[worst] > OWN_TOLERANCE:
        said.append(f"{worst} holds only to {residuals[worst]:.1e}; recompute the metrics for better conservation")
    if said:
        warnings.warn(f"{path}: {'; '.join(said)}", MeshWarning, stacklevel=2)
    else:
        remember_validated(mesh)
    return mesh


def _stamped_mesh(content: FileContent) -> VoronoiMesh | None:
    """The mesh of a file as it is, None unless the hash of its arrays is that of the stamp."""
    radius = positive_number(content.radius) if content.on_a_sphere else 0.0
    whole = len(content.arrays) == len(MESH_VARIABLES) and not content.single_precision
    if not content.stamp or radius is None or not whole:
        return None
    x_period, y_period = content.periods or (0.0, 0.0)
    mesh = VoronoiMesh(**content.arrays, sphere_radius=radius, x_period=x_period, y_period=y_period)  # type: ignore[arg-type]
    return mesh if mesh_hash(mesh) == content.stamp else None


def _made_for(mesh: VoronoiMesh, generation: Generation) -> VoronoiMesh:
    """The mesh with what its file says of how it was generated."""
    name, source, fixed = generation
    return replace(mesh, density_name=name, density_source=source, fixed_cells=fixed)


def _read(path: Path) -> tuple[FileContent, Generation]:
    """The content of a mesh file, and how the mesh was generated."""
    with opened_mesh_file(path) as file:
        content = read_content(file)
        return content, read_generation(file, content.n_cells)

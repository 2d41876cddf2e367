"""MPAS mesh files, read and written; the only place that knows indices that count from 1."""

import hashlib
import os
import warnings
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.conventions import DIMENSIONS, MESH_VARIABLES, MeshVariable, dimension_sizes
from mesh.density_record import read_generation, write_generation
from mesh.errors import MeshError, MeshWarning
from mesh.files import dataset, written_aside
from mesh.metrics import compute_metrics
from mesh.sphere import normalize, to_lonlat
from mesh.topology import FILL
from mesh.validate import OUTSIDE_TOLERANCE, OWN_TOLERANCE, validate_mesh, validate_topology
from mesh.voronoi_mesh import METRICS_NAMES, VoronoiMesh

PLACES = {"cell": "n_cells", "edge": "n_edges", "vertex": "n_vertices"}


def mesh_hash(mesh: VoronoiMesh) -> str:
    """SHA-256, in hexadecimal, of every array of the mesh and its radius."""
    digest = hashlib.sha256(np.float64(mesh.sphere_radius).tobytes())
    for variable in MESH_VARIABLES:
        digest.update(np.ascontiguousarray(getattr(mesh, variable.name)).tobytes())
    return digest.hexdigest()


def write_mesh(mesh: VoronoiMesh, path: str | os.PathLike[str], history: str = "") -> None:
    """Write an MPAS mesh file (NetCDF-4, MPAS Mesh Specification 1.0).

    `history` tells how the mesh was made. Raises `MeshError` where the file cannot be written.
    """
    path = Path(path)
    try:
        with written_aside(path) as aside, dataset(aside, "w", format="NETCDF4") as file:
            stamp = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
            file.setncatts(mesh_attributes(mesh, f"{stamp}: {history or 'written by trisk'}"))
            write_mesh_variables(file, mesh)
            write_generation(file, mesh)
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MeshError(f"{path}: cannot be written ({reason}); choose another place, or make room") from error


def mesh_attributes(mesh: VoronoiMesh, history: str) -> dict[str, object]:
    """Global attributes that MPAS readers expect."""
    return {
        "on_a_sphere": "YES",
        "sphere_radius": float(mesh.sphere_radius),
        "is_periodic": "NO",
        "mesh_spec": "1.0",
        "Conventions": "MPAS",
        "source": "trisk",
        "history": history,
        "file_id": mesh_hash(mesh)[:10],
        "density_name": mesh.density_name,
    }


def write_mesh_variables(file: netCDF4.Dataset, mesh: VoronoiMesh, names: frozenset[str] | None = None) -> None:
    """Define the mesh's dimensions in an open file and write its arrays, or those in `names` only."""
    sizes = dimension_sizes(mesh)
    for name, size in sizes.items():
        file.createDimension(DIMENSIONS[name], size)
    for place, dimension in PLACES.items():
        identifier = file.createVariable(f"indexTo{place.capitalize()}ID", "i4", (DIMENSIONS[dimension],))
        identifier.long_name = f"number of each {place}"
        identifier[:] = np.arange(1, sizes[dimension] + 1)
    for variable in MESH_VARIABLES:
        if names is not None and variable.name not in names:
            continue
        dimensions = tuple(DIMENSIONS[dimension] for dimension in variable.dimensions)
        target = file.createVariable(variable.file_name, "i4" if variable.integer else "f8", dimensions)
        target.setncatts({"units": variable.units, "long_name": variable.long_name})
        values = getattr(mesh, variable.name)
        target[:] = values + 1 if variable.is_index else values


def read_mesh(path: str | os.PathLike[str], recompute_metrics: bool = False) -> VoronoiMesh:
    """Read and validate an MPAS mesh file of any origin: classic, 64-bit or NetCDF-4, of any sphere radius.

    With `recompute_metrics`, lengths, areas, kites, angles and weights are built anew from the generators and the
    file's connectivity. Warns with `MeshWarning` where the identities of the mesh hold to `OUTSIDE_TOLERANCE` but
    not to `OWN_TOLERANCE`; raises `MeshError` where the file cannot be read or is not a valid mesh.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        raise MeshError(f"{path}: this is no file; give an MPAS mesh file")
    try:
        with dataset(path) as file:
            file.set_auto_mask(False)
            mesh = _mesh_from_file(file)
        if recompute_metrics:
            mesh = with_recomputed_metrics(mesh)
        residuals = validate_mesh(mesh, OUTSIDE_TOLERANCE)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error
    except (OSError, RuntimeError, IndexError, ValueError) as error:
        reason = "no such file" if not path.exists() else f"not a readable NetCDF file ({error})"
        raise MeshError(f"{path}: {reason}; give an MPAS mesh file") from error
    worst = max(residuals, key=lambda name: residuals[name])
    if residuals[worst] > OWN_TOLERANCE:
        warnings.warn(
            f"{path}: {worst} holds only to {residuals[worst]:.1e}; recompute the metrics for better conservation",
            MeshWarning,
            stacklevel=2,
        )
    return mesh


def with_recomputed_metrics(mesh: VoronoiMesh) -> VoronoiMesh:
    """`mesh` with all metrics built anew from its generators, its connectivity kept.

    Raises `MeshError` where the generators are not finite or the connectivity is inconsistent.
    """
    validate_topology(mesh)
    unit = compute_metrics(normalize(mesh.cell_points), mesh)
    metrics = {name: getattr(unit, name) for name in METRICS_NAMES}
    return replace(mesh, sphere_radius=1.0, **metrics).scaled(mesh.sphere_radius)


def _mesh_from_file(file: netCDF4.Dataset) -> VoronoiMesh:
    if str(getattr(file, "on_a_sphere", "YES")).strip().upper() != "YES":
        raise MeshError("the mesh is not on a sphere (on_a_sphere is not YES); only global meshes are supported")
    arrays = {variable.name: _read(file, variable) for variable in MESH_VARIABLES}
    present = {name: values for name, values in arrays.items() if values is not None}
    for place in PLACES:
        lon, lat = to_lonlat(np.stack([present[f"{axis}_{place}"] for axis in "xyz"], axis=-1))
        present.setdefault(f"lon_{place}", lon)
        present.setdefault(f"lat_{place}", lat)
    present.setdefault("mesh_density", np.ones(len(present["x_cell"])))
    present.setdefault("boundary_vertex", np.zeros(len(present["x_vertex"]), dtype=np.int32))
    for ring in ("cells_on_cell", "edges_on_cell", "vertices_on_cell"):
        present[ring] = _fill_beyond(present[ring], present["n_edges_on_cell"], FILL)
    for ring, fill in (("edges_on_edge", FILL), ("weights_on_edge", 0.0)):
        present[ring] = _fill_beyond(present[ring], present["n_edges_on_edge"], fill)
    name, source, fixed = read_generation(file, len(present["x_cell"]))
    return VoronoiMesh(
        sphere_radius=_sphere_radius(file), density_name=name, density_source=source, fixed_cells=fixed, **present
    )


def _sphere_radius(file: netCDF4.Dataset) -> float:
    if "sphere_radius" not in file.ncattrs():
        raise MeshError("the attribute sphere_radius is missing; add the radius that the coordinates have")
    try:
        radius = float(file.sphere_radius)
    except (TypeError, ValueError):
        radius = float("nan")
    if not (np.isfinite(radius) and radius > 0.0):
        raise MeshError(f"the attribute sphere_radius is '{file.sphere_radius}'; it must be a positive number")
    return radius


def _read(file: netCDF4.Dataset, variable: MeshVariable) -> NDArray | None:
    """One array in memory's conventions; None where an optional one is absent."""
    if variable.file_name not in file.variables:
        if variable.required:
            raise MeshError(f"the variable {variable.file_name} is missing; a mesh file must have it")
        return None
    source = file.variables[variable.file_name]
    expected = tuple(DIMENSIONS[dimension] for dimension in variable.dimensions)
    if source.dimensions != expected:
        raise MeshError(f"{variable.file_name} has dimensions {source.dimensions} instead of {expected}")
    if source.dtype is str or source.dtype.kind not in "iuf":
        raise MeshError(f"{variable.file_name} holds {source.dtype} instead of numbers")
    values = np.asarray(source[:])
    if not variable.integer:
        return np.ascontiguousarray(values, dtype=np.float64)
    if not np.all(np.isfinite(values)) or np.any(np.abs(values.astype(np.float64)) > np.iinfo(np.int32).max - 1):
        raise MeshError(f"{variable.file_name} holds values that are no 32-bit integers")
    return np.ascontiguousarray(values, dtype=np.int32) - (1 if variable.is_index else 0)


def _fill_beyond(ring: NDArray, counts: Index, fill: float) -> NDArray:
    """The array with everything beyond the count of each row set to `fill`, whatever the file has there."""
    beyond = np.arange(ring.shape[1]) >= counts[:, None]
    return np.where(beyond, ring.dtype.type(fill), ring)

"""How a mesh was generated, as recorded in its file: for which density, and with which generators held fixed.

A named density is told by its name. One from a file is told by that file, what was done to its field, and a digest of
the values, so that it is found again where the file is still there and the same. A function cannot be told.
"""

import json
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.conventions import MeshOutline
from mesh.density.gridded import FileDensity, Shaping, read_density
from mesh.density.named import NAMED, Density, uniform
from mesh.density.planar import CIRCLE, RefinedDisc, named_on_plane
from mesh.density.planar_grid import read_density_on_plane
from mesh.density.scattered import density_from_cells
from mesh.errors import MeshError
from mesh.geometry.sphere import normalize
from mesh.voronoi_mesh import VoronoiMesh

FIXED_VARIABLE = "fixedCell"
FUNCTION = "function "
"""With this begin the names of densities that are functions of a user."""


def name_of(density: Density) -> str:
    """The name of a density in a mesh: that of a named one, of a file, or of a function."""
    if isinstance(density, FileDensity):
        return str(density.path)
    if isinstance(density, RefinedDisc):
        return CIRCLE
    for name, known in NAMED.items():
        if type(density) is type(known) and density == known:
            return name
    return FUNCTION + str(getattr(density, "__name__", type(density).__name__))


def source_of(density: Density) -> str:
    """The source of a density from a file, as JSON; empty for others."""
    if not isinstance(density, FileDensity):
        return ""
    source = {
        "path": str(density.path.resolve()),
        "variable": density.variable,
        "floor": float(density.shaping.floor),
        "power": float(density.shaping.power),
        "smoothing": int(density.shaping.smoothing),
        "sha256": density.digest,
    }
    return json.dumps(source)


def density_of(mesh: VoronoiMesh) -> tuple[Density | None, str]:
    """The density that a mesh was generated for, None if that is unknown, and a note that says why.

    A mesh of which nothing is told has the density at its centres, interpolated between them.
    """
    name = mesh.density_name
    if not mesh.on_a_sphere:
        return _density_on_plane(mesh)
    if name in NAMED:
        return NAMED[name], ""
    if mesh.density_source:
        return _from_source(mesh.density_source, name, read_density)
    if name:
        what = f"the {name}" if name.startswith(FUNCTION) else f"'{name}', of which the mesh holds only the name"
        return None, f"unknown, since the density was {what}"
    if np.ptp(mesh.mesh_density) == 0.0:
        return uniform, ""
    if not (np.isfinite(mesh.mesh_density).all() and mesh.mesh_density.min() > 0.0):
        return None, "unknown, since the density at the centres is not positive and finite everywhere"
    if mesh.boundary_vertex.any():
        return None, "unknown, since a mesh with walls does not hold the density between all of its cells"
    between = density_from_cells(normalize(mesh.cell_points), mesh.mesh_density, mesh.cells_on_vertex)
    return between, "for the density interpolated between the cells"


def _density_on_plane(mesh: VoronoiMesh) -> tuple[Density | None, str]:
    """The same on a plane, whose lengths are its periods, or reach from wall to wall."""
    if not mesh.density_name and np.ptp(mesh.mesh_density) == 0.0:
        return uniform, ""
    if mesh.density_source:
        return _from_source(mesh.density_source, mesh.density_name, read_density_on_plane)
    periods, farthest = np.array([mesh.x_period, mesh.y_period]), mesh.vertex_points[:, :2].max(axis=0)
    density = named_on_plane(mesh.density_name, np.where(periods > 0.0, periods, farthest))
    return density, "" if density is not None else "unknown, since the density on a plane is known by its name alone"


def _from_source(source: str, name: str, read: Callable[..., FileDensity]) -> tuple[Density | None, str]:
    """The density that `source_of` describes, looked for under its `name` in this folder, then where it was."""
    try:
        told = json.loads(source)
        shaping = Shaping(told["floor"], told["power"], told["smoothing"])
        paths, variable, digest = (Path(name), Path(told["path"])), str(told["variable"]), told["sha256"]
    except (ValueError, TypeError, LookupError):
        return None, "unknown, since the attribute density_source of the mesh is damaged"
    for path in paths:
        try:
            density = read(path, variable, shaping)
        except MeshError:
            continue
        if density.digest == digest:
            return density, ""
    return None, f"unknown, since the density was {variable} of {name}, which is missing or has changed since"


def define_generation(file: netCDF4.Dataset, mesh: MeshOutline) -> None:
    """Define in an open mesh file the source of a density from a file, and which generators were held fixed."""
    if mesh.density_source:
        file.density_source = mesh.density_source
    if mesh.fixed_cells is not None:
        fixed = file.createVariable(FIXED_VARIABLE, "i4", ("nCells",))
        fixed.setncatts({"units": "1", "long_name": "1 where the generator was held while others moved, 0 elsewhere"})


def fill_generation(file: netCDF4.Dataset, mesh: MeshOutline) -> None:
    """Write what `define_generation` has defined."""
    if mesh.fixed_cells is not None:
        file[FIXED_VARIABLE][:] = mesh.fixed_cells


def read_generation(file: netCDF4.Dataset, n_cells: int) -> tuple[str, str, NDArray[np.bool_] | None]:
    """`density_name`, `density_source` and `fixed_cells` of the mesh in an open file."""
    name, source = (str(getattr(file, attribute, "")) for attribute in ("density_name", "density_source"))
    fixed = file.variables.get(FIXED_VARIABLE)
    if fixed is None or fixed.shape != (n_cells,) or fixed.dtype is str or fixed.dtype.kind not in "iuf":
        return name, source, None
    return name, source, np.asarray(fixed[:]) != 0

"""Densities on planes from a field in a NetCDF file, on a grid of x and y in metres."""

import hashlib
from pathlib import Path

import netCDF4
import numpy as np
from scipy.interpolate import RegularGridInterpolator

from mesh.arrays import Array
from mesh.density.field_coordinates import read_numbers
from mesh.density.gridded import FileDensity, Shaping, read_with, require_usable
from mesh.density.named import Density
from mesh.errors import MeshError

METRES = ("m", "metre", "metres", "meter", "meters")
"""Units that places on a plane may have."""


def read_density_on_plane(path: str | Path, variable: str, shaping: Shaping) -> FileDensity:
    """The density that `variable` of a file holds on a grid, bilinear between its values.

    It has two dimensions, y and x or x and y, each with a variable of its name that holds the places, metres. Beyond
    the edges of the grid the nearest value holds. Raises `MeshError` where the file or the variable cannot be used.
    """
    path = Path(path)
    x, y, values = read_with(_read_grid, path, variable)
    require_usable(values, shaping, f"{path}: {variable}")
    digest = hashlib.sha256()
    for array in (values, y, x):
        digest.update(np.ascontiguousarray(array).tobytes())
    return FileDensity(_between(x, y, shaping.apply(values, _smooth)), path, variable, shaping, digest.hexdigest())


def _read_grid(file: netCDF4.Dataset, field: netCDF4.Variable, path: Path) -> tuple[Array, Array, Array]:
    """Ascending x (m,) and y (n,), and the values (n, m)."""
    if sorted(field.dimensions) != ["x", "y"] or not {"x", "y"} <= set(file.variables):
        raise MeshError(
            f"{path}: {field.name} has dimensions {field.dimensions}; a density on a plane has x and y, with variables "
            "of these names that hold the places in metres"
        )
    values = read_numbers(field, path)
    if field.dimensions == ("x", "y"):
        values = values.T
    axes = {}
    for axis, name in enumerate(("y", "x")):
        unit = getattr(file[name], "units", "m")
        if unit not in METRES:
            raise MeshError(
                f"{path}: {name} has the unit '{unit}'; give the places on a plane in metres, with the unit m"
            )
        places = read_numbers(file[name], path)
        if places.ndim != 1 or len(places) < 2 or len(np.unique(places)) < len(places):
            raise MeshError(f"{path}: {name} must hold at least two places, all different, in one dimension")
        order = np.argsort(places)
        axes[name], values = places[order], values.take(order, axis)
    return axes["x"], axes["y"], values


def _between(x: Array, y: Array, values: Array) -> Density:
    interpolated = RegularGridInterpolator((y, x), values)

    def density(points: Array) -> Array:
        inside = np.column_stack([np.clip(points[:, 1], y[0], y[-1]), np.clip(points[:, 0], x[0], x[-1])])
        found: Array = interpolated(inside)
        return found

    return density


def _smooth(values: Array) -> Array:
    """Half of each value, and half of the mean of its four neighbours; beyond an edge it stands for them itself."""
    padded = np.pad(values, 1, mode="edge")
    return 0.5 * values + 0.125 * (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:])

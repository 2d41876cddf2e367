"""Densities by name, and from a field in a NetCDF file on a latitude-longitude grid or on a mesh."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import netCDF4
import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density import NAMED, Density
from mesh.errors import MeshError
from mesh.files import dataset
from mesh.sphere import normalize, to_lonlat

DENSITY_VARIABLE = "density"
LATITUDE_NAMES = ("lat", "latitude")
LONGITUDE_NAMES = ("lon", "longitude")
INTERPOLATION_NEIGHBOURS = 3
SMOOTHING_NEIGHBOURS = 6
MOST_PASSES = 10_000


@dataclass(frozen=True)
class Shaping:
    """What is done to a field before it serves as density.

    Values below `floor` are raised to it, then all are smoothed by `smoothing` passes of a mean with the neighbours
    and raised to `power` (-4 for a field of cell widths).
    """

    floor: float = 0.0
    power: float = 1.0
    smoothing: int = 0

    def __post_init__(self) -> None:
        if not (0.0 <= self.floor < np.inf and np.isfinite(self.power) and 0 <= self.smoothing <= MOST_PASSES):
            raise MeshError(
                f"a density cannot have the floor {self.floor:g}, the power {self.power:g} and {self.smoothing} passes "
                f"of smoothing; give finite numbers, none of them negative but the power, and {MOST_PASSES} passes at "
                "most"
            )

    def apply(self, values: Array, smooth: Callable[[Array], Array]) -> Array:
        """The shaped values, with `smooth` for one pass."""
        shaped = np.maximum(values, self.floor)
        for _ in range(self.smoothing):
            shaped = smooth(shaped)
        with np.errstate(divide="ignore"):
            return shaped**self.power


def find_density(name: str, variable: str = DENSITY_VARIABLE, shaping: Shaping | None = None) -> Density:
    """Return the density of this name, or the one that the NetCDF file of this name holds (see `read_density`).

    Raises `MeshError` where there is neither, or where a named density would have to be shaped.
    """
    if name.endswith(".nc"):
        return read_density(name, variable, shaping)
    if name not in NAMED:
        raise MeshError(
            f"there is no density named '{name}'; choose one of {', '.join(NAMED)}, or a NetCDF file by its name in .nc"
        )
    if shaping not in (None, Shaping()) or variable != DENSITY_VARIABLE:
        raise MeshError(
            f"the density {name} cannot be shaped; variable, floor, power and smoothing are for fields from files"
        )
    return NAMED[name]


def read_density(path: str | Path, variable: str = DENSITY_VARIABLE, shaping: Shaping | None = None) -> Density:
    """Return the density that `variable` of a file holds, interpolated between its values.

    On a grid, the variable has dimensions latitude and longitude with coordinates `lat` and `lon` in degrees; on a
    mesh, the dimension `nCells`, with `xCell`, `yCell`, `zCell` in the file. Raises `MeshError` where the file or
    the variable cannot be used.
    """
    shaping = Shaping() if shaping is None else shaping
    if not Path(path).is_file():
        raise MeshError(f"{path}: there is no such file; give a NetCDF file with a density")
    try:
        with dataset(path) as file:
            if variable not in file.variables:
                raise MeshError(f"{path}: there is no variable named {variable}; name the field {DENSITY_VARIABLE}")
            field = file[variable]
            if field.dimensions == ("nCells",):
                return _density_on_mesh(file, _values(field, shaping, path), shaping, path)
            return _density_on_grid(file, field, shaping, path)
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        if isinstance(error, MeshError):
            raise
        raise MeshError(f"{path}: holds no density that can be used ({error}); give a NetCDF file with one") from error


def _values(field: netCDF4.Variable, shaping: Shaping, path: str | Path) -> Array:
    """Values of a field, none of them missing, and none negative where no floor has been asked for."""
    values = np.ma.filled(np.ma.asarray(field[:]).astype(float), np.nan)
    wrong = np.count_nonzero(~np.isfinite(values))
    if wrong:
        raise MeshError(f"{path}: {wrong} values of {field.name} are missing or not finite; fill them first")
    if values.min() < 0.0 and shaping.floor == 0.0:
        raise MeshError(f"{path}: {field.name} falls to {values.min():g}; a density is not negative, give it a floor")
    return values


def _density_on_grid(file: netCDF4.Dataset, field: netCDF4.Variable, shaping: Shaping, path: str | Path) -> Density:
    """Bilinear interpolation in latitude and longitude, periodic in longitude, constant beyond the last rows."""
    names = [name for choices in (LATITUDE_NAMES, LONGITUDE_NAMES) for name in choices if name in file.variables]
    if len(names) != 2 or len(field.dimensions) != 2:
        raise MeshError(
            f"{path}: {field.name} has dimensions {field.dimensions}; it must live on (lat, lon) with coordinates lat "
            "and lon in degrees, or on nCells"
        )
    latitude, longitude = (np.radians(np.asarray(file[name][:]).astype(float)) for name in names)
    if not (np.isfinite(latitude).all() and np.isfinite(longitude).all()):
        raise MeshError(f"{path}: {' or '.join(names)} is not finite everywhere; mend the coordinates")
    values = _values(field, shaping, path)
    if values.shape != (len(latitude), len(longitude)):
        raise MeshError(f"{path}: {field.name} has shape {values.shape} instead of (lat, lon)")
    if field.dimensions != tuple(file[name].dimensions[0] for name in names):
        raise MeshError(f"{path}: {field.name} has dimensions {field.dimensions}; order them as (lat, lon)")
    # Both ends of a full circle are one meridian.
    latitude, rows = np.unique(latitude, return_index=True)
    if len(latitude) < 2:
        raise MeshError(f"{path}: {field.name} has one latitude; a grid needs two at least")
    longitude, columns = np.unique(np.round(longitude % (2.0 * np.pi), 12) % (2.0 * np.pi), return_index=True)
    values = shaping.apply(values[np.ix_(rows, columns)], _smooth_grid)
    # One column more on each side makes the grid periodic.
    longitude = np.concatenate([longitude[-1:] - 2.0 * np.pi, longitude, longitude[:1] + 2.0 * np.pi])
    values = np.concatenate([values[:, -1:], values, values[:, :1]], axis=1)
    interpolate = RegularGridInterpolator((latitude, longitude), values)

    def density(points: Array) -> Array:
        east, north = to_lonlat(points)
        return interpolate(np.stack([np.clip(north, latitude[0], latitude[-1]), east], axis=-1))

    return density


def _smooth_grid(values: Array) -> Array:
    """Mean of each value, twice weighted, with those to its east, west, north and south."""
    padded = np.pad(values, ((1, 1), (0, 0)), mode="edge")
    around = padded[:-2] + padded[2:] + np.roll(values, 1, axis=1) + np.roll(values, -1, axis=1)
    return 0.5 * values + 0.125 * around


def _density_on_mesh(file: netCDF4.Dataset, values: Array, shaping: Shaping, path: str | Path) -> Density:
    if not all(name in file.variables for name in ("xCell", "yCell", "zCell")):
        raise MeshError(f"{path}: a density on nCells needs xCell, yCell and zCell in the same file")
    centers = normalize(np.stack([np.asarray(file[f"{axis}Cell"][:]).astype(float) for axis in "xyz"], axis=1))
    if len(centers) <= SMOOTHING_NEIGHBOURS or not np.isfinite(centers).all():
        raise MeshError(f"{path}: xCell, yCell and zCell must be finite, and of more than {SMOOTHING_NEIGHBOURS} cells")
    neighbours = cKDTree(centers).query(centers, k=SMOOTHING_NEIGHBOURS + 1)[1][:, 1:]
    shaped = shaping.apply(values, lambda field: 0.5 * field + 0.5 * field[neighbours].mean(axis=1))
    return density_from_cells(centers, shaped)


def density_from_cells(centers: Array, values: Array) -> Density:
    """Interpolate `values` (n,) at unit vectors `centers` (n, 3): the nearest three, weighted by inverse distance."""
    tree = cKDTree(centers)

    def density(points: Array) -> Array:
        distance, cell = tree.query(points, k=INTERPOLATION_NEIGHBOURS)
        weight = 1.0 / np.maximum(distance, np.finfo(float).tiny)
        return (weight * values[cell]).sum(axis=1) / weight.sum(axis=1)

    return density

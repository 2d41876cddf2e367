"""Densities by name, and from a field in a NetCDF file on a latitude-longitude grid, on a mesh or at any points."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import netCDF4
import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.density.field_coordinates import named_variable, read_coordinates, read_numbers
from mesh.density.grid_interpolation import density_on_grid
from mesh.density.named import NAMED, Density
from mesh.density.scaling import SAFE_EXPONENT
from mesh.density.scattered import density_from_points
from mesh.errors import MeshError
from mesh.geometry.sphere import from_lonlat, normalize
from mesh.mesh_request import MeshRequest
from mesh.safe_files import dataset

Read = TypeVar("Read")

DENSITY_VARIABLE = MeshRequest.density_variable
SMOOTHING_NEIGHBOURS = 6
MOST_PASSES = 10_000


@dataclass(frozen=True)
class Shaping:
    """How a field is turned into a density.

    Values below `floor` are raised to it, then all are smoothed by `smoothing` passes of a mean with the neighbours
    and raised to `power` (-4 for a field of cell widths).
    """

    floor: float = MeshRequest.density_floor
    power: float = MeshRequest.density_power
    smoothing: int = MeshRequest.density_smoothing

    def __post_init__(self) -> None:
        if not (0.0 <= self.floor < np.inf and np.isfinite(self.power) and 0 <= self.smoothing <= MOST_PASSES):
            raise MeshError(
                f"a density cannot have the floor {self.floor:g}, the power {self.power:g} and {self.smoothing} passes "
                f"of smoothing; give finite numbers, none of them negative but the power, and {MOST_PASSES} passes at "
                "most"
            )

    def apply(self, values: Array, smooth: Callable[[Array], Array]) -> Array:
        """The shaped values, with `smooth` for one pass; a multiple of them where they would leave the range.

        Raises `MeshError` where a power is not finite.
        """
        shaped = np.maximum(values, self.floor)
        exponent = math.frexp(shaped.max())[1]
        if abs(exponent) * max(1.0, abs(self.power)) > SAFE_EXPONENT:
            shaped = np.ldexp(shaped, -exponent)
        for _ in range(self.smoothing):
            shaped = smooth(shaped)
        with np.errstate(divide="ignore", over="ignore"):
            powers = shaped**self.power
        if not np.isfinite(powers).all():
            raise MeshError(
                f"the field goes from {shaped.min():g} to {shaped.max():g} and has no finite power {self.power:g}; "
                "give it a floor"
            )
        return powers


@dataclass(frozen=True)
class FileDensity:
    """A density from a file, and where it came from; `digest` is that of values and coordinates as read."""

    function: Density
    path: Path
    variable: str
    shaping: Shaping
    digest: str

    def __call__(self, points: Array) -> Array:
        """Values (m,) at unit vectors (m, 3)."""
        return self.function(points)


@dataclass(frozen=True)
class _Field:
    """Values of a field and their positions.

    On a grid, values (rows, columns) at latitudes (rows,) and longitudes (columns,), radians; else values (n,) at unit
    vectors `points` (n, 3).
    """

    values: Array
    latitude: Array
    longitude: Array
    points: Array | None = None

    @property
    def digest(self) -> str:
        """SHA-256, in hexadecimal, of values and positions."""
        digest = hashlib.sha256()
        for array in (self.values, self.latitude, self.longitude, self.points):
            if array is not None:
                digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()


def find_density(name: str, variable: str = DENSITY_VARIABLE, shaping: Shaping | None = None) -> Density:
    """Return the density of this name, or the one that the NetCDF file of this name holds (see `read_density`).

    Raises `MeshError` where there is neither, or where a named density would have to be shaped.
    """
    if name.endswith(".nc") or (name not in NAMED and Path(name).is_file()):
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


def read_density(path: str | Path, variable: str = DENSITY_VARIABLE, shaping: Shaping | None = None) -> FileDensity:
    """Return the density that `variable` of a file holds, interpolated between its values.

    The variable has two dimensions of latitude and longitude, or one of points, such as `nCells`; others must have
    length one. The coordinates are found as `mesh.density.field_coordinates` says, or are `xCell`, `yCell` and `zCell`.
    Raises `MeshError` where the file or the variable cannot be used.
    """
    shaping = Shaping() if shaping is None else shaping
    path = Path(path)
    field = read_with(_read_field, path, variable)
    name = f"{path}: {variable}"
    require_usable(field.values, shaping, name)
    return FileDensity(_interpolated(field, shaping, name), path, variable, shaping, field.digest)


def read_with(read: Callable[[netCDF4.Dataset, netCDF4.Variable, Path], Read], path: Path, variable: str) -> Read:
    """What `read` makes of the open file of a density, and of its variable of this name.

    Raises `MeshError` where the file or the variable cannot be used.
    """
    if not path.is_file():
        raise MeshError(f"{path}: there is no such file; give a NetCDF file with a density")
    try:
        with dataset(path) as file:
            return read(file, named_variable(file, variable, path), path)
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        if isinstance(error, MeshError):
            raise
        raise MeshError(f"{path}: holds no density that can be used ({error}); give a NetCDF file with one") from error


def require_usable(values: Array, shaping: Shaping, name: str) -> None:
    """Raise `MeshError` where a field of this name is negative, or zero everywhere, and no floor mends that."""
    if values.min() < 0.0 and shaping.floor == 0.0:
        raise MeshError(f"{name} falls to {values.min():g}; a density is not negative, give it a floor")
    if values.max() <= 0.0 and shaping.floor == 0.0:
        raise MeshError(f"{name} is zero everywhere; a density is positive somewhere")


def _read_field(file: netCDF4.Dataset, variable: netCDF4.Variable, path: Path) -> _Field:
    """The field with its coordinates; those of a grid may be written out in two dimensions each."""
    axes = [file[name] for name in ("xCell", "yCell", "zCell") if name in file.variables]
    if len(axes) == 3 and all(axis.dimensions == ("nCells",) for axis in axes) and "nCells" in variable.dimensions:
        points = np.stack([read_numbers(axis, path) for axis in axes], axis=1)
        if not np.linalg.norm(points, axis=1).all():
            raise MeshError(f"{path}: xCell, yCell and zCell are all zero at a cell; correct the coordinates")
        return _scattered(_values_along(variable, ("nCells",), path), normalize(points), path)
    latitude, longitude = read_coordinates(file, variable, path)
    north, east = latitude.values, longitude.values
    rows, columns = latitude.dimensions, longitude.dimensions
    if len(rows) == len(columns) == 1 and rows != columns:
        return _Field(_values_along(variable, (*rows, *columns), path), north, east)
    if set(rows) != set(columns) or len(rows) > 2:
        raise MeshError(
            f"{path}: {latitude.name} has dimensions {rows} and {longitude.name} has {columns}; both must have one "
            "dimension each, or the same"
        )
    values = _values_along(variable, rows, path)
    if rows != columns:
        east = east.T
    if len(rows) == 2:
        for turned in (False, True):
            a, b, c = (array.T if turned else array for array in (values, north, east))
            if (b == b[:, :1]).all() and (c == c[:1]).all():
                return _Field(a, b[:, 0], c[0])
    return _scattered(values.ravel(), from_lonlat(east.ravel(), north.ravel()), path)


def _scattered(values: Array, points: Array, path: Path) -> _Field:
    if len(values) <= SMOOTHING_NEIGHBOURS:
        raise MeshError(
            f"{path}: a density on {len(values)} points is too coarse; give more than {SMOOTHING_NEIGHBOURS}"
        )
    return _Field(values, np.empty(0), np.empty(0), points)


def _values_along(variable: netCDF4.Variable, dimensions: tuple[str, ...], path: Path) -> Array:
    """Values of a field with the given dimensions in their order, the others, of length one, left out."""
    others = [
        (name, size) for name, size in zip(variable.dimensions, variable.shape, strict=True) if name not in dimensions
    ]
    for name, size in others:
        if size != 1:
            raise MeshError(
                f"{path}: {variable.name} has {size} entries along {name}; write the one that is wanted to a file of "
                "its own"
            )
    kept = [name for name in variable.dimensions if name in dimensions]
    values = read_numbers(variable, path).reshape([len(variable.group().dimensions[name]) for name in kept])
    return values.transpose([kept.index(name) for name in dimensions])


def _interpolated(field: _Field, shaping: Shaping, name: str) -> Density:
    """The shaped field between its values."""
    if field.points is None:
        return density_on_grid(field.latitude, field.longitude, field.values, shaping.apply, name)
    neighbours = cKDTree(field.points).query(field.points, k=SMOOTHING_NEIGHBOURS + 1)[1][:, 1:]
    shaped = shaping.apply(field.values, lambda values: 0.5 * values + 0.5 * values[neighbours].mean(axis=1))
    return density_from_points(field.points, shaped, name)

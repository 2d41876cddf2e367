"""Regions from NetCDF files: a mask, or a signed distance to the coast, on a grid of longitude and latitude."""

from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.density.field_coordinates import named_variable, read_coordinates, read_numbers
from mesh.errors import MeshError
from mesh.geometry.angles import degrees_eastward
from mesh.geometry.sphere import to_lonlat
from mesh.regions.outline import joined, signed, straight_on_the_map
from mesh.regions.region import Region
from mesh.safe_files import dataset

LAND_MASKS = ("land_binary_mask", "land_area_fraction")
"""CF standard names of fields that are one on land; all other masks are one at sea."""

TURN, POLE = 360.0, 90.0

WIDEST_GAP = 1.5
"""In the widest spacing: a grid goes round, or reaches a pole, where it leaves no gap wider than that."""

BORDER = 1e-6
"""Degrees beyond the edge of a grid of a part of the globe at which all is land."""


def read_gridded(path: Path, name: str) -> Region:
    """The region where the variable `name` of a file is one, if it holds from 0 to 1, or else positive.

    Between the values it is interpolated linearly, and the coast runs where it is half, or zero. Beyond the grid all is
    land. Raises `MeshError` where the file or the variable cannot be used.
    """
    if not path.is_file():
        raise MeshError(f"{path}: there is no such file; give a NetCDF file with a mask or a signed distance")
    try:
        with dataset(path) as file:
            longitude, latitude, values = _read(file, named_variable(file, name, path), path)
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        if isinstance(error, MeshError):
            raise
        raise MeshError(f"{path}: {name} cannot be read ({error}); give a mask on a grid") from error
    longitude, latitude, values = _with_border(longitude, latitude, values)
    field = _interpolation(longitude, latitude, values)
    return Region(f"{path}:{name}", _signed_distance(longitude, latitude, values, field), lambda p: field(p) > 0.0)


def _read(file: netCDF4.Dataset, variable: netCDF4.Variable, path: Path) -> tuple[Array, Array, Array]:
    """Longitudes (m,) and latitudes (n,) in degrees, ascending, and values (n, m), positive in the region."""
    latitude, longitude = read_coordinates(file, variable, path)
    grid = (*latitude.dimensions, *longitude.dimensions)
    kept = [name for name, size in zip(variable.dimensions, variable.shape, strict=True) if size > 1 or name in grid]
    if len(grid) != 2 or sorted(kept) != sorted(grid):
        raise MeshError(
            f"{path}: {variable.name} has the dimensions {variable.dimensions}; give it one of latitude and one of "
            "longitude"
        )
    values = read_numbers(variable, path).reshape([len(file.dimensions[name]) for name in kept])
    values = _positive_within(values if tuple(kept) == grid else values.T, variable)
    north, row = np.unique(np.degrees(latitude.values), return_index=True)
    # Both ends of a full circle are one meridian.
    east, column = np.unique(
        degrees_eastward(np.round(np.degrees(longitude.values), 9).astype(np.float64)), return_index=True
    )
    if min(len(north), len(east)) < 2:
        raise MeshError(
            f"{path}: {variable.name} has {len(north)} latitudes and {len(east)} longitudes; give two or more"
        )
    return east, north, values[np.ix_(row, column)]


def _positive_within(values: Array, variable: netCDF4.Variable) -> Array:
    """The values, less a half where they are those of a mask, and turned round where that is one on land."""
    if values.min() >= 0.0 and values.max() <= 1.0:
        values = values - 0.5
    return -values if getattr(variable, "standard_name", "") in LAND_MASKS else values


def _with_border(longitude: Array, latitude: Array, values: Array) -> tuple[Array, Array, Array]:
    """The grid with a column that closes the circle, and rows at the poles, or else a border of land."""
    land = -np.abs(values).max()
    gaps = np.diff(longitude, append=longitude[0] + TURN)
    widest = int(gaps.argmax())
    first = (widest + 1) % len(gaps)  # the columns begin after the gap
    longitude = np.concatenate([longitude[first:], longitude[:first] + TURN])
    values = np.roll(values, -first, axis=1)
    if gaps[widest] <= WIDEST_GAP * np.delete(gaps, widest).max():
        longitude, values = np.append(longitude, longitude[0] + TURN), np.hstack([values, values[:, :1]])
    else:
        longitude = np.concatenate([[longitude[0] - BORDER], longitude, [longitude[-1] + BORDER]])
        values = np.pad(values, ((0, 0), (1, 1)), constant_values=land)
    gap = WIDEST_GAP * np.diff(latitude).max()
    ends = [_end(latitude[end], pole, values[end], gap, land) for end, pole in ((0, -POLE), (-1, POLE))]
    (south, below), (north, above) = ends
    return longitude, np.concatenate([south, latitude, north]), np.concatenate([below, values, above])


def _end(latitude: float, pole: float, row: Array, gap: float, land: float) -> tuple[Array, Array]:
    """The latitude, and the row of values, to be added beyond the last row (m,), at a pole that is near; or none."""
    if latitude == pole:
        return np.empty(0), np.empty((0, len(row)))
    if abs(pole - latitude) <= gap:
        return np.array([pole]), np.full((1, len(row)), row.mean())
    return np.array([latitude + np.sign(pole) * BORDER]), np.full((1, len(row)), land)


def _interpolation(longitude: Array, latitude: Array, values: Array) -> Callable[[Array], Array]:
    """Values (n,) between those of a grid at unit vectors (n, 3), those of land beyond it."""
    from scipy.interpolate import RegularGridInterpolator

    land = -np.abs(values).max()
    interpolate = RegularGridInterpolator((latitude, longitude), values, bounds_error=False, fill_value=land)

    def field(points: Array) -> Array:
        east, north = (np.degrees(angle) for angle in to_lonlat(points))
        return interpolate(np.stack([north, longitude[0] + degrees_eastward(east - longitude[0])], axis=1))

    return field


def _signed_distance(
    longitude: Array, latitude: Array, values: Array, field: Callable[[Array], Array]
) -> Callable[[Array], Array]:
    """The distance to the line where the values are zero, positive where the field is."""
    # Loading it takes a tenth of a second, and only regions from such files need it.
    from contourpy import contour_generator

    lines = contour_generator(x=longitude, y=latitude, z=values).lines(0.0)
    outline = joined([straight_on_the_map(*np.radians(np.asarray(line)).T) for line in lines])

    def distance(points: Array) -> Array:
        inside: NDArray[np.bool_] = field(points) > 0.0
        return signed(outline.distance(points), inside)

    return distance

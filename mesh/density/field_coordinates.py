"""Latitude and longitude of a field in a NetCDF file, under any common name and in any common unit.

They are found by the attributes of the CF conventions (`coordinates`, `standard_name`, `units`, `axis`) and, where a
file has none, by the names in common use. What has to be assumed is said in a `MeshWarning`.
"""

import re
import warnings
from pathlib import Path
from typing import NamedTuple

import netCDF4
import numpy as np

from mesh.arrays import Array
from mesh.errors import MeshError, MeshWarning
from mesh.geometry.angles import TURN

DEGREES = re.compile(r"(?:deg|degrees?|°)[_ ]?(north|n|east|e|true|t)?")
RADIANS = re.compile(r"rad|radians?")
DIRECTIONS = {"north": "latitude", "n": "latitude", "east": "longitude", "e": "longitude"}
NAMES = {
    "latitude": re.compile(r"(.*_|geo)?(co-?)?lat(itude)?s?(_.*|cell|\d)?|[a-z]lat|gphi[a-z]"),
    "longitude": re.compile(r"(.*_|geo)?lon(g|gitude)?s?(_.*|cell|\d)?|[a-z]long?|glam[a-z]"),
}
AXES = {"latitude": ("y", "yc"), "longitude": ("x", "xc")}
"""Values of the attribute `axis`, and names, that mean an angle where the unit is one."""

COLATITUDE = re.compile(r"co-?lat", re.IGNORECASE)

ANGLE_ROUNDING = 1e-5
"""By so much, in radians, coordinates in single precision may miss the poles."""

QUARTER = 0.5 * np.pi
LARGEST_LONGITUDE = 4.0 * np.pi


def named_variable(file: netCDF4.Dataset, name: str, path: Path) -> netCDF4.Variable:
    """The variable of this name in an open file; raises `MeshError` where there is none."""
    if name not in file.variables:
        raise MeshError(
            f"{path}: there is no variable named {name}; name one of those that it has, which are "
            f"{', '.join(file.variables)}"
        )
    return file[name]


class Coordinate(NamedTuple):
    """Values, in radians, with the name of their variable and its dimensions."""

    values: Array
    name: str
    dimensions: tuple[str, ...]


def read_coordinates(file: netCDF4.Dataset, field: netCDF4.Variable, path: str | Path) -> tuple[Coordinate, Coordinate]:
    """The latitude, in [-pi/2, pi/2], and the longitude of a field, in one dimension or two.

    Raises `MeshError` where they are not found, or are not latitudes and longitudes.
    """
    found = [_find(file, field, kind) for kind in ("latitude", "longitude")]
    latitude, longitude = found
    if latitude is None or longitude is None:
        missing = " and ".join(kind for kind, variable in zip(NAMES, found, strict=True) if variable is None)
        raise MeshError(
            f"{path}: {field.name} has dimensions {field.dimensions}, and no {missing} is found along them; "
            "give the coordinates the attributes standard_name (latitude, longitude) and units (degrees, radians), "
            "or give xCell, yCell and zCell on nCells"
        )
    north, east = read_numbers(latitude, path), read_numbers(longitude, path)
    colatitude = _is_colatitude(latitude)
    north, east = _in_radians((latitude, longitude), (north, east), path)
    if colatitude:
        _tell(f"{path}: {latitude.name} is taken to be co-latitude, counted from the north pole")
        north = QUARTER - north
    if not np.abs(north).max() <= QUARTER + ANGLE_ROUNDING:
        raise MeshError(
            f"{path}: {latitude.name} goes from {_degrees(north.min())} to {_degrees(north.max())} degrees, which "
            "are not latitudes; correct its values or its units, or name it colatitude if it counts from the north pole"
        )
    if not np.abs(east).max() <= LARGEST_LONGITUDE:
        raise MeshError(
            f"{path}: {longitude.name} goes from {_degrees(east.min())} to {_degrees(east.max())} degrees, which "
            "are not longitudes; correct its values or its units"
        )
    return _coordinate(latitude, np.clip(north, -QUARTER, QUARTER)), _coordinate(longitude, east)


def _coordinate(variable: netCDF4.Variable, values: Array) -> Coordinate:
    """A coordinate without extra dimensions of length one, such as time."""
    if values.ndim <= 2:
        return Coordinate(values, variable.name, variable.dimensions)
    kept = tuple(name for name, size in zip(variable.dimensions, values.shape, strict=True) if size > 1)
    return Coordinate(values.squeeze(), variable.name, kept)


def read_numbers(variable: netCDF4.Variable, path: str | Path) -> Array:
    """Values of a variable, unpacked; raise `MeshError` where one is missing or is not a finite number."""
    if variable.dtype is str or variable.dtype.kind not in "iuf":
        raise MeshError(f"{path}: {variable.name} holds {variable.dtype} instead of numbers")
    values = np.ma.filled(np.ma.asarray(variable[:]).astype(float), np.nan)
    wrong = np.argwhere(~np.isfinite(values))
    if not values.size:
        raise MeshError(f"{path}: {variable.name} holds no values; fill it")
    if len(wrong):
        place = ", ".join(f"{name}={row}" for name, row in zip(variable.dimensions, wrong[0], strict=True))
        raise MeshError(
            f"{path}: {len(wrong)} of {values.size} values of {variable.name} are missing or not finite, the first at "
            f"{place}, counted from 0; fill them, those on land too"
        )
    return values


def _find(file: netCDF4.Dataset, field: netCDF4.Variable, kind: str) -> netCDF4.Variable | None:
    """The variable along dimensions of the field that is most likely its latitude or longitude."""
    listed = str(getattr(field, "coordinates", "")).split()
    ranked = [
        (variable.name not in listed, rank, order, variable)
        for order, variable in enumerate(file.variables.values())
        if variable.dimensions and set(variable.dimensions) <= set(field.dimensions) and variable.name != field.name
        for rank in [_doubt(variable, kind)]
        if rank is not None
    ]
    return min(ranked, key=lambda entry: entry[:3])[3] if ranked else None


def _doubt(variable: netCDF4.Variable, kind: str) -> int | None:
    """How doubtful it is that a variable is a latitude or longitude: 0 is certain; None if it is neither."""
    standard_name = str(getattr(variable, "standard_name", "")).strip().lower()
    if standard_name:
        return 0 if standard_name in (kind, f"co{kind}") else None
    unit, name = _unit(variable), variable.name.lower()
    degrees = DEGREES.fullmatch(unit)
    if unit and not degrees and not RADIANS.fullmatch(unit):
        return None
    if degrees and degrees[1] in DIRECTIONS:
        return 1 if DIRECTIONS[degrees[1]] == kind else None
    if NAMES[kind].fullmatch(name):
        return 2
    return 3 if unit and (name in AXES[kind] or str(getattr(variable, "axis", "")).lower() in AXES[kind]) else None


def _unit(variable: netCDF4.Variable) -> str:
    """The unit in small letters, empty where there is none."""
    unit = str(getattr(variable, "units", "")).strip().lower()
    return "" if unit == "1" else unit


def _is_colatitude(variable: netCDF4.Variable) -> bool:
    words = (variable.name, getattr(variable, "standard_name", ""), getattr(variable, "long_name", ""))
    return any(COLATITUDE.search(str(word)) for word in words)


def _in_radians(
    variables: tuple[netCDF4.Variable, netCDF4.Variable], values: tuple[Array, Array], path: str | Path
) -> list[Array]:
    """Latitudes and longitudes in radians; where no unit is given, one is assumed from the other or from the values.

    Raises `MeshError` for other units.
    """
    for variable in variables:
        if (unit := _unit(variable)) and not (DEGREES.fullmatch(unit) or RADIANS.fullmatch(unit)):
            raise MeshError(f"{path}: {variable.name} has the unit {unit}; give it in degrees or radians")
    in_degrees = [bool(DEGREES.fullmatch(unit)) if (unit := _unit(variable)) else None for variable in variables]
    without = [variable.name for variable, known in zip(variables, in_degrees, strict=True) if known is None]
    if without:
        known = [degrees for degrees in in_degrees if degrees is not None]
        small = np.abs(values[0]).max() <= np.pi + ANGLE_ROUNDING and np.abs(values[1]).max() <= TURN + ANGLE_ROUNDING
        assumed = known[0] if known else not small
        unit = "degrees" if assumed else "radians"
        _tell(
            f"{path}: {' and '.join(without)} without units, taken to be in {unit}; set the attribute units to be sure"
        )
        in_degrees = [assumed if degrees is None else degrees for degrees in in_degrees]
    return [np.radians(angle) if degrees else angle for angle, degrees in zip(values, in_degrees, strict=True)]


def _degrees(angle: float) -> str:
    return f"{np.degrees(angle):g}"


def _tell(words: str) -> None:
    warnings.warn(words, MeshWarning, stacklevel=5)

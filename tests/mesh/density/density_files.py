"""Density files as other programs write them."""

from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
"""Dimensions, values and attributes."""


def write_file(path: Path, **variables: Variable) -> Path:
    """A NetCDF file with these variables; values that are masked arrays keep their gaps."""
    with netCDF4.Dataset(path, "w") as file:
        for name, (dimensions, given, attributes) in variables.items():
            values = np.ma.asarray(given)
            for dimension, size in zip(dimensions, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            packing = {key: attributes[key] for key in ("scale_factor", "add_offset") if key in attributes}
            target = file.createVariable(name, "i2" if packing else values.dtype, dimensions, fill_value=None)
            target.setncatts(attributes)
            target[:] = values
    return path


NORTH, EAST = {"units": "degrees_north"}, {"units": "degrees_east"}


def field(longitude: np.ndarray, latitude: np.ndarray) -> np.ndarray:
    """A smooth positive field of angles in degrees, one value at each pole."""
    lon, lat = np.radians(longitude), np.radians(latitude)
    return 2.0 + np.cos(lat) * np.cos(lon - 0.4) + 0.3 * np.sin(lat)

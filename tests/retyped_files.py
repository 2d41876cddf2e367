"""Copies of files with numbers of other types."""

from pathlib import Path

import netCDF4


def in_types(source: Path, target: Path, **types: str) -> Path:
    """Copy a mesh file with other types for its kinds of numbers, as `f="f4"` or `i="i8"`."""
    with netCDF4.Dataset(source) as old, netCDF4.Dataset(target, "w") as new:
        new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
        for name, dimension in old.dimensions.items():
            new.createDimension(name, len(dimension))
        for name, variable in old.variables.items():
            kind = types.get(variable.dtype.kind, variable.dtype)
            new.createVariable(name, kind, variable.dimensions)[:] = variable[:]
    return target

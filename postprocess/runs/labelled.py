"""Files of a run as objects of xarray and uxarray, which are optional extras and imported on first use."""

from pathlib import Path
from typing import TYPE_CHECKING

from mesh.safe_files import netcdf_lock
from swe.errors import InputError

if TYPE_CHECKING:
    import uxarray
    import xarray


def opened_by_xarray(path: Path) -> "xarray.Dataset":
    """Open a NetCDF file lazily.

    Raises `InputError` if xarray is not installed or the file cannot be read.
    """
    try:
        import xarray
    except ImportError as missing:
        raise InputError(
            f"{path} is opened by the package xarray, which is missing; install it with pip install 'trisk[xarray]'"
        ) from missing
    try:
        with netcdf_lock:
            return xarray.open_dataset(path.absolute(), engine="netcdf4")
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{path} cannot be read ({error}); name a directory that a run wrote") from error


def grid_of_uxarray(path: Path) -> "uxarray.Grid":
    """Open a mesh file as a Grid.

    Raises `InputError` if uxarray is not installed or the file cannot be read.
    """
    try:
        import uxarray
    except ImportError as missing:
        raise InputError(
            f"{path} is opened by the package uxarray, which is missing; install it with pip install 'trisk[uxarray]'"
        ) from missing
    try:
        with netcdf_lock:
            return uxarray.open_grid(path.absolute())
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{path} cannot be read ({error}); name a directory that a run wrote") from error

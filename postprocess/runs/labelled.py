"""Files of a run as xarray Datasets; xarray is optional (the extra `xarray`) and imported on first use."""

from pathlib import Path
from typing import TYPE_CHECKING

from mesh.safe_files import netcdf_lock
from swe.errors import InputError

if TYPE_CHECKING:
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

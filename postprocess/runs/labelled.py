"""Files of a run as objects of xarray and uxarray, which are optional extras and imported on first use."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mesh.safe_files import dataset, netcdf_lock
from swe.errors import InputError

if TYPE_CHECKING:
    import uxarray
    import xarray


def opened_by_xarray(path: Path) -> "xarray.Dataset":
    """Open a NetCDF file lazily.

    Raises `InputError` if xarray is not installed or the file cannot be read.
    """
    return _opened(path, "xarray", lambda xarray: xarray.open_dataset(path.absolute(), engine="netcdf4"))


def grid_of_uxarray(path: Path) -> "uxarray.Grid":
    """Open a mesh file as a Grid.

    Raises `InputError` if uxarray is not installed, or the file cannot be read or is of a plane.
    """
    if _is_of_plane(path):
        raise InputError(
            f"{path} is a mesh on a plane, and grids of uxarray are on spheres alone; take data, plot or trisk convert"
        )
    return _opened(path, "uxarray", lambda uxarray: uxarray.open_grid(path.absolute()))


def _is_of_plane(path: Path) -> bool:
    try:
        with dataset(path) as file:
            return str(getattr(file, "on_a_sphere", "YES")).strip().upper() == "NO"
    except (OSError, RuntimeError):
        return False  # whoever opens it is told


def _opened(path: Path, package: str, opened_by: Callable[[Any], Any]) -> Any:
    """What a package that is an extra of its own name makes of a file."""
    try:
        module = import_module(package)
    except ImportError as missing:
        raise InputError(
            f"{path} is opened by the package {package}, which is missing; "
            f"install it with pip install 'trisk[{package}]'"
        ) from missing
    try:
        with netcdf_lock:
            return opened_by(module)
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{path} cannot be read ({error}); name a directory that a run wrote") from error

"""Places for results, checked before the work that fills them."""

import os
import tempfile
from pathlib import Path

from mesh.safe_files import AnyPath, place_of
from swe.errors import InputError


def require_possible_file(path: Path) -> None:
    """Raise `InputError` if no file can be written to `path`."""
    if path.exists() and not path.is_file():
        raise InputError(f"{path} cannot be written, as it exists and is not a file; choose another place")
    try:
        place = place_of(path)
        if not place.parent.is_dir():
            raise InputError(f"{path} cannot be written, as there is no such folder; choose another place")
        with tempfile.NamedTemporaryFile(dir=place.parent):
            pass
    except OSError as error:
        raise InputError(f"{path} cannot be written ({error.strerror}); choose another place") from error


def require_possible_folder(path: AnyPath) -> None:
    """Raise `InputError` unless `path` is a writable folder, or could become one."""
    path = Path(path)
    # os.path.exists is false, rather than an error, where a folder on the way cannot be searched.
    existing = next(each for each in (path, *path.absolute().parents) if os.path.exists(each))
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(
            f"results cannot be written to {path}: {existing} is not a writable folder; choose another place"
        )


def prepared_folder(path: AnyPath) -> Path:
    """Make the folder `path` and its parents unless they exist; return it.

    Raises `InputError` if it is a file, or cannot be made or written to.
    """
    path = Path(path)
    require_possible_folder(path)
    try:
        place_of(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path} cannot be made ({error.strerror}); choose another place") from error
    return path

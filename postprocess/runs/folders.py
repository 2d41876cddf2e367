"""Folders that results are written to, tried before the work that fills them."""

import os
from pathlib import Path

from mesh.safe_files import AnyPath, place_of
from swe.errors import InputError


def require_possible_folder(path: AnyPath) -> None:
    """Raise `InputError` where `path` is no folder that can be written to, and none can be made there."""
    path = Path(path)
    # os.path.exists is false, rather than an error, where a folder on the way cannot be searched.
    existing = next(each for each in (path, *path.absolute().parents) if os.path.exists(each))
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(f"{path} cannot be a folder of results: {existing} is no folder that one can write to")


def prepared_folder(path: AnyPath) -> Path:
    """Make the folder `path`, and those above it, where it is missing; return it.

    Raises `InputError` where it is a file or cannot be made or written to.
    """
    path = Path(path)
    require_possible_folder(path)
    try:
        place_of(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path} cannot be made ({error.strerror}); choose another place") from error
    return path

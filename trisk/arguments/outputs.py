"""Files that commands write: checked before the work starts, with the command line in their history."""

import shlex
import sys
import tempfile
from pathlib import Path

from mesh.safe_files import name_in_text, place_of
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


def command_line() -> str:
    """The command line as it was typed, for the history of files."""
    return name_in_text(shlex.join(["trisk", *sys.argv[1:]]))

"""Folders that appear under their name only when all of their files are written."""

import os
import shutil
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fnmatch import fnmatch
from pathlib import Path

from mesh.safe_files import place_of
from swe.errors import InputError


def require_replaceable_folder(folder: Path, patterns: Iterable[str]) -> None:
    """Raise `InputError` unless `folder` is absent, or holds only files whose names fit `patterns`."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder; choose another place")
    names = tuple(patterns)
    others = [
        path.name for path in folder.iterdir() if path.is_dir() or not any(fnmatch(path.name, each) for each in names)
    ]
    if others:
        raise InputError(f"{folder} holds {sorted(others)[0]}, which is not replaced; choose another place")


@contextmanager
def folder_aside(folder: Path, patterns: Iterable[str]) -> Iterator[Path]:
    """Give a new folder beside `folder`; rename it to `folder` at the end, or remove it if an exception leaves.

    A folder that holds only files of these `patterns` is replaced; raises `InputError` where there is another.
    """
    names = tuple(patterns)
    folder = place_of(folder)
    mark = uuid.uuid4().hex[:8]
    aside, replaced = (folder.with_name(f".{folder.name}.{mark}.{end}") for end in ("part", "old"))
    try:
        aside.mkdir()
        yield aside
        require_replaceable_folder(folder, names)
        if folder.exists():
            os.replace(folder, replaced)
        os.replace(aside, folder)
    finally:
        for each in (aside, replaced):
            shutil.rmtree(each, ignore_errors=True)

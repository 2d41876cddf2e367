"""Files that appear under their name only when they are whole, and folders that one program at a time writes to."""

import codecs
import errno
import os
import shutil
import threading
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import netCDF4

Mode = Literal["r", "r+", "w"]

AnyPath = str | os.PathLike[str]
"""A path as users give it."""

netcdf_lock = threading.RLock()
"""Held by whoever uses the NetCDF library, which crashes where several threads of a process do so at once."""

BYTES_OF_NAMES = "trisk_bytes_of_names"
"""Encoding that gives the bytes of the name of a file as the system has them, also where they are no text."""


def _codec(name: str) -> codecs.CodecInfo | None:
    if name != BYTES_OF_NAMES:
        return None
    return codecs.CodecInfo(
        lambda text, _="strict": (os.fsencode(text), len(text)), lambda code, _="strict": (os.fsdecode(code), len(code))
    )


codecs.register(_codec)

if hasattr(os, "register_at_fork"):
    # A process is forked while nobody uses the library, so that the child finds it free and sound.
    os.register_at_fork(
        before=netcdf_lock.acquire, after_in_parent=netcdf_lock.release, after_in_child=netcdf_lock.release
    )


class _Dataset(netCDF4.Dataset):
    """A file of the library that can be kept in the mode in which things are defined (`definitions`)."""

    def _redef(self) -> None:
        if not self.__dict__.get("defining"):
            super()._redef()  # type: ignore[misc]

    def _enddef(self) -> None:
        if not self.__dict__.get("defining"):
            super()._enddef()  # type: ignore[misc]


@contextmanager
def definitions(file: netCDF4.Dataset) -> Iterator[None]:
    """Define dimensions, variables and attributes of an open file together, before their values are written.

    The library leaves the mode of definitions after each of them, and a classic file then moves all of its data.
    """
    if file.data_model != "NETCDF4":
        file._redef()
        file.__dict__["defining"] = True
    try:
        yield
    finally:
        if file.__dict__.pop("defining", False):
            file._enddef()


def opened_dataset(path: str | os.PathLike[str], mode: Mode = "r", **options: Any) -> netCDF4.Dataset:
    """Open a NetCDF file whose name may hold any bytes; hold `netcdf_lock` for this and for all use of the file."""
    return _Dataset(os.fspath(path), mode, encoding=BYTES_OF_NAMES, **options)


@contextmanager
def dataset(path: str | os.PathLike[str], mode: Mode = "r", **options: Any) -> Iterator[netCDF4.Dataset]:
    """Open a NetCDF file, with the options of `netCDF4.Dataset`, for this thread alone."""
    with netcdf_lock, opened_dataset(path, mode, **options) as file:
        yield file


def name_in_text(name: object) -> str:
    """The name of a file as text for figures and attributes; bytes that are no text become escapes."""
    return str(name).encode(errors="backslashreplace").decode()


@contextmanager
def held(folder: Path) -> Iterator[bool]:
    """Hold a folder as long as the context lasts; gives False where another program holds it.

    A program that dies lets go. Where the system knows no such locks nobody is kept out.
    """
    try:
        import fcntl
    except ImportError:
        yield True
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        free = True
    except BlockingIOError:
        free = False
    except OSError:
        free = True
    try:
        yield free
    finally:
        os.close(descriptor)


def remove_leftovers(folder: Path, names: Iterable[str]) -> None:
    """Remove what programs left that were killed while they wrote files of these names, or patterns, to `folder`."""
    for name in names:
        for path in folder.glob(f".{name}.*.part"):
            path.unlink(missing_ok=True)


def place_of(path: Path) -> Path:
    """Where a file written to `path` goes: the target of a symbolic link, which need not exist, else `path` itself.

    Raises `OSError` where links go round in a circle.
    """
    if not path.is_symlink():
        return path
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return target


@contextmanager
def written_aside(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`; rename it to `path` at the end, or remove it if an exception leaves.

    Symbolic links stay, and a file that is replaced passes its permissions on. Raises `FileExistsError` where `path`
    is something other than a file, such as a device, and `FileNotFoundError` where it has no folder.
    """
    if path.exists() and not path.is_file():
        raise FileExistsError(errno.EEXIST, "there is something that is no file", str(path))
    path = place_of(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    aside = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        yield aside
        if path.exists():
            shutil.copymode(path, aside)
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)

"""Compiled functions cached on disk, and recompiled when the source of anything they may use has changed.

Numba looks only at the file of a function, and so would run old code after a change of a constant or of a function
that the file imports. Here the stamp of a function covers its module and all modules of ours that it imports, directly
or through others; it is part of the names of the files as well, so that programs of two versions never share one.
"""

import atexit
import functools
import glob
import hashlib
import os
import re
import shutil
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core import caching

ROOT = Path(__file__).parents[1]
PACKAGES = ("mesh", "swe", "cases", "postprocess", "trisk")

IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[\w, \t]*)|import[ \t]+([\w., \t]+))", re.MULTILINE
)
"""Statements of import; what looks like one in a string does no harm, as it only adds to a stamp."""


class SourcesLocator(caching._CacheLocator):
    """Tells numba where a function of our packages is kept, and by which stamp it is known."""

    def __init__(self, function: Callable, file: str, folder: str) -> None:
        self._py_file = file  # numba asks for this name
        self._folder = folder
        self._name = f"{Path(file).stem}.{function.__qualname__}".replace("<", "").replace(">", "")
        self._line = function.__code__.co_firstlineno
        self._stamp = sources_stamp(Path(file).resolve())

    @classmethod
    def from_function(cls, py_func: Callable, py_file: str) -> "SourcesLocator | None":
        """The locator of a function of ours in the folder that numba would take; None for functions of others."""
        if not is_ours(Path(py_file).resolve()):
            return None
        others = (each for each in _locators() if each is not cls)
        found = next(filter(None, (each.from_function(py_func, py_file) for each in others)), None)
        return cls(py_func, py_file, temporary_folder() if found is None else found.get_cache_path())

    def get_cache_path(self) -> str:
        """Folder of the files."""
        return self._folder

    def get_source_stamp(self) -> str:
        """What changes with any source that the function may use."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """Part of the names of the files."""
        return f"{self._line}-{self._stamp[:16]}"

    def ensure_cache_path(self) -> None:
        """Called by numba before it keeps a function; what older versions of the source left is removed."""
        super().ensure_cache_path()
        for path in glob.glob(f"{glob.escape(os.path.join(self._folder, self._name))}-*.nb[ic]"):
            if self._stamp[:16] not in path:
                Path(path).unlink(missing_ok=True)


def is_ours(file: Path) -> bool:
    """Whether a source file belongs to our packages in this installation."""
    return file.is_relative_to(ROOT) and file.relative_to(ROOT).parts[0] in PACKAGES


@functools.cache
def sources_stamp(file: Path) -> str:
    """Hash of a source file of ours and of all that it imports from our packages, directly or through others."""
    reached, waiting = set(), {file}
    while waiting:
        reached |= waiting
        waiting = set().union(*(imported_files(each) for each in waiting)) - reached
    digest = hashlib.sha256()
    for each in sorted(reached):
        digest.update(f"{each.relative_to(ROOT)}\n".encode(errors="surrogateescape"))
        digest.update(hashlib.sha256(_source(each)).digest())
    return digest.hexdigest()


@functools.cache
def imported_files(file: Path) -> frozenset[Path]:
    """Source files of our packages that `file` imports."""
    names: set[str] = set()
    for module, parts, modules in IMPORT.findall(_source(file).decode(errors="replace")):
        names.update(re.split(r"[,\s]+", modules))
        if module:
            names.update((module, *(f"{module}.{part}" for part in re.findall(r"\w+", parts))))
    ours = (ROOT.joinpath(*name.split(".")) for name in names if name.split(".")[0] in PACKAGES)
    return frozenset(
        path for each in ours for path in (each.with_suffix(".py"), each / "__init__.py") if path.is_file()
    )


@functools.cache
def _source(file: Path) -> bytes:
    return file.read_bytes()


@functools.cache
def temporary_folder() -> str:
    """A folder of this process for compiled functions, where no lasting one can be written; warns once.

    Raises `OSError` where the system has no folder for temporary files either.
    """
    try:
        folder = tempfile.mkdtemp(prefix="trisk-compiled-")
    except OSError as error:
        words = "no folder for compiled functions can be written; set NUMBA_CACHE_DIR to one that can"
        raise OSError(error.errno, words) from error
    atexit.register(_remove_of, os.getpid(), folder)
    warnings.warn(
        "compiled functions cannot be kept, and are compiled in each process anew; set NUMBA_CACHE_DIR to a folder "
        "that can be written",
        stacklevel=2,
    )
    return folder


def _remove_of(process: int, folder: str) -> None:
    """Remove the folder at the end of the process that made it, not of those forked from it."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def _locators() -> list[Any]:
    return caching.CompileResultCacheImpl._locator_classes


# Numba asks in this order.
_locators().insert(0, SourcesLocator)

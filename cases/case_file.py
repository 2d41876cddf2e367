"""Cases written by users: a class, or an object, in a Python file."""

import copy
import importlib.util
import inspect
import math
import sys
import traceback
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import Any, cast

from cases.base import Case
from swe.errors import InputError

MARK = ".py:"
"""Distinguishes FILE.py:CLASS from the name of a case."""


def is_address(name: str) -> bool:
    """Whether `name` means a file rather than a case of this package."""
    return MARK in name or name.endswith(".py")


def load_case(address: str) -> Case:
    """Return the case at `address`, FILE.py:CLASS; its name is the address with the absolute path.

    CLASS is a subclass of `Case`, or an object with all its members. Raises `InputError` if there is no such case.
    """
    file, _, attribute = address.rpartition(":")
    if not address.rpartition(MARK)[1]:
        raise InputError(f"{address} is a file; name the class in it as well: {address}:MyCase")
    path = Path(file).absolute()
    found = _attribute(_imported(path), attribute, path)
    case = _made(found, address, path) if isinstance(found, type) else found
    _require_members(case, address, path)
    return named(cast(Case, case), f"{path}:{attribute}")


def named(case: Case, name: str) -> Case:
    """A copy of `case` with its own `name`; the class and the original keep theirs.

    Raises `InputError` if the object does not accept a name.
    """
    try:
        copied = copy.copy(case)
        object.__setattr__(copied, "name", name)
    except (TypeError, AttributeError) as error:
        raise InputError(
            f"{name} cannot be used ({error}); derive a class from cases.Case whose name is no property"
        ) from error
    return copied


def _imported(path: Path) -> ModuleType:
    """The module in the file at `path`, freshly executed."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; write FILE.py:CLASS with the path of a Python file")
    name = f"case file {path}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where dataclasses look up the module of a class
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise InputError(f"{path} cannot be imported{line_in(path, error)}: {error!r}") from error
    return module


def line_in(path: str | Path, error: BaseException) -> str:
    """The line of the file at `path` that raised `error`, as part of a sentence; empty if none did."""
    if isinstance(error, SyntaxError):
        return f", line {error.lineno}" if error.lineno else ""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
    return f", line {lines[-1]}" if lines else ""


def _attribute(module: ModuleType, attribute: str, path: Path) -> Any:
    if not hasattr(module, attribute):
        own = [name for name, value in vars(module).items() if _is_own_case(value, module)]
        others = f"it holds {', '.join(own)}" if own else "it holds no class derived from cases.Case"
        raise InputError(f"{path} holds no '{attribute}'; {others}")
    return getattr(module, attribute)


def _is_own_case(value: object, module: ModuleType) -> bool:
    return isinstance(value, type) and issubclass(value, Case) and value.__module__ == module.__name__


def _made(kind: type, address: str, path: Path) -> object:
    """An object of the class, with default parameters."""
    if not issubclass(kind, Case):
        raise InputError(f"{address} is not a case; derive the class from cases.Case")
    if inspect.isabstract(kind):
        raise InputError(f"{address} lacks {' and '.join(sorted(kind.__abstractmethods__))}; write them")
    try:
        return kind()
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        line = line_in(path, error)
        if isinstance(error, TypeError) and not line:
            raise InputError(f"{address} cannot be made ({error}); give every parameter a default") from error
        raise InputError(f"{address} cannot be made with its own parameters{line}: {error!r}") from error


def _require_members(case: object, address: str, path: Path) -> None:
    """Raise `InputError` if a member of every case (but name and terms) is missing or has an invalid value."""
    members = {*Case.__annotations__, *vars(Case)} - {"name", "terms"}
    try:
        missing = sorted(name for name in members if not name.startswith("_") and not hasattr(case, name))
    except (Exception, SystemExit) as error:
        raise InputError(f"a property of {address} fails{line_in(path, error)}: {error!r}") from error
    if missing:
        raise InputError(f"{address} lacks {', '.join(missing)}; derive the class from cases.Case and add them")
    known = cast(Case, case)
    if not (_is_finite(known.recommended_days) and known.recommended_days > 0.0):
        raise InputError(f"recommended_days of {address} is {known.recommended_days!r}; give a number above 0")
    if not (isinstance(known.title, str) and isinstance(known.reference, str)):
        raise InputError(f"title and reference of {address} are {known.title!r} and {known.reference!r}; give texts")
    for name in ("prescribed_wind", "has_exact_solution"):
        if not isinstance(getattr(known, name), bool):
            raise InputError(f"{name} of {address} is {getattr(known, name)!r}; give True or False")
    for name in ("background_depth", "radius", "gravity", "rotation_rate"):
        if not _is_finite(getattr(known, name)):
            raise InputError(f"{name} of {address} is {getattr(known, name)!r}; give a finite number")
    if not (known.convergence_order is None or _is_finite(known.convergence_order)):
        raise InputError(f"convergence_order of {address} is {known.convergence_order!r}; give a number or None")


def _is_finite(value: object) -> bool:
    """Whether `value` is a finite number."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)

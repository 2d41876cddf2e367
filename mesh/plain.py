"""Numbers and paths of any type converted to plain Python ones: options are converted once, where they enter."""

import json
import math
import os
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from mesh.errors import MeshError


def plain(value: object) -> object:
    """`value` itself, or the number of Python that a scalar of numpy or an array without dimensions holds."""
    return value.item() if isinstance(value, np.generic | np.ndarray) and value.ndim == 0 else value


def recorded(values: object) -> Any:
    """`values` as a record in JSON gives them back; raise `TypeError` or `ValueError` where it cannot hold them."""
    return json.loads(json.dumps(values, default=_recordable))


def _recordable(value: object) -> object:
    """What JSON can hold instead of a scalar or an array of numpy; raise `TypeError` for anything else."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{value!r} is neither a number nor words")


def plain_number(what: str, value: object, error: type[Exception] = MeshError) -> float:
    """`value` as a float, not always finite; raise `error` where it is no real number."""
    number = plain(value)
    try:
        if isinstance(number, Real) and not isinstance(number, bool):
            return float(number)
    except OverflowError:
        pass
    raise error(f"{what} is {value!r}; it must be a number")


def plain_count(what: str, value: object, error: type[Exception] = MeshError) -> int:
    """`value` as an int; raise `error` where it is no whole number."""
    number = plain_number(what, value, error)
    if not (math.isfinite(number) and number == int(number)):
        raise error(f"{what} is {value!r}; it must be a whole number")
    return int(number)


def plain_path(what: str, value: object, error: type[Exception] = MeshError) -> Path:
    """`value` as a path; raise `error` where it is none."""
    try:
        return Path(os.fspath(value))  # type: ignore[call-overload]
    except TypeError:
        raise error(f"{what} is {value!r}; it must be a path, such as 'folder/file.nc'") from None

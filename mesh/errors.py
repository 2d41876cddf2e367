"""The exceptions that this package raises for bad input, and the check whose message names the offending entities."""

import numpy as np
from numpy.typing import NDArray


class MeshError(ValueError):
    """A mesh, its file or a request for one is wrong; the message says what, where and what to do."""


class HemisphereError(MeshError):
    """All points lie in one hemisphere, so that no triangulation of the sphere joins them."""


class MeshWarning(UserWarning):
    """A mesh is usable but less accurate than ours, or parts of it were rebuilt; the message says how much."""


def require(valid: NDArray[np.bool_], place: str, problem: str) -> None:
    """Raise `MeshError` unless all rows of `valid` are true; the message starts with the rows that are not."""
    rows = valid if valid.ndim == 1 else valid.all(axis=tuple(range(1, valid.ndim)))
    if rows.all():
        return
    wrong = np.flatnonzero(~rows)
    named = ", ".join(str(row) for row in wrong[:3]) + (f" and {len(wrong) - 3} more" if len(wrong) > 3 else "")
    raise MeshError(f"{place} {named} (counted from 0): {problem}")

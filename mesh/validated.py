"""Which meshes in memory have passed validation and are still as they were then.

Their arrays can be changed in place, so that a sum of all bytes is kept beside each of them. It costs little more than
reading them once, a tenth of a cryptographic hash.
"""

from dataclasses import fields
from typing import Any
from weakref import WeakKeyDictionary

import numba
import numpy as np
from numpy.typing import NDArray

FACTORS = (np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x9E3779B185EBCA87))
"""Odd, so that a product loses nothing."""

SHIFT = np.uint64(31)
REST = np.uint64(33)
LANES = 4
"""Sums that run side by side, as each step of one waits for the step before."""

WORD = np.dtype(np.uint64).itemsize

_sums: "WeakKeyDictionary[Any, bytes]" = WeakKeyDictionary()


def remember_validated(mesh: Any) -> None:
    """Note that a mesh, a dataclass of arrays and numbers, has passed validation as it is now, without a warning."""
    _sums[mesh] = _sum_of(mesh)


def is_validated(mesh: Any) -> bool:
    """Whether a mesh has passed validation in this process, and no value has been changed since."""
    known = _sums.get(mesh)
    return known is not None and known == _sum_of(mesh)


def _sum_of(mesh: Any) -> bytes:
    """A sum that differs, but for one chance in 2^64, where any array or number of the mesh does."""
    lanes = np.arange(LANES, dtype=np.uint64)
    for each in fields(mesh):
        value = getattr(mesh, each.name)
        if isinstance(value, np.ndarray | float):
            _add(lanes, np.asarray(value))
    return lanes.tobytes()


def _add(lanes: NDArray[np.uint64], values: NDArray[Any]) -> None:
    content = np.ascontiguousarray(values).reshape(-1).view(np.uint8)
    whole = len(content) - len(content) % WORD
    rest = np.zeros(WORD, np.uint8)
    rest[: len(content) - whole] = content[whole:]
    for words in (content[:whole].view(np.uint64), rest.view(np.uint64)):
        _mix(lanes, words)


@numba.njit(cache=True, nogil=True)
def _mix(lanes: NDArray[np.uint64], words: NDArray[np.uint64]) -> None:
    """Add `words` (n,) to the `lanes` in turn; each place counts differently."""
    a, b, c, d = lanes
    before, after = FACTORS
    whole = len(words) - len(words) % LANES
    for first in range(0, whole, LANES):
        a = _step(a, words[first], before, after)
        b = _step(b, words[first + 1], before, after)
        c = _step(c, words[first + 2], before, after)
        d = _step(d, words[first + 3], before, after)
    for last in range(whole, len(words)):
        a = _step(a, words[last], before, after)
    lanes[0], lanes[1], lanes[2], lanes[3] = a, b, c, d


@numba.njit(nogil=True, forceinline=True)
def _step(lane: np.uint64, word: np.uint64, before: np.uint64, after: np.uint64) -> np.uint64:
    """The next value of a lane; its bits are rotated, as those of a product only reach higher ones."""
    mixed = lane + word * before
    return ((mixed << SHIFT) | (mixed >> REST)) * after

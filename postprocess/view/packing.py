"""Numbers as text in a page: what follows smoothly becomes small differences, whose bytes compress well.

`web/src/unpack.js` is the way back.
"""

import base64
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array

Counts = NDArray[np.int64]

LEVEL, WITH_HEADER_OF_GZIP, MEMORY = 6, 31, 9
"""Of zlib, whose strategy is the one for small differences."""


@dataclass(frozen=True)
class Quantised:
    """Values (n_rows, n) as whole numbers from 0 to 2**bits - 2 between `low` and `high`; the one above is no number.

    A number k stands for `low` + k `step`, and differs from the value by half a `step` at most.
    """

    numbers: Counts
    bits: int
    low: float
    high: float

    @property
    def step(self) -> float:
        """Distance between neighbouring values, in the units of the field."""
        return (self.high - self.low) / (2**self.bits - 2)


def quantised(values: Array, bits: int, limits: tuple[float, float]) -> Quantised:
    """Values (n_rows, n), which lie within `limits` or are not finite, to 8 or 16 `bits`."""
    low, high = limits
    steps = 2**bits - 2
    finite = np.isfinite(values)
    scaled = np.where(finite, values - low, 0.0) * (steps / (high - low) if high > low else 0.0)
    return Quantised(np.where(finite, np.rint(scaled), steps + 1).astype(np.int64), bits, low, high)


def packed_rows(numbers: Counts, bits: int) -> str:
    """Whole numbers (n_rows, n) from 0 to 2**bits - 1, in rows that resemble each other."""
    changes = np.diff(np.diff(numbers, axis=0, prepend=0), axis=1, prepend=0)
    size = 1 << bits
    changes = (changes + size // 2) % size - size // 2
    # Signs go to the lowest bit, so that the high bytes of small differences vanish.
    unsigned = np.where(changes >= 0, 2 * changes, -2 * changes - 1).astype("<u4").ravel()
    planes = unsigned.view(np.uint8).reshape(-1, 4)[:, : bits // 8]
    compressor = zlib.compressobj(LEVEL, zlib.DEFLATED, WITH_HEADER_OF_GZIP, MEMORY, zlib.Z_FILTERED)
    return base64.b64encode(compressor.compress(planes.T.tobytes()) + compressor.flush()).decode()


def packed_list(numbers: Counts, bits: int) -> str:
    """Whole numbers (n,) from 0 to 2**bits - 1."""
    return packed_rows(numbers[None, :], bits)

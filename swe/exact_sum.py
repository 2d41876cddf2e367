"""Sums without rounding, so that they depend neither on the order of the terms nor on threads."""

import numba
import numpy as np

from mesh.arrays import Array, Index

WORD = 32
"""Bits of a word of the accumulator; its integers of 64 bits can take 2^31 terms."""

LOWEST_EXPONENT = -1074
"""Of the last bit of the smallest double."""

PARTS = 16
"""Parts of the values that threads may take."""

WORDS = (1024 - LOWEST_EXPONENT) // WORD + 2


def exact_sum(values: Array) -> float:
    """Sum of float64 `values`, rounded once; what a plain sum gives where some are not finite.

    Every value is an integer times a power of two, and is added as such to a long integer of `WORDS` words.
    """
    if not np.isfinite(values).all():
        return float(values.sum())
    total = 0
    for word in reversed(_words(np.ascontiguousarray(values).view(np.int64)).sum(axis=0).tolist()):
        total = (total << WORD) + word
    return total / (1 << -LOWEST_EXPONENT)


@numba.njit(cache=True, parallel=True)
def _words(bits: Index) -> Index:
    """Words (PARTS, WORDS) of the sums of parts of doubles given by their bits, the lowest first, with carries."""
    words = np.zeros((PARTS, WORDS), np.int64)
    for part in numba.prange(PARTS):
        for i in range(part * bits.size // PARTS, (part + 1) * bits.size // PARTS):
            _add(bits[i], words[part])
    return words


@numba.njit(cache=True)
def _add(bits: int, words: Index) -> None:
    exponent = (bits >> 52) & 0x7FF
    mantissa = bits & 0xFFFFFFFFFFFFF
    if exponent > 0:
        mantissa |= 1 << 52
        exponent -= 1
    word, shift = np.uint64(exponent >> 5), exponent & 31  # division by WORD, and what it leaves
    sign = -1 if bits < 0 else 1
    # Shifted by up to 31 bits the mantissa covers three words; its lower 32 bits and its upper 21 stay below 2^63.
    low = (mantissa & 0xFFFFFFFF) << shift
    high = (mantissa >> WORD) << shift
    words[word] += sign * (low & 0xFFFFFFFF)
    words[word + np.uint64(1)] += sign * ((low >> WORD) + (high & 0xFFFFFFFF))
    words[word + np.uint64(2)] += sign * (high >> WORD)

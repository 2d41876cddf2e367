"""Sums without rounding, so that they depend neither on the order of the terms nor on threads."""

import numba
import numpy as np

from mesh.arrays import Array, Index

WORD = 32
"""Bits of a word of the accumulator; its integers of 64 bits can take 2^31 terms."""

LOWEST_EXPONENT = -1074
"""Of the last bit of the smallest double."""

WORDS = (1024 - LOWEST_EXPONENT) // WORD + 2


def exact_sum(values: Array) -> float:
    """Sum of float64 `values`, rounded once; what a plain sum gives where some are not finite.

    Every value is an integer times a power of two, and is added as such to a long integer of `WORDS` words.
    """
    total = 0
    for word in reversed(_words(np.ascontiguousarray(values).view(np.int64)).tolist()):
        total = (total << WORD) + word
    if not np.isfinite(values).all():
        return float(values.sum())
    return total / (1 << -LOWEST_EXPONENT)


@numba.njit(cache=True)
def _words(bits: Index) -> Index:
    """Words of the sum of doubles given by their bits, the lowest first; carries stay in the words."""
    words = np.zeros(WORDS, np.int64)
    for i in range(bits.size):
        exponent = (bits[i] >> 52) & 0x7FF
        mantissa = bits[i] & 0xFFFFFFFFFFFFF
        if exponent > 0:
            mantissa |= 1 << 52
            exponent -= 1
        word, shift = exponent // WORD, exponent % WORD
        # The mantissa shifted by up to 31 bits covers three words; its halves of 32 and 21 bits stay below 2^63.
        low = (mantissa & 0xFFFFFFFF) << shift
        high = (mantissa >> WORD) << shift
        parts = (low & 0xFFFFFFFF, (low >> WORD) + (high & 0xFFFFFFFF), high >> WORD)
        sign = -1 if bits[i] < 0 else 1
        for part in range(3):
            words[word + part] += sign * parts[part]
    return words

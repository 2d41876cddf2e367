"""Sums without rounding, so that they depend neither on the order of the terms nor on the number of threads."""

import math

import numba
import numpy as np

from mesh.arrays import Array, Index

WORD = 32
"""Bits of a word of the accumulator; its integers of 64 bits can take 2^31 terms."""

LOWEST_EXPONENT = -1074
"""Exponent of the last bit of the smallest double."""

PARTS = 16
"""Number of parts into which the values are divided among threads."""

WORDS = (1024 - LOWEST_EXPONENT) // WORD + 2


def exact_sum(values: Array) -> float:
    """Sum of float64 `values`, rounded once; if some are not finite, the result of a plain sum.

    Every value is an integer times a power of two, and is added as such to a long integer of `WORDS` words.
    """
    return exact_sums(values[None])[0]


def exact_sums(rows: Array) -> list[float]:
    """Sum of each of `rows` (k, n), see `exact_sum`."""
    words, finite = exact_words(rows)
    return [rounded(words[row]) if finite[row] else float(rows[row].sum()) for row in range(len(rows))]


def exact_words(rows: Array) -> tuple[Index, Index]:
    """Words (k, WORDS) that hold the sum of each of `rows` (k, n), and which (k,) have finite values only.

    The words of several parts of a sum add up to those of the whole.
    """
    words, finite = _words(np.ascontiguousarray(rows).view(np.int64))
    return words.sum(axis=0), finite.min(axis=0)


def rounded(words: Index) -> float:
    """The double nearest to the number held in words (WORDS,) with carries; infinite if that is too large."""
    total = 0
    for word in reversed(words.tolist()):
        total = (total << WORD) + word
    try:
        return total / (1 << -LOWEST_EXPONENT)
    except OverflowError:
        return math.inf if total > 0 else -math.inf


@numba.njit(cache=True, parallel=True)
def _words(bits: Index) -> tuple[Index, Index]:
    """Words (PARTS, k, WORDS), lowest first and with carries, of the sums of parts of k rows of doubles.

    The doubles are given by their bits. Also returns which of the parts (PARTS, k) hold finite values only.
    """
    k, size = bits.shape
    words, finite = np.zeros((PARTS, k, WORDS), np.int64), np.ones((PARTS, k), np.int64)
    for part in numba.prange(PARTS):
        first, last = part * size // PARTS, (part + 1) * size // PARTS
        for row in range(k):
            finite[part, row] = _add(bits[row, first:last], words[part, row])
    return words, finite


@numba.njit(cache=True)
def _add(bits: Index, words: Index) -> int:
    """Add doubles given by their bits to `words`; return 0 if some are not finite, else 1.

    Shifted by up to 31 bits, a mantissa spans three words. Consecutive values mostly start in the same word, so three
    partial sums are held until the word changes.
    """
    at = 0
    low_sum = middle_sum = high_sum = 0
    for value in bits:
        exponent = (value >> 52) & 0x7FF
        if exponent == 0x7FF:
            return 0
        mantissa = value & 0xFFFFFFFFFFFFF
        if exponent > 0:
            mantissa |= 1 << 52
            exponent -= 1
        word, shift = exponent >> 5, exponent & 31  # quotient and remainder of division by WORD
        if word != at:
            words[at] += low_sum
            words[at + 1] += middle_sum
            words[at + 2] += high_sum
            low_sum = middle_sum = high_sum = 0
            at = word
        # The mantissa's lower 32 bits and its upper 21 stay below 2^63 when shifted.
        low = (mantissa & 0xFFFFFFFF) << shift
        high = (mantissa >> WORD) << shift
        sign = -1 if value < 0 else 1
        low_sum += sign * (low & 0xFFFFFFFF)
        middle_sum += sign * ((low >> WORD) + (high & 0xFFFFFFFF))
        high_sum += sign * (high >> WORD)
    words[at] += low_sum
    words[at + 1] += middle_sum
    words[at + 2] += high_sum
    return 1

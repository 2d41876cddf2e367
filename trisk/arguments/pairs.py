"""Options that take two numbers."""

import math

from swe.errors import InputError


def pair_of(option: str, text: str, whole: bool = False) -> tuple[float, float]:
    """Two finite numbers with a comma between them; raise `InputError` where there are none, or not `whole` ones."""
    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        first = second = math.nan
    if not (math.isfinite(first) and math.isfinite(second)) or (whole and (first % 1.0 or second % 1.0)):
        kind = "whole numbers" if whole else "finite numbers"
        raise InputError(f"{option} is '{text}'; give two {kind} with a comma between them")
    return first, second


def counts_of(option: str, text: str) -> tuple[int, int]:
    """Two whole numbers with a comma between them; raise `InputError` where there are none."""
    first, second = pair_of(option, text, whole=True)
    return int(first), int(second)

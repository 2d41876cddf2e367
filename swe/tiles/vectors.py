"""The width of the vectors that the loops over tiles use."""

from contextlib import suppress
from typing import Any

import numba
from numba import types
from numba.extending import intrinsic


@intrinsic
def _prefer_widest_vectors(_typing_context: Any) -> Any:
    """Let the loop that calls this use vectors of 512 bits if the processor has them.

    Even then the compiler prefers 256 bits, to spare the clock of older processors, and the loop is a seventh slower.
    llvmlite does not know the attribute by name, so it is added to the underlying set. If that ceases to work, the loop
    is as fast as without it.
    """

    def add_attribute(context: Any, builder: Any, _signature: Any, _arguments: Any) -> Any:
        with suppress(AttributeError, TypeError):
            set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), add_attribute


def _nothing() -> None:
    """The substitute when the loops run as Python."""


use_widest_vectors = _nothing if numba.config.DISABLE_JIT else _prefer_widest_vectors  # type: ignore[attr-defined]

"""How the loops over tiles are compiled, and sizes that their layout and the loops must agree upon."""

from contextlib import suppress
from typing import Any

import numba
from numba import types
from numba.extending import intrinsic

from mesh.arrays import Array, Index

MIRROR = 12300
"""Distance of -U from U in scratch, so also the most edges in a tile; whole pages would share sets of the cache."""

RING = 6
"""Sides that the vectorised loop over cells computes; the few cells with more are computed again separately."""

LANES = 8
"""Cells whose rings are stored together, side by side: the widest vectors have as many lanes."""

TileArrays = tuple[Index, Index, Index, Index, Index, Index, Array, Index]
"""See `swe.tiles.cutting.Tiles.arrays`."""

Arrays = tuple[Array, ...]

options: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
part_options: dict[str, Any] = {**options, "forceinline": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inlined = numba.njit(**part_options)
compiled = numba.njit(parallel=True, cache=True, **options)


@numba.njit(**{**part_options, "fastmath": False})
def rounded_product(x: float, y: float) -> float:
    """The product of x and y, rounded before it is added to another one.

    In the sum of two products the compiler is free to fuse either with the addition, and chooses differently from one
    compilation to the next; this leaves it no choice.
    """
    return x * y


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

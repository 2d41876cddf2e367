"""How the loops over tiles are compiled, and sizes that their layout and the loops must agree upon."""

from typing import Any

import numba

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

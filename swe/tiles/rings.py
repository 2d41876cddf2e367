"""Where the sides of cells stand in the arrays of a tile: in blocks of `LANES` cells, then those of larger cells."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from swe.tiles.layout import LANES, RING


def whole_blocks(cells: int) -> int:
    """Number of cells with those that fill the last block."""
    return -(-cells // LANES) * LANES


def in_whole_blocks(values: Array) -> Array:
    """Values of cells, and zeros that fill the last block."""
    return np.pad(values, (0, whole_blocks(len(values)) - len(values)))


def places_in_blocks(cells: int) -> Index:
    """Place of the first `RING` sides of each cell (cells, RING) in the ring arrays."""
    block, lane = np.divmod(np.arange(cells), LANES)
    return (RING * block[:, None] + np.arange(RING)) * LANES + lane[:, None]


def slots_of_sides(sides: Index, max_edges: int) -> Index:
    """Place of every side (n, max_edges) in the ring arrays as `ring_array` lays them out."""
    larger = np.flatnonzero(sides > RING)
    slots = places_in_blocks(len(sides))[:, np.minimum(np.arange(max_edges), RING - 1)]
    starts = RING * whole_blocks(len(sides)) + np.concatenate([[0], np.cumsum(sides[larger])[:-1]]).astype(np.int64)
    slots[larger] = starts[: len(larger), None] + np.minimum(np.arange(max_edges), sides[larger, None] - 1)
    return slots


def ring_size(sides: Index) -> int:
    """Number of places in a ring array of cells with these sides."""
    return RING * whole_blocks(len(sides)) + int(sides[sides > RING].sum())


def ring_array(values: NDArray[Any], sides: Index, filler: Index | float) -> NDArray[Any]:
    """Rings (n, max_edges) as the kernels read them: `RING` sides of every cell, then whole rings of larger cells.

    `filler` (n,), or one number, fills the rings of cells with fewer sides; the cells that fill the last block have 0.
    """
    inside, larger = np.arange(values.shape[1]) < sides[:, None], sides > RING
    ring = np.empty((len(sides), RING), values.dtype)
    ring.T[:] = filler
    for side in range(min(RING, values.shape[1])):
        ring[inside[:, side], side] = values[inside[:, side], side]
    blocks = np.zeros(RING * whole_blocks(len(sides)), values.dtype)
    blocks[places_in_blocks(len(sides))] = ring
    return np.concatenate([blocks, values[larger][inside[larger]]])

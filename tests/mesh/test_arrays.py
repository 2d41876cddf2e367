"""Functions of rows taken block by block."""

import numpy as np
import pytest

from mesh.arrays import BLOCK, Array, by_blocks
from mesh.geometry.sphere import normalize, to_lonlat, triangle_area


@pytest.mark.parametrize("size", [1, BLOCK, BLOCK + 1, 3 * BLOCK + 5])
def test_blocks_have_the_bits_of_the_whole(size: int) -> None:
    a, b, c = normalize(np.random.default_rng(size).normal(size=(3, size, 3)))
    np.testing.assert_array_equal(by_blocks(triangle_area, a, b, c), triangle_area(a, b, c))
    lon, lat = to_lonlat(a)
    by_rows = by_blocks(lambda rows: np.stack(to_lonlat(rows), axis=1), a)
    np.testing.assert_array_equal(by_rows, np.stack([lon, lat], axis=1))


def test_what_a_block_raises_is_raised() -> None:
    def only_small(values: Array) -> Array:
        if values.max() > 2 * BLOCK:
            raise ValueError("too large")
        return values

    with pytest.raises(ValueError, match="too large"):
        by_blocks(only_small, np.arange(3.0 * BLOCK))

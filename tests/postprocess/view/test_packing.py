import base64
import gzip

import numpy as np
import pytest

from mesh.arrays import Array
from postprocess.view.packing import packed_list, packed_rows, quantised


def unpacked(text: str, rows: int, bits: int) -> Array:
    """The way back, as plainly as can be."""
    planes = np.frombuffer(gzip.decompress(base64.b64decode(text)), dtype=np.uint8).reshape(bits // 8, rows, -1)
    unsigned = sum(plane.astype(np.int64) << (8 * k) for k, plane in enumerate(planes))
    changes = np.where(unsigned % 2, -(unsigned + 1) // 2, unsigned // 2)
    return np.cumsum(np.cumsum(changes, axis=1), axis=0) % 2**bits


@pytest.mark.parametrize("bits", [8, 16, 24])
def test_numbers_come_back(bits: int) -> None:
    numbers = np.random.default_rng(1).integers(0, 2**bits, size=(4, 300))
    numbers[:, :2] = 0, 2**bits - 1
    np.testing.assert_array_equal(unpacked(packed_rows(numbers, bits), 4, bits), numbers)
    np.testing.assert_array_equal(unpacked(packed_list(numbers[0], bits), 1, bits)[0], numbers[0])


def test_what_resembles_its_neighbours_takes_little_room() -> None:
    smooth = np.rint(2000 * np.sin(np.arange(20000) / 500) + 3000).astype(np.int64)
    rows = np.stack([smooth + 3 * k for k in range(8)])
    assert len(packed_rows(rows, 16)) < rows.size / 10


@pytest.mark.parametrize("bits", [8, 16])
def test_values_are_kept_to_half_a_step(bits: int) -> None:
    values = np.random.default_rng(2).normal(5000.0, 300.0, size=(3, 500))
    values[1, 7] = np.nan
    kept = quantised(values, bits, (float(np.nanmin(values)), float(np.nanmax(values))))
    assert kept.numbers[1, 7] == 2**bits - 1
    there = np.isfinite(values)
    assert kept.numbers[there].max() == 2**bits - 2
    assert kept.numbers[there].min() == 0
    back = kept.low + kept.numbers * kept.step
    assert np.abs(back - values)[there].max() <= 0.5 * kept.step * (1 + 1e-9)


def test_one_value_everywhere() -> None:
    kept = quantised(np.full((2, 5), 3.5), 8, (3.5, 3.5))
    assert (kept.numbers == 0).all()
    assert kept.step == 0.0

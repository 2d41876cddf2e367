"""Every compiled function once with its indices tested, and once as Python: no index is out of bounds."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.slow

EXERCISE = Path(__file__).parent / "exercise_kernels.py"


def results(path: Path, *mode: str, **environment: str) -> tuple[dict[str, np.ndarray], list[str]]:
    """What the kernels compute, and which of them were not called."""
    done = subprocess.run(
        [sys.executable, str(EXERCISE), str(path), *mode],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    with np.load(path) as file:
        return dict(file), done.stdout.split()


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    return results(tmp_path_factory.mktemp("kernels") / "compiled.npz")[0]


def assert_equal_to_round_off(found: dict[str, np.ndarray], expected: dict[str, np.ndarray]) -> None:
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, rtol=0, atol=1e-10 * np.abs(values).max(), err_msg=name)


def test_no_index_is_out_of_bounds(expected: dict[str, np.ndarray], tmp_path: Path) -> None:
    found, uncalled = results(tmp_path / "checked.npz", "checked")
    assert uncalled == []
    assert_equal_to_round_off(found, expected)


def test_kernels_are_python_too(expected: dict[str, np.ndarray], tmp_path: Path) -> None:
    found, _ = results(tmp_path / "python.npz", NUMBA_DISABLE_JIT="1")
    assert_equal_to_round_off(found, expected)


def test_a_wrong_index_would_be_found(tmp_path: Path) -> None:
    """The checks themselves, on a kernel that reads beyond its array."""
    code = (
        "from exercise_kernels import compile_checked; compile_checked(); import numba, numpy as np\n"
        "@numba.njit(cache=True, parallel=True)\n"
        "def kernel(x):\n"
        "    for i in numba.prange(x.size + 1):\n"
        "        x[i] = 0.0\n"
        "kernel(np.ones(3))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=EXERCISE.parent, capture_output=True, text=True)
    assert "IndexError: index is out of bounds" in done.stderr

"""The tool that measures what making a mesh costs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mesh_cost import BLOCKS, CELLS, Cost, cost_of, row

TOOLS = str(Path(__file__).parents[2] / "docs/tools")
FILL = "import time; memory = b'1' * 3 * 10**8; time.sleep(0.2)"


def test_a_process_is_measured() -> None:
    """By a small process, as no peak is told below the memory of the one that asks."""
    program = f"import sys, mesh_cost; print(*vars(mesh_cost.cost_of([sys.executable, '-c', {FILL!r}])).values())"
    asked = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, "PYTHONPATH": TOOLS}, capture_output=True, text=True
    )
    seconds, processor_seconds, peak = map(float, asked.stdout.split())
    assert seconds > 0.2
    assert processor_seconds > 0.0
    assert 3.0e8 < peak < 4.5e8


def test_a_command_that_fails_is_told() -> None:
    with pytest.raises(RuntimeError, match="-c raise SystemExit\\(3\\) ended with exit code 3"):
        cost_of([sys.executable, "-c", "raise SystemExit(3)"])


def test_rows_have_units() -> None:
    assert row(1000, "mesh", Cost(2.04, 3.0, 1_500_000)) == "| 1000 | mesh | 2.0 | 3.0 | 0.00 | 1500 |"
    assert min(CELLS) > BLOCKS

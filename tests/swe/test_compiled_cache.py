"""Compiled kernels are kept on disk, and processes that start at once do not spoil them for each other."""

import os
import subprocess
import sys
from pathlib import Path

PROGRAM = """
import numpy as np
from swe.parallel.exact_sum import _words, exact_sum
print(exact_sum(np.full(10, 0.1)), sum(_words.stats.cache_hits.values()))
"""


def start(cache: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    return subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True, env=environment)


def test_processes_that_start_at_once_share_the_cache(tmp_path: Path) -> None:
    together = [start(tmp_path) for _ in range(3)]
    for process in together:
        out, _ = process.communicate(timeout=300)
        assert process.returncode == 0
        assert out.split()[0] == "1.0"
    out, _ = start(tmp_path).communicate(timeout=300)
    assert out.split() == ["1.0", "1"]

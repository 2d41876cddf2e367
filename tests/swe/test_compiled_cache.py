"""Compiled kernels are kept on disk, and processes that start at once do not spoil them for each other."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import swe.parallel.exact_sum
from mesh.compiled_cache import SourcesLocator

PROGRAM = """
import numpy as np
from swe.parallel.exact_sum import _words, exact_sum
print(exact_sum(np.full(10, 0.1)), sum(_words.stats.cache_hits.values()))
"""


def start(cache: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    return subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True, env=environment)


@pytest.mark.slow
def test_processes_that_start_at_once_share_the_cache(tmp_path: Path) -> None:
    together = [start(tmp_path) for _ in range(3)]
    for process in together:
        out, _ = process.communicate(timeout=300)
        assert process.returncode == 0
        assert out.split()[0] == "1.0"
    out, _ = start(tmp_path).communicate(timeout=300)
    assert out.split() == ["1.0", "1"]


def test_the_folder_is_made_anew_and_what_older_sources_left_goes(tmp_path: Path) -> None:
    """A folder may be gone between the import and the first call, as after `make clean`."""
    function, folder = swe.parallel.exact_sum._add.py_func, tmp_path / "gone"
    locator = SourcesLocator(function, swe.parallel.exact_sum.__file__, str(folder))
    locator.ensure_cache_path()
    assert folder.is_dir()
    own = f"exact_sum._add-{locator.get_disambiguator()}.py311"
    for name in (
        f"{own}.nbi",
        f"{own}.1.nbc",
        "exact_sum._add-9-0123456789abcdef.py311.nbi",
        "exact_sum._words-1-0.nbi",
    ):
        (folder / name).touch()
    locator.ensure_cache_path()
    assert {path.name for path in folder.iterdir()} == {f"{own}.nbi", f"{own}.1.nbc", "exact_sum._words-1-0.nbi"}

"""Forked processes and Python threads that call parallel functions at once."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import multiprocessing, sys
from concurrent.futures import ThreadPoolExecutor
from mesh import mesh_quality, scvt_mesh

def mu(cells):
    return mesh_quality(scvt_mesh(cells, start="fibonacci", tolerance=1e-3)).mu

alone = [mu(cells) for cells in (100, 150, 200)]
pool = multiprocessing.get_context("fork").Pool(2) if sys.argv[1] == "processes" else ThreadPoolExecutor(2)
with pool:
    print(list(pool.map(mu, (100, 150, 200))) == alone)
"""


def run(workers: str, layer: str) -> None:
    environment = {**os.environ, "NUMBA_NUM_THREADS": "2", "NUMBA_THREADING_LAYER": layer}
    command = [sys.executable, "-c", PROGRAM, workers]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (0, "True\n"), done.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system does not fork")
@pytest.mark.parametrize("layer", ["omp", "workqueue"])
def test_forked_workers_of_a_program_that_ran_in_parallel(layer: str) -> None:
    run("processes", layer)


def test_python_threads() -> None:
    run("threads", "omp")

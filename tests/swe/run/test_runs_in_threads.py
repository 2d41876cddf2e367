"""Two simulations in two Python threads write what each writes alone; a run takes the threads it is worth."""

import subprocess
import sys
from pathlib import Path

import numba
import pytest

from swe.run.threads import worthwhile_threads

PROGRAM = """
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from cases import Williamson5
from mesh import scvt_mesh
from swe import Simulation

meshes = {cells: scvt_mesh(cells) for cells in (162, 642)}

def run(folder):
    for cells in meshes:
        Simulation(meshes[cells], Williamson5(), Path(folder) / str(cells), snapshot_interval=3600.0,
                   diagnostics_interval=1800.0, time_step=900.0).run(1, progress=False)

run(sys.argv[1])
with ThreadPoolExecutor(2) as pool:
    list(pool.map(run, sys.argv[2:]))
"""


@pytest.mark.slow
def test_files_are_those_of_runs_alone(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in ("alone", "first", "second")]
    done = subprocess.run([sys.executable, "-c", PROGRAM, *folders], capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    for folder in folders[1:]:
        for cells in ("162", "642"):
            for name in ("history.nc", "diagnostics.nc"):
                assert (folder / cells / name).read_bytes() == (folders[0] / cells / name).read_bytes()


def test_threads_are_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("swe.run.threads.CELLS_PER_THREAD", 100)
    numba.set_num_threads(2)
    with worthwhile_threads(199) as few:
        assert few == numba.get_num_threads() == 1
        with worthwhile_threads(200) as nested:
            assert nested == 1
    assert numba.get_num_threads() == 2
    with worthwhile_threads(200) as enough:
        assert enough == 2
    with pytest.raises(KeyError), worthwhile_threads(1):
        raise KeyError
    assert numba.get_num_threads() == 2

"""Compiled functions are kept by the source of all that they use, and run where nothing can be kept."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mesh
from mesh.compiled_cache import ROOT, imported_files, sources_stamp, temporary_folder

CONSTANT = "SHARE = 1.0\n"
KERNEL = """
import numba
from mesh.constant_of_test import (
    SHARE,
)

@numba.njit(cache=True)
def share(x):
    return SHARE * x
"""
PROGRAM = "from mesh.kernel_of_test import share; print(share(3.0), sum(share.stats.cache_hits.values()))"


@pytest.fixture
def installation(tmp_path: Path) -> Path:
    """A copy of the package with a function and, in another module, a constant of it."""
    folder = tmp_path / "installation"
    shutil.copytree(Path(mesh.__file__).parent, folder / "mesh", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "mesh" / "constant_of_test.py").write_text(CONSTANT)
    (folder / "mesh" / "kernel_of_test.py").write_text(KERNEL)
    return folder


def program(installation: Path, **variables: str) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(installation), "PYTHONDONTWRITEBYTECODE": "1", **variables}
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM],
        env=environment,
        cwd=installation,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def result(process: subprocess.Popen[str]) -> tuple[list[str], str]:
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return out.split(), err


@pytest.mark.slow
def test_a_constant_changed_in_another_module_is_used(installation: Path, tmp_path: Path) -> None:
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert result(program(installation, **cache))[0] == ["3.0", "0"]
    assert result(program(installation, **cache))[0] == ["3.0", "1"]
    (installation / "mesh" / "constant_of_test.py").write_text("SHARE = 2.0\n")
    assert result(program(installation, **cache))[0] == ["6.0", "0"]
    assert result(program(installation, **cache))[0] == ["6.0", "1"]
    assert len(list((tmp_path / "cache").rglob("kernel_of_test.share-*.nbi"))) == 1
    (installation / "mesh" / "unrelated_of_test.py").write_text("UNRELATED = 1\n")
    assert result(program(installation, **cache))[0] == ["6.0", "1"]


@pytest.mark.slow
def test_processes_that_start_at_once(installation: Path) -> None:
    for process in [program(installation) for _ in range(3)]:
        assert result(process)[0][0] == "3.0"
    assert result(program(installation))[0] == ["3.0", "1"]


def test_a_folder_that_cannot_be_written(installation: Path, tmp_path: Path) -> None:
    """The variable names a file, the folder of the source has a file for its cache, and there is no home."""
    (tmp_path / "file").write_text("")
    (installation / "mesh" / "__pycache__").write_text("")
    nowhere = {"NUMBA_CACHE_DIR": str(tmp_path / "file"), "HOME": "/proc/none", "XDG_CACHE_HOME": "/proc/none"}
    (tmp_path / "temporary").mkdir()
    out, err = result(program(installation, **nowhere, TMPDIR=str(tmp_path / "temporary")))
    assert out == ["3.0", "0"]
    assert err.count("compiled functions cannot be kept") == 1
    assert "set NUMBA_CACHE_DIR to a folder that can be written" in err
    assert list((tmp_path / "temporary").iterdir()) == []


def test_stamps_cover_what_is_imported_through_others() -> None:
    io, sphere, quality = (
        ROOT / "mesh" / name for name in ("files/io.py", "geometry/sphere.py", "discrete/quality.py")
    )
    assert sphere in imported_files(quality)
    assert ROOT / "mesh" / "arrays.py" in imported_files(sphere)
    assert len({sources_stamp(file) for file in (io, sphere, quality)}) == 3
    assert quality not in imported_files(ROOT / "swe" / "equations" / "kernels.py")


def test_no_folder_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere(**_: object) -> str:
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setattr("tempfile.mkdtemp", nowhere)
    with pytest.raises(OSError, match="set NUMBA_CACHE_DIR to one that can"):
        temporary_folder.__wrapped__()

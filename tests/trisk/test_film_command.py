"""`trisk film`: options, and what it refuses."""

from pathlib import Path

import pytest
from PIL import Image

from tests.trisk.conftest import Call


@pytest.fixture
def run_folder(trisk: Call, tmp_path: Path) -> Path:
    assert trisk("run", "williamson2", "--cells", 162, "--days", 1, "-q", "-o", tmp_path / "run")[0] == 0
    return tmp_path / "run"


def test_film(trisk: Call, run_folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    code, output, _ = trisk(
        "film", run_folder, "--field", "thickness", "--size", "320,200", "--days", "0,1", "-o", path
    )
    assert (code, output) == (0, f"{path}\n")
    with Image.open(path) as image:
        assert (image.n_frames, image.size) == (2, (320, 200))


@pytest.mark.parametrize(
    "option", [("--size", "320"), ("--size", "320.5,200"), ("--days", "a,b"), ("--centre", "nan,0")]
)
def test_refuses_what_is_no_pair(trisk: Call, run_folder: Path, tmp_path: Path, option: tuple[str, str]) -> None:
    code, _, error = trisk("film", run_folder, "--field", "thickness", "-o", tmp_path / "film.gif", *option)
    assert code == 2
    assert error.startswith(f"error: {option[0]} is '{option[1]}'; give two")

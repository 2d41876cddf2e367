"""Films: frames, sizes, colours and days, and how they refuse."""

import shutil
import sys
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from cases import Williamson2
from mesh import scvt_mesh
from mesh.safe_files import dataset
from postprocess import open_run
from postprocess.figures.palettes import palette_colours
from postprocess.film.film import film
from postprocess.runs.reading import Run
from swe import Simulation
from swe.errors import InputError

SIZE = (320, 180)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Three snapshots, in which the whole globe has the thickness 1000, 2000 and 3000 m."""
    folder = tmp_path_factory.mktemp("film") / "run"
    Simulation(scvt_mesh(162), Williamson2(), folder, snapshot_interval=86400.0).run(2.0)
    with dataset(folder / "history.nc", "r+") as file:
        file["thickness"][:] = np.array([1000.0, 2000.0, 3000.0])[:, None]
    return open_run(folder)


def expected(level: float) -> np.ndarray:
    colours = palette_colours("deep")
    return 255.0 * colours[min(int(level * len(colours)), len(colours) - 1)]


def frames_of(path: Path) -> list[np.ndarray]:
    reader = imageio_ffmpeg.read_frames(path)
    assert next(reader)["size"] == SIZE
    return [np.frombuffer(frame, np.uint8).reshape(SIZE[1], SIZE[0], 3) for frame in reader]


def at_middle_of_map(frame: np.ndarray) -> np.ndarray:
    return np.median(frame[94:102, 128:141].reshape(-1, 3), axis=0)  # south of the numbers of the meridians


def test_frames_follow_the_snapshots(run: Run, tmp_path: Path) -> None:
    frames = frames_of(film(run, "thickness", tmp_path / "h.mp4", size=SIZE))
    assert len(frames) == 3
    for frame, level in zip(frames, (0.0, 0.5, 1.0), strict=True):
        np.testing.assert_allclose(at_middle_of_map(frame), expected(level), atol=12.0)
    # The day is told in the corner.
    assert (frames[0][:14, :60] < 100).any()
    assert (frames[0][:14, :60] != frames[2][:14, :60]).any()


def test_days_choose_frames_and_colours(run: Run, tmp_path: Path) -> None:
    frames = frames_of(film(run, "thickness", tmp_path / "h.mp4", size=SIZE, days=(1.0, 2.0)))
    assert len(frames) == 2
    np.testing.assert_allclose(at_middle_of_map(frames[0]), expected(0.0), atol=12.0)


def test_two_large_frames_are_no_reason_to_warn(run: Run, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    film(run, "thickness", tmp_path / "h.mp4", size=(1280, 720), days=(1.0, 2.0))
    assert capfd.readouterr() == ("", "")


def test_gif(run: Run, tmp_path: Path) -> None:
    path = film(run, "thickness", tmp_path / "h.gif", size=(321, 181))
    with Image.open(path) as image:
        assert (image.n_frames, image.size) == (3, (321, 181))
        image.seek(2)
        last = np.asarray(image.convert("RGB"))
    np.testing.assert_allclose(at_middle_of_map(last), expected(1.0), atol=6.0)


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"path": "h.avi"}, "end its name in .mp4 or .gif"),
        ({"size": (321, 180)}, "give even numbers"),
        ({"size": (20, 20)}, "give each side 160 to"),
        ({"field": "salinity"}, "choose among"),
        ({"field": "topography"}, "no field 'topography' that changes in time; choose among thickness, "),
        ({"days": (5.0, 9.0)}, "has 0 snapshots from day 5 to day 9"),
        ({"days": (0.5, 1.0)}, "has 1 snapshot from day 0.5 to day 1"),
        ({"projection": "mercator"}, "choose one of mollweide"),
    ],
)
def test_refuses(run: Run, tmp_path: Path, changed: dict, sentence: str) -> None:
    asked = {"field": "thickness", "path": "h.mp4", **changed}
    with pytest.raises(InputError, match=sentence):
        film(run, asked.pop("field"), tmp_path / asked.pop("path"), **asked)
    assert not list(tmp_path.iterdir())


def test_refuses_a_damaged_snapshot(run: Run, tmp_path: Path) -> None:
    folder = shutil.copytree(run.directory, tmp_path / "damaged")
    with dataset(folder / "history.nc", "r+") as file:
        file["thickness"][1, 7] = np.nan
    with pytest.raises(InputError, match="has non-finite thickness on day 1; it is damaged"):
        film(open_run(folder), "thickness", tmp_path / "h.gif", size=SIZE)
    assert [path.name for path in tmp_path.iterdir()] == ["damaged"]


def test_tells_what_to_install(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match=r"trisk\[film\]"):
        film(run, "thickness", tmp_path / "h.mp4")

"""`trisk compare`: what it prints and writes, and how it refuses."""

import json
from functools import partial
from pathlib import Path

import pytest

from cases import Williamson2
from mesh import scvt_mesh
from postprocess.figures import compare_maps, paper
from swe import Simulation
from tests.trisk.conftest import Call


@pytest.fixture
def compare(trisk: Call, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Run `trisk compare`, drawing small maps of thickness alone."""
    monkeypatch.setattr(compare_maps, "MAP_FIELDS", {"thickness": compare_maps.MAP_FIELDS["thickness"]})
    monkeypatch.setattr(paper, "ROWS", 20)
    monkeypatch.setattr(paper, "COLUMNS", 40)
    return partial(trisk, "compare")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("runs")
    for cells in (42, 162):
        Simulation(scvt_mesh(cells), Williamson2(), folder / f"run{cells}").run(1, progress=False)
    return [folder / "run42", folder / "run162"]


def test_tables_and_maps(compare, runs: list[Path]) -> None:
    code, out, err = compare(*runs)
    assert (code, err) == (0, "")
    for words in ("reference: exact solution", "thickness", "normal velocity", "vorticity", "enstrophy", "42", "162"):
        assert words in out
    maps = sorted((runs[0] / "figures").glob("compare_*.png"))
    assert len(maps) == 2
    assert out.split()[-2:] == [str(path) for path in maps]
    assert not list((runs[0] / "figures").glob("*.html"))
    start = "On day 1 run162 has the smallest l2 error of thickness, "
    assert start in out.split("reference: exact solution")[0]


def test_the_folder_asked_for_gets_a_report(compare, runs: list[Path], tmp_path: Path) -> None:
    code, out, err = compare(*runs, "--reference", runs[0], "--day", 0, "--day", 1, "-o", tmp_path / "of two")
    assert (code, err) == (0, "")
    report = tmp_path / "of two" / "report.html"
    assert out.splitlines()[-1] == str(report)
    parts = (
        '<div class="verdict">',
        "How large the difference is",
        "</div>",
        "<figcaption>",
        "<h2>Norms of the difference</h2>",
    )
    places = [report.read_text().index(part) for part in parts]
    assert places == sorted(places)
    assert report.read_text().count("<figcaption>") == 2
    assert "squared difference in thickness of run162" in report.read_text()


def test_json(compare, runs: list[Path], tmp_path: Path) -> None:
    code, out, _ = compare(*runs, "--reference", runs[0], "--day", 1, "-o", tmp_path / "maps", "--json")
    assert code == 0
    record = json.loads(out)
    assert record["case"] == "williamson2"
    assert record["reference"].endswith("run42, 42 cells")
    first, second = record["entries"]
    assert first["norms"] == {}
    assert set(second["norms"]) == {"thickness", "velocity", "vorticity"}
    assert second["norms"]["thickness"]["l2"] > 0
    assert abs(second["conservation"]["mass_change"]) < 1e-13
    assert all(Path(path).parent == tmp_path / "maps" and Path(path).exists() for path in record["maps"])
    assert (tmp_path / "maps" / "report.html").exists()
    assert len(record["maps"]) == 2


def test_bad_input_is_one_sentence_and_code_2(compare, runs: list[Path], tmp_path: Path) -> None:
    for arguments, words in (
        ((runs[0], "--reference", runs[0]), "nothing but itself"),
        ((runs[0], "--day", 4), "no snapshot of day 4"),
        ((runs[0], "--reference", "nowhere.nc"), "there is no reference 'nowhere.nc'"),
        ((runs[0], "--day", "nan"), "no snapshot of day nan"),
        ((tmp_path,), "holds no readable run"),
        ((runs[0], "-o", runs[0] / "run.json"), "run.json is not a writable folder"),
        ((tmp_path, "-o", runs[0] / "run.json"), "run.json is not a writable folder"),
    ):
        code, out, err = compare(*arguments)
        assert (code, out) == (2, ""), arguments
        assert err.startswith("error: ")
        assert err.count("\n") == 1
        assert words in err


def test_table_is_there_before_the_maps(compare, runs: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr(compare_maps, "_save", full)
    code, out, err = compare(*runs)
    assert (code, err) == (1, "error: No space left on device\n")
    assert "reference: exact solution" in out

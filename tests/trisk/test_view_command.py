from pathlib import Path

from tests.trisk.conftest import Call


def test_view(trisk: Call, mountain_run: Path, damped_run: Path, tmp_path: Path) -> None:
    page = tmp_path / "run.html"
    assert trisk("view", mountain_run, "-o", page) == (0, f"{page}\n", "")
    assert "williamson5, 162 cells" in page.read_text()
    both = tmp_path / "both.html"
    assert trisk("view", mountain_run, damped_run, "-o", both, "--quiet", "--fields", "thickness") == (0, "", "")
    assert "first minus second" in both.read_text()


def test_view_of_a_mesh(trisk: Call, mountain_run: Path, tmp_path: Path) -> None:
    page = tmp_path / "mesh.html"
    assert trisk("view", mountain_run / "mesh.nc", "-o", page) == (0, f"{page}\n", "")
    assert "<title>162 cells on a sphere" in page.read_text()
    code, _, err = trisk("view", mountain_run / "mesh.nc", mountain_run, "-o", page)
    assert code == 2
    assert "a mesh alone has no run beside it" in err


def test_errors_are_one_sentence(trisk: Call, mountain_run: Path, tmp_path: Path) -> None:
    for arguments, words in (
        ((tmp_path, "-o", tmp_path / "a.html"), "no readable run"),
        ((mountain_run, "-o", tmp_path / "a" / "b.html"), "there is no folder"),
        ((mountain_run / "run.json", "-o", tmp_path / "a.html"), "run.json"),
        ((mountain_run, "-o", tmp_path / "a.html", "--fields", "heat"), "choose among thickness"),
    ):
        code, out, err = trisk("view", *arguments)
        assert (code, out) == (2, "")
        assert words in err
        assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []

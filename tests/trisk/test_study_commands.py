"""`trisk study`, `trisk spectra` and `trisk reference`: what they write, and how they refuse."""

from pathlib import Path

import pytest

from cases import Williamson5
from mesh import scvt_mesh
from swe import Simulation
from tests.trisk.conftest import Call

STUDY = ("--family", "scvt", "--cells", 162, "--cells", 642, "--days", 0.25)


@pytest.mark.slow
def test_study_of_meshes_goes_on_where_it_was(trisk: Call, tmp_path: Path) -> None:
    folder = tmp_path / "study"
    code, out, _ = trisk("study", "mesh", "williamson2", *STUDY, "--set", "angle=pi/4", "-o", folder)
    assert code == 0
    assert "scvt-162: williamson2 to day 0.25" in out
    assert out.split()[-1] == str(folder / "report.html")
    assert "--set angle=pi/4" in (folder / "report.html").read_text()
    code, out, _ = trisk("study", "mesh", "williamson2", *STUDY, "--set", "angle=pi/4", "-o", folder)
    assert (code, out) == (0, f"{folder / 'report.html'}\n")


def test_study_of_time_steps(trisk: Call, tmp_path: Path) -> None:
    options = ("--cells", 42, "--days", 0.5, "--dt", 1800, "--dt", 3600, "-q")
    code, out, err = trisk("study", "time", "williamson5", *options, "-o", tmp_path / "study")
    assert (code, out, err) == (0, "", "")
    assert "1800" in (tmp_path / "study" / "study.csv").read_text()
    code, out, _ = trisk("study", "time", "williamson5", *options[:-1], "-o", tmp_path / "study")
    assert (code, out) == (0, f"{tmp_path / 'study' / 'report.html'}\n")


@pytest.mark.slow
def test_studies_of_both_schemes(trisk: Call, tmp_path: Path) -> None:
    schemes = ("--scheme", "ringler2010", "--scheme", "consistent")
    options = ("--family", "scvt", "--cells", 162, "--days", 0.25)
    code, out, _ = trisk("study", "mesh", "williamson2", *options, *schemes, "-o", tmp_path / "meshes")
    assert code == 0
    assert "scvt-162-consistent: williamson2 to day 0.25" in out
    steps = ("--cells", 42, "--days", 0.5, "--dt", 1800, "--dt", 3600)
    code, out, _ = trisk("study", "time", "williamson5", *steps, *schemes[2:], "-o", tmp_path / "times")
    assert code == 0
    assert "dt-1800.0-consistent: williamson5 to day 0.5" in out
    assert "dt-1800.0: " not in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("mesh", "williamson2", "--family", "squares"), "no family of meshes named 'squares'"),
        (("mesh", "williamson2", "--cells", "100"), "100 cells are no bisected icosahedron"),
        (("mesh", "williamson2", "--scheme", "exact"), "no scheme named 'exact'; choose among ringler2010, consistent"),
        (("mesh", "williamson2", "--error-day", "9"), "cannot be taken on day 9 of a run of 5 days"),
        (("mesh", "williamson3"), "no case named 'williamson3'"),
        (("time", "williamson5", "--cells", "42", "--dt", "600"), "at least two"),
        (("time", "williamson5", "--dt", "600", "--dt", "300"), "either --mesh FILE or --cells N"),
    ],
)
def test_studies_that_are_refused(trisk: Call, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    code, out, err = trisk("study", *arguments, "-o", tmp_path / "study")
    assert (code, out) == (2, "")
    assert words in " ".join(err.replace("│", " ").split())
    assert not (tmp_path / "study").exists()


def test_spectra(trisk: Call, tmp_path: Path) -> None:
    pytest.importorskip("ducc0")
    Simulation(scvt_mesh(162), Williamson5(), tmp_path / "run").run(1, progress=False)
    code, out, _ = trisk("spectra", tmp_path / "run", "--day", 0, "--day", 1, "-o", tmp_path / "spectra")
    assert code == 0
    assert out.split() == [str(tmp_path / "spectra" / name) for name in ("spectra.csv", "spectra.png")]
    code, _, err = trisk("spectra", tmp_path / "run", "--day", 3, "-o", tmp_path / "spectra")
    assert code == 2
    assert "no snapshot of day 3" in err
    code, _, err = trisk("spectra", tmp_path / "run", "-o", tmp_path / "run" / "run.json")
    assert code == 2
    assert "run.json is not a writable folder" in err


@pytest.mark.slow
def test_reference(trisk: Call, tmp_path: Path) -> None:
    pytest.importorskip("ducc0")
    path = tmp_path / "reference.nc"
    code, out, _ = trisk("reference", "williamson5", "--truncation", 16, "--day", 0.25, "-o", path)
    assert code == 0
    for words in ("difference from T16", "T4", "T8"):
        assert words in out
    Simulation(scvt_mesh(162), Williamson5(), tmp_path / "run", snapshot_interval=21600.0).run(0.25, progress=False)
    code, out, _ = trisk("compare", tmp_path / "run", "--reference", path, "-o", tmp_path / "maps")
    assert code == 0
    assert "spectral T16" in out
    code, _, err = trisk("reference", "williamson1", "-o", path)
    assert code == 2
    assert "prescribes its wind" in err
    code, _, err = trisk("reference", "williamson5", "-o", tmp_path / "nowhere" / "reference.nc")
    assert code == 2
    assert "no such folder" in err

"""The command line: what it prints, what it writes, and how it refuses."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest


@pytest.fixture
def mesh_file(trisk, tmp_path: Path) -> Path:
    path = tmp_path / "mesh.nc"
    code, out, err = trisk("mesh", "--cells", 162, "-o", path, "-q")
    assert (code, out, err) == (0, "", "")
    return path


def test_from_mesh_to_figures(trisk, mesh_file: Path, tmp_path: Path) -> None:
    code, out, _ = trisk("run", "williamson5", "--mesh", mesh_file, "--days", 1, "-o", tmp_path / "run")
    assert code == 0
    assert "completed" in out
    assert "mass change" in out
    code, out, _ = trisk("plot", tmp_path / "run")
    assert code == 0
    assert len(list((tmp_path / "run" / "figures").glob("*.png"))) == len(out.split()) == 5
    (tmp_path / "run" / "figures").rename(tmp_path / "figures")
    (tmp_path / "run" / "figures").touch()
    code, _, err = trisk("plot", tmp_path / "run")
    assert code == 2
    assert "figures is not a writable folder" in err
    assert "trisk mesh --cells 162" in netCDF4.Dataset(mesh_file).history


def test_quality_as_json_and_as_table(trisk, mesh_file: Path) -> None:
    code, out, _ = trisk("quality", mesh_file, "--json")
    assert code == 0
    measured = json.loads(out)
    contract = {"cells", "mu", "sigma_avg", "sigma_min", "q_avg", "q_min", "residual", "obtuse"}
    assert contract <= set(measured)
    assert measured["cells"] == 162
    assert measured["mu"] == pytest.approx(1.164649, abs=1e-6)
    code, out, _ = trisk("quality", mesh_file)
    assert code == 0
    assert "1.164649" in out


def test_table1(trisk) -> None:
    code, out, _ = trisk("quality", "--table1", "--max-level", 3)
    assert code == 0
    assert "1.1646 0.9110 0.8586 0.9904 0.9729" in out
    assert "1.1647 0.9174 0.8843 0.9872 0.9829" in out
    assert trisk("quality", "--table1", "--max-level", 12)[0] == 2
    assert trisk("quality")[0] == 2


def test_run_generates_a_mesh_of_any_number(trisk, tmp_path: Path) -> None:
    code, _, _ = trisk("run", "williamson2", "--cells", 100, "--days", 0.5, "-o", tmp_path / "run", "-q")
    assert code == 0
    assert json.loads((tmp_path / "run" / "run.json").read_text())["cells"] == 100


def test_help_at_every_level(trisk) -> None:
    for command in ((), ("mesh",), ("quality",), ("run",), ("cases",), ("plot",), ("compare",)):
        code, out, _ = trisk(*command, "--help")
        assert code == 0
        assert "Usage" in out


def test_cases_are_listed_with_their_parameters(trisk) -> None:
    code, out, _ = trisk("cases")
    assert code == 0
    for name in (
        "williamson1",
        "williamson2",
        "williamson5",
        "williamson6",
        "galewsky",
        "lake-at-rest",
        "hollingsworth",
        "stommel",
        "munk",
        "kelvin-wave",
        "seiche",
        "double-gyre",
    ):
        assert name in out
    code, out, _ = trisk("cases", "williamson6")
    assert code == 0
    assert "7.848e-06" in out
    assert "Zonal wave number R" in out
    assert "https://doi.org/" in out


def test_parameters_and_means_are_set_and_recorded(trisk, mesh_file: Path, tmp_path: Path) -> None:
    depths = []
    for number, options in enumerate(((), ("--cell-means",))):
        run = tmp_path / f"run{number}"
        settings = ("--set", "angle=pi/2-0.05", "--set", "reference_depth=5000")
        command = ("run", "williamson2", "--mesh", mesh_file, *settings, *options, "--days", 0.1, "-o", run, "-q")
        assert trisk(*command) == (0, "", "")
        record = json.loads((run / "run.json").read_text())
        assert record["parameters"]["angle"] == np.pi / 2 - 0.05
        assert record["parameters"]["reference_depth"] == 5000.0
        assert record["configuration"]["sampling"] == ("mean" if options else "point")
        with netCDF4.Dataset(run / "history.nc") as file:
            depths.append(np.asarray(file["thickness"][0]))
    assert 1.0 < np.abs(depths[1] - depths[0]).max() < 100.0


def test_case_of_a_user(trisk, mesh_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text(
        "from cases import Williamson5\nclass Mine(Williamson5):\n    title = 'Mine'\n"
        "    def topography(self, longitude, latitude):\n        return 100.0\n"
    )
    monkeypatch.chdir(tmp_path)
    run = ("run", "mine.py:Mine", "--mesh", mesh_file, "--days", 0.1, "-o", "run", "-q")
    assert trisk(*run) == (0, "", "")
    assert json.loads(Path("run/run.json").read_text())["case"] == f"{tmp_path}/mine.py:Mine"
    assert "Speed u0 at the equator" in trisk("cases", "mine.py:Mine")[1]
    with open("mine.py", "a") as file:
        file.write("    def coriolis(self, longitude, latitude):\n        return latitude + missing\n")
    code, _, err = trisk(*run, "--force")
    assert code == 2
    assert "coriolis of" in err
    assert "line 7 of" in err
    assert "Traceback" not in err
    assert json.loads(Path("run/run.json").read_text())["status"] == "completed"


def test_parameter_of_a_user_may_be_text(trisk, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "from dataclasses import dataclass\nfrom cases import Williamson5\n@dataclass(frozen=True)\n"
        "class Mine(Williamson5):\n    label: str = 'of [stone]'\n"
    )
    code, out, err = trisk("cases", f"{tmp_path}/mine.py:Mine")
    assert (code, err) == (0, "")
    assert "of [stone]" in out


def damaged(path: Path, kind: str) -> None:
    if kind == "truncated":
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2])
        return
    with netCDF4.Dataset(path, "r+") as file:
        if kind == "swapped corners":
            file["cellsOnVertex"][[3, 40], 0] = file["cellsOnVertex"][[40, 3], 0]
        elif kind == "not a number":
            file["yCell"][5] = np.nan
        elif kind == "missing variable":
            file.renameVariable("cellsOnVertex", "cornersOnVertex")
        elif kind == "wrong count":
            file["nEdgesOnCell"][7] = 4


@pytest.mark.parametrize("kind", ["truncated", "swapped corners", "not a number", "missing variable", "wrong count"])
def test_damaged_mesh_is_refused_and_nothing_written(trisk, mesh_file: Path, tmp_path: Path, kind: str) -> None:
    damaged(mesh_file, kind)
    before = set(tmp_path.rglob("*"))
    for arguments in (
        ("run", "williamson5", "--mesh", mesh_file, "-o", tmp_path / "run"),
        ("quality", mesh_file),
    ):
        code, out, err = trisk(*arguments)
        assert code == 2
        assert out == ""
        assert err.startswith(f"error: {mesh_file}: ")
        assert err.count("\n") == 1
        assert set(tmp_path.rglob("*")) == before


def test_bad_input_is_one_sentence_and_code_2(trisk, mesh_file: Path, tmp_path: Path) -> None:
    run = ("run", "williamson5", "--mesh", mesh_file)
    for arguments, words in (
        (("run", "williamson55", "--cells", 162, "-o", tmp_path / "run"), "no case named 'williamson55'"),
        (("run", "mine.py:Mine", "--cells", 162, "-o", tmp_path / "run"), "mine.py: no such file"),
        (("cases", "williamson9"), "no case named 'williamson9'"),
        ((*run, "-o", tmp_path / "run", "--set", "height=1"), "no parameter 'height'; choose among radius"),
        ((*run, "-o", tmp_path / "run", "--set", "gravity=high"), "gravity is 'high'; it must be a number"),
        (("run", "williamson1", *run[2:], "-o", tmp_path / "run", "--set", "background_depth=0"), "thickness is 0 m"),
        ((*run, "-o", tmp_path / "run", "--dt", -5), "the time step is -5 s"),
        ((*run, "-o", tmp_path / "run", "--days", 0), "is to last 0 days; give a number above 0"),
        ((*run, "-o", tmp_path / "run", "--snapshot-hours", 0), "the snapshot interval is 0 s"),
        ((*run, "-o", mesh_file / "run"), "cannot be used as a run directory"),
        (("mesh", "--cells", 3, "-o", tmp_path / "x.nc"), "too small"),
        (("mesh", "--cells", 100, "--start", "icosahedral", "-o", tmp_path / "x.nc"), "choose 42 or 162"),
        (("mesh", "--cells", 162, "--tolerance", 0, "-o", tmp_path / "x.nc"), "tolerance"),
        (("mesh", "--cells", 42, "-o", tmp_path / "absent" / "x.nc"), "cannot be written"),
        (("mesh", "-o", tmp_path / "x.nc"), "give --cells N"),
        (("mesh", "--cells", 10**14, "-o", tmp_path / "x.nc"), "too many half-edges"),
        (("mesh", "--cells", 42, "--tolerance", "inf", "-o", tmp_path / "x.nc"), "it must be positive"),
        (("mesh", "--nested", mesh_file, "--start", "random", "-o", tmp_path / "x.nc"), "do not go with --nested"),
        (("mesh", "--cells", 42, "--density", "dense", "-o", tmp_path / "x.nc"), "no density named 'dense'"),
        (("plot", tmp_path), "holds no readable run"),
        (("quality", tmp_path / "absent.nc"), "no such file"),
    ):
        code, _, err = trisk(*arguments)
        assert code == 2, arguments
        last = err.strip().splitlines()[-1]
        assert last.startswith("error: "), err
        assert words in last
        assert "Traceback" not in err
    assert not (tmp_path / "run" / "run.json").exists()


def test_interrupted_generation_resumes(trisk, tmp_path: Path) -> None:
    output = tmp_path / "mesh.nc"
    command = ("mesh", "--cells", 500, "--start", "random", "-o", output, "-q")
    code, _, err = trisk(*command, "--max-iterations", 20)
    assert code == 2
    assert "go on with --resume" in err
    assert "allow more iterations" in err
    assert not output.exists()
    code, _, err = trisk(*command, "--seed", 1, "--resume")
    assert code == 2
    assert "made with seed = 0, not 1" in err
    assert trisk(*command, "--resume")[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"mesh.nc"}


@pytest.mark.slow
def test_meshes_under_a_density(trisk, mesh_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "circle.nc"
    assert trisk("mesh", "--cells", 300, "--density", "refined-circle", "-o", output, "-q")[0] == 0
    measured = json.loads(trisk("quality", output, "--json")[1])
    assert measured["residual"] < 1.1e-6
    assert measured["mu"] > 2.5
    code, out, _ = trisk("mesh", "--cells", 642, "--density", "refined-circle", "--well-centred", "-o", output)
    assert code == 0
    assert "well-centred: the least triangle quality is 0.86" in out
    assert json.loads(trisk("quality", output, "--json")[1])["obtuse"] == 0
    code, _, err = trisk("mesh", "--nested", mesh_file, "--density", "refined-box", "-o", output, "-q")
    assert (code, err) == (0, "")
    measured = json.loads(trisk("quality", output, "--json")[1])
    assert measured["cells"] > 250
    assert measured["residual"] <= 1e-6
    assert re.fullmatch(r"\d+ generators that were held fixed are not counted", measured["residual_note"])
    assert "on the residual" in trisk("quality", output)[1]


def test_mesh_under_a_density_from_a_file(trisk, tmp_path: Path) -> None:
    """The file tells of the density as long as that is there."""
    field, output = tmp_path / "field.nc4", tmp_path / "mesh.nc"
    latitude, longitude = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)
    with netCDF4.Dataset(field, "w") as file:
        for name, values, unit in (("lat", latitude, "degrees_north"), ("lon", longitude, "degrees_east")):
            file.createDimension(name, len(values))
            file.createVariable(name, "f8", (name,)).units = unit
            file[name][:] = values
        file.createVariable("width", "f8", ("lat", "lon"))[:] = np.repeat(120.0 + latitude[:, None] / 3.0, 36, axis=1)
    options = ("--density", field, "--density-variable", "width", "--density-power", -4)
    code, _, err = trisk("mesh", "--cells", 300, *options, "--tolerance", 1e-4, "-o", output, "-q")
    assert (code, err) == (0, "")
    measured = json.loads(trisk("quality", output, "--json")[1])
    assert measured["residual"] <= 1e-4
    assert measured["residual_note"] == ""
    field.unlink()
    measured = json.loads(trisk("quality", output, "--json")[1])
    assert measured["residual"] is None
    assert measured["residual_note"].endswith("field.nc4, which is missing or has changed since")
    assert "unknown" in trisk("quality", output)[1]


@pytest.mark.parametrize("method", ["probabilistic", "macqueen"])
def test_sampling_methods_end_well(trisk, method: str, tmp_path: Path) -> None:
    output = tmp_path / "mesh.nc"
    assert trisk("mesh", "--method", method, "--cells", 642, "-o", output, "-q")[0] == 0
    assert json.loads(trisk("quality", output, "--json")[1])["residual"] < 0.1


def test_seconds_are_for_the_whole_call(trisk, tmp_path: Path) -> None:
    """None are left for centring well once the mesh is converged."""
    options = ("--cells", 162, "--start", "random", "--tolerance", 10, "--well-centred", "--max-seconds", 0)
    code, _, err = trisk("mesh", *options, "-o", tmp_path / "mesh.nc", "-q")
    assert code == 2
    assert "keeps a triangle of quality" in err
    assert err.strip().splitlines()[-1].endswith("allow more time")


def test_wrong_use_is_code_2(trisk, tmp_path: Path) -> None:
    for arguments in (
        ("run", "williamson5", "-o", tmp_path),
        ("run", "williamson5", "--cells", 42, "--mesh", "x", "-o", tmp_path),
        ("mesh", "--cells", "many", "-o", "x"),
        ("dance",),
    ):
        code, _, err = trisk(*arguments)
        assert code == 2
        assert "Traceback" not in err


def test_directory_with_a_run_is_kept_unless_forced(trisk, mesh_file: Path, tmp_path: Path) -> None:
    run = ("run", "williamson2", "--mesh", mesh_file, "--days", 0.1, "-o", tmp_path / "run", "-q")
    assert trisk(*run)[0] == 0
    code, _, err = trisk(*run)
    assert code == 2
    assert "holds a run already" in err
    assert trisk(*run, "--force")[0] == 0


def test_wrong_option_keeps_the_run_that_force_would_replace(trisk, mesh_file: Path, tmp_path: Path) -> None:
    run = ("run", "williamson2", "--mesh", mesh_file, "-o", tmp_path / "run", "-q")
    assert trisk(*run, "--days", 0.1)[0] == 0
    assert trisk(*run, "--days", 0, "--force")[0] == 2
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "completed"


@pytest.mark.slow
def test_full_disk_is_a_sentence(mesh_file: Path, tmp_path: Path) -> None:
    limited = "ulimit -f 300; exec " + shlex.join([sys.executable, "-m", "trisk"])
    for arguments, code in (
        (["mesh", "--cells", "2562", "-o", str(tmp_path / "large.nc"), "-q"], 2),
        (["run", "williamson5", "--mesh", str(mesh_file), "--days", "60", "-o", str(tmp_path / "run"), "-q"], 1),
    ):
        done = subprocess.run(["bash", "-c", f"{limited} {shlex.join(arguments)}"], capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        assert "cannot be written" in done.stderr
        assert "Traceback" not in done.stderr
    assert not (tmp_path / "large.nc").exists()
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "failed"


def test_blow_up_is_code_1(trisk, mesh_file: Path, tmp_path: Path) -> None:
    code, _, err = trisk("run", "williamson5", "--mesh", mesh_file, "--dt", 20000, "-o", tmp_path / "run", "-q")
    assert code == 1
    assert err.startswith("error: at day ")
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "failed"


def test_noise_of_a_file_is_a_warning_in_one_line(trisk, mesh_file: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["areaCell"][:] *= 1 + 1e-8
    command = [sys.executable, "-m", "trisk", "quality", str(mesh_file), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)  # pytest catches warnings
    assert done.stderr.startswith("warning: ")
    assert done.stderr.count("\n") == 1
    assert json.loads(done.stdout)["cells"] == 162
    code, _, err = trisk("quality", mesh_file, "--json", "--recompute-metrics")
    assert (code, err) == (0, "")


def test_output_goes_with_the_table(trisk, tmp_path: Path) -> None:
    assert trisk("mesh", "--cells", 42, "-o", tmp_path / "mesh.nc")[0] == 0
    code, _, err = trisk("quality", tmp_path / "mesh.nc", "-o", tmp_path / "page")
    assert (code, "--output goes with --table1" in err) == (2, True)
    assert not (tmp_path / "page").exists()


def test_an_unknown_format_is_refused_before_the_work(trisk, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("mesh.generation.scvt.find_density", lambda *_: pytest.fail("the work began"))
    code, _, err = trisk("mesh", "--cells", 42, "--format", "hdf5", "-o", tmp_path / "mesh.nc")
    assert code == 2
    assert "hdf5" in err

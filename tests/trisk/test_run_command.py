"""What `trisk run` writes of a run, and which loops take it."""

import json
from pathlib import Path

import netCDF4
import pytest

from mesh import VoronoiMesh, write_mesh
from swe.diagnostics.outputs import FIELDS

WINDY = """
from cases import LakeAtRest
from swe import Forcing

class Windy(LakeAtRest):
    def terms(self):
        return (Forcing("wind", lambda mesh, state, time: 1e-6),)
"""


@pytest.fixture
def mesh_file(small_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(small_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


def fields_in(path: Path) -> list[str]:
    with netCDF4.Dataset(path / "history.nc") as file:
        return [name for name in file.variables if name in FIELDS]


def test_fields_are_chosen_and_kept(trisk, mesh_file: Path, tmp_path: Path) -> None:
    run = ("run", "williamson2", "-o", tmp_path / "run", "-q", "--snapshot-hours", 6)
    asked = ("--fields", "relative_vorticity, thickness")
    assert trisk(*run, "--mesh", mesh_file, "--days", 0.25, *asked) == (0, "", "")
    assert fields_in(tmp_path / "run") == ["thickness", "relative_vorticity"]
    assert trisk(*run, "--resume", "--days", 0.5) == (0, "", "")
    assert json.loads((tmp_path / "run" / "run.json").read_text())["day_reached"] == 0.5
    code, _, err = trisk(*run, "--resume", "--days", 0.75, "--fields", "thickness")
    assert code == 2
    assert "holds a run with fields = ['thickness', 'relative_vorticity'], not ['thickness']" in err
    code, _, err = trisk("plot", tmp_path / "run")
    assert code == 2
    assert "history.nc holds no potential_vorticity; run it again with potential_vorticity among its fields" in err
    assert trisk("compare", tmp_path / "run", "--json")[0] == 2


def test_a_field_that_there_is_not_is_refused_before_the_work(trisk, tmp_path: Path) -> None:
    code, _, err = trisk("run", "williamson2", "--cells", 1_000_000, "-o", tmp_path / "run", "--fields", "speed")
    assert code == 2
    assert "there is no output field 'speed'; choose among thickness, surface_height" in err
    assert not (tmp_path / "run").exists()


def test_the_path_of_a_run_is_told(trisk, mesh_file: Path, tmp_path: Path) -> None:
    (tmp_path / "windy.py").write_text(WINDY)
    run = ("run", f"{tmp_path / 'windy.py'}:Windy", "--mesh", mesh_file, "--days", 0.05, "-o", tmp_path / "run")
    assert trisk(*run)[0] == 0
    assert json.loads((tmp_path / "run" / "run.json").read_text())["loops"] == "fused"
    code, _, err = trisk(*run, "--integrator", "fbrk3", "--force")
    assert code == 0
    assert "the tendency has the term wind: plain loops take the steps, at several times the cost" in err
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert (record["loops"], record["forcings"]) == ("plain", ["wind"])
    assert trisk(*run, "--integrator", "fbrk3", "--force", "-q")[2] == ""
    code, _, err = trisk("run", "williamson2", "--mesh", mesh_file, "--days", 0.05, "-o", tmp_path / "run", "--force")
    assert "plain loops" not in err
    assert json.loads((tmp_path / "run" / "run.json").read_text())["loops"] == "fused"


@pytest.mark.parametrize(
    ("option", "value", "name"),
    [("--apvm", 0.5, "anticipation"), ("--upwinding", 0.3, "upwinding"), ("--dissipation", 1e15, "dissipation")],
)
def test_options_reach_the_run(trisk, mesh_file: Path, tmp_path: Path, option: str, value: float, name: str) -> None:
    """By the record, and by the rate of its term, which no other option makes."""
    run = ("run", "williamson5", "--mesh", mesh_file, "--days", 0.05, "-q", "-o", tmp_path / "run")
    assert trisk(*run, "--set", "radius=6371229", option, value) == (0, "", "")
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    terms = {key: record["configuration"][key] for key in ("anticipation", "upwinding", "dissipation")}
    assert terms == {"anticipation": 0.0, "upwinding": 0.0, "dissipation": 0.0, name: value}
    assert record["parameters"]["radius"] == 6371229.0
    with netCDF4.Dataset(tmp_path / "run" / "diagnostics.nc") as file:
        assert file[f"potential_enstrophy_rate_{name}"][-1] != 0.0
    code, _, err = trisk(*run, option, -1, "--force")
    assert code == 2
    assert "-1" in err


def test_slip_along_walls_is_recorded(trisk, mesh_file: Path, tmp_path: Path) -> None:
    """In the record always; in the files where there is some, so that those of earlier versions stay as they were."""
    for slip, attribute in ((0.0, None), (0.5, 0.5)):
        run = ("run", "williamson5", "--mesh", mesh_file, "--days", 0.05, "-q", "-o", tmp_path / f"run{slip}")
        assert trisk(*run, "--wall-slip", slip) == (0, "", "")
        assert json.loads((tmp_path / f"run{slip}" / "run.json").read_text())["configuration"]["wall_slip"] == slip
        for name in ("history.nc", "diagnostics.nc"):
            with netCDF4.Dataset(tmp_path / f"run{slip}" / name) as file:
                assert getattr(file, "wall_slip", None) == attribute
    code, _, err = trisk(*run, "--wall-slip", -1, "--force")
    assert code == 2
    assert "the wall slip is -1; it must be a number from 0 to 1" in err

"""What the files of a run say of it besides numbers."""

import json
from importlib.metadata import version
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import swe.output.files
from cases import Williamson5
from mesh import VoronoiMesh
from postprocess.runs.reading import read_run
from swe import Simulation
from swe.output.files import package_versions


@pytest.mark.parametrize(("name", "conventions"), [("history.nc", "MPAS"), ("diagnostics.nc", "CF-1.8")])
def test_files_say_what_made_them(mountain_run: Path, name: str, conventions: str) -> None:
    record = json.loads((mountain_run / "run.json").read_text())
    with netCDF4.Dataset(mountain_run / name) as file:
        found = {attribute: file.getncattr(attribute) for attribute in file.ncattrs()}
    assert found["Conventions"] == conventions
    assert found["source"] == "trisk"
    assert found["title"] == "williamson5, a run of the shallow-water model of trisk"
    assert found["case"] == "williamson5"
    assert json.loads(found["parameters"]) == record["parameters"]
    assert found["mesh_hash"] == record["mesh_hash"]
    assert found["trisk_version"] == version("trisk")


def test_absent_packages_are_said_to_be_absent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(swe.output.files, "PACKAGES", ("numpy", "no-package-of-this-name"))
    assert package_versions() == {"numpy": version("numpy"), "no-package-of-this-name": "not installed"}


def test_a_run_of_an_earlier_version_is_read_and_resumed(
    small_mesh: VoronoiMesh, mountain_run: Path, tmp_path: Path
) -> None:
    """Its fields have no `cell_methods`, and fewer standard names."""
    options: dict[str, float] = {"time_step": 1800.0, "snapshot_interval": 21600.0}
    Simulation(small_mesh, Williamson5(), tmp_path, **options).run(days=0.25, progress=False)
    with netCDF4.Dataset(tmp_path / "history.nc", "r+") as file:
        for name, variable in file.variables.items():
            if "cell_methods" in variable.ncattrs():
                variable.delncattr("cell_methods")
            if name in ("thickness", "kinetic_energy"):
                variable.delncattr("standard_name")
    assert read_run(tmp_path).days.tolist() == [0.0, 0.25]
    Simulation(small_mesh, Williamson5(), tmp_path, **options, resume=True).run(until=0.5, progress=False)
    with netCDF4.Dataset(tmp_path / "history.nc") as found, netCDF4.Dataset(mountain_run / "history.nc") as whole:
        assert "cell_methods" not in found["thickness"].ncattrs()
        for name in ("time", "Time", "thickness", "potential_vorticity"):
            np.testing.assert_array_equal(found[name][:], whole[name][:])

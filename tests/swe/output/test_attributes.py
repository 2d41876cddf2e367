"""What the files of a run say of it besides numbers."""

import json
from importlib.metadata import version
from pathlib import Path

import netCDF4
import pytest

import swe.output.files
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

"""`trisk convert`: what it writes, prints and refuses."""

from pathlib import Path

import netCDF4

from tests.trisk.conftest import Call


def test_both_formats(trisk: Call, mountain_run: Path, tmp_path: Path) -> None:
    code, out, err = trisk("convert", mountain_run, "--to", "ugrid", "-o", tmp_path / "run.nc")
    assert (code, out) == (0, f"{tmp_path / 'run.nc'}\n")
    assert "snapshots" in err
    with netCDF4.Dataset(tmp_path / "run.nc") as file:
        assert file.history.startswith(f"trisk convert {mountain_run} --to ugrid")
    code, out, _ = trisk("convert", mountain_run, "--to", "vtk", "-o", tmp_path / "vtk")
    assert (code, out) == (0, f"{tmp_path / 'vtk' / 'cells.pvd'}\n{tmp_path / 'vtk' / 'edges.pvd'}\n")


def test_quiet_and_force(trisk: Call, mountain_run: Path, tmp_path: Path) -> None:
    command = ("convert", mountain_run, "--to", "vtk", "-o", tmp_path / "vtk", "-q")
    assert trisk(*command) == (0, "", "")
    code, out, err = trisk(*command)
    assert (code, out) == (2, "")
    assert err == f"error: {tmp_path / 'vtk'} exists already; choose another place, or replace it (--force)\n"
    assert trisk(*command, "--force") == (0, "", "")


def test_no_run_and_no_format(trisk: Call, mountain_run: Path, tmp_path: Path) -> None:
    code, _, err = trisk("convert", tmp_path / "none", "--to", "vtk", "-o", tmp_path / "vtk")
    assert code == 2
    assert err.splitlines()[-1].startswith("error: ")
    assert "there is no such folder" in err
    code, _, err = trisk("convert", mountain_run, "--to", "grib", "-o", tmp_path / "vtk", "-q")
    assert (code, err.count("\n")) == (2, 1)
    assert "choose one of ugrid, vtk" in err

"""What is refused, what is replaced, and what a conversion that is broken off leaves."""

import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from postprocess.convert.conversion import FORMATS, convert_run
from swe import InputError, Simulation


@pytest.mark.parametrize("to", FORMATS)
def test_nothing_stays_of_a_conversion_that_is_broken_off(mountain_run: Path, tmp_path: Path, to: str) -> None:
    told: list[float] = []

    def stop(_: str, part: float) -> None:
        told.append(part)
        if len(told) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        convert_run(mountain_run, to, tmp_path / "out", progress=stop)
    assert told == pytest.approx([1 / 3, 2 / 3])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("to", FORMATS)
def test_an_earlier_result_is_replaced_only_if_asked(mountain_run: Path, tmp_path: Path, to: str) -> None:
    first = convert_run(mountain_run, to, tmp_path / "out")
    with pytest.raises(InputError, match=r"out exists already; .*--force"):
        convert_run(mountain_run, to, tmp_path / "out")
    first[0].write_text("old")
    convert_run(mountain_run, to, tmp_path / "out", force=True)
    assert first[0].stat().st_size > 100
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_what_no_conversion_wrote_is_kept(mountain_run: Path, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "letter.txt").write_text("dear")
    with pytest.raises(InputError, match=r"holds letter.txt, which is not replaced"):
        convert_run(mountain_run, "vtk", tmp_path / "folder", force=True)
    with pytest.raises(InputError, match="is not a file"):
        convert_run(mountain_run, "ugrid", tmp_path / "folder", force=True)
    run = tmp_path / "run"
    shutil.copytree(mountain_run, run)
    before = (run / "history.nc").read_bytes()
    with pytest.raises(InputError, match="is a file of the run itself"):
        convert_run(run, "ugrid", run / "history.nc", force=True)
    assert (run / "history.nc").read_bytes() == before


def test_bad_requests_are_refused_in_a_sentence(mountain_run: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no format named 'grib' to convert to; choose one of ugrid, vtk"):
        convert_run(mountain_run, "grib", tmp_path / "out")
    with pytest.raises(InputError, match="holds no readable run"):
        convert_run(tmp_path, "ugrid", tmp_path / "out")
    with pytest.raises(InputError, match="there is no such folder"):
        convert_run(mountain_run, "ugrid", tmp_path / "absent" / "out")


def test_runs_with_few_fields_and_without_attributes_are_converted(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """As earlier versions wrote them; the table says what the file does not."""
    run = tmp_path / "run"
    Simulation(small_mesh, Williamson5(), run, time_step=1800.0, fields=["thickness"]).run(0.25, progress=False)
    with netCDF4.Dataset(run / "history.nc", "r+") as file:
        for name in ("cell_methods", "standard_name", "coordinates"):
            file["thickness"].delncattr(name)
    convert_run(run, "ugrid", tmp_path / "run_ugrid.nc")
    with netCDF4.Dataset(run / "history.nc") as source, netCDF4.Dataset(tmp_path / "run_ugrid.nc") as found:
        np.testing.assert_array_equal(found["thickness"][:], source["thickness"][:])
        assert found["thickness"].standard_name == "cell_thickness"
        assert "normal_velocity" not in found.variables
    assert convert_run(run, "vtk", tmp_path / "vtk") == [tmp_path / "vtk" / "cells.pvd"]

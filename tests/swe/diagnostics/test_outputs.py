"""One table says what a run writes; files, readers and the choice of fields go by it."""

import json
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from postprocess.runs.reading import read_run
from swe import InputError, Simulation
from swe.diagnostics.outputs import FIELDS, TOPOGRAPHY, Field, chosen_fields

STANDARD_NAMES = {
    "thickness": "cell_thickness",
    "kinetic_energy": "specific_kinetic_energy_of_air",
    "velocity_zonal": "eastward_wind",
    "velocity_meridional": "northward_wind",
    "relative_vorticity": "atmosphere_relative_vorticity",
    "topography": "surface_altitude",
}


def test_the_history_says_what_the_table_says(mountain_run: Path) -> None:
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        for name, field in {**FIELDS, "topography": TOPOGRAPHY}.items():
            assert (file[name].units, file[name].long_name) == (field.units, field.meaning)
            assert getattr(file[name], "standard_name", None) == STANDARD_NAMES.get(name)
        places = {name: file[name].dimensions[-1] for name in FIELDS}
    assert {name for name, place in places.items() if place == "nVertices"} == {
        "relative_vorticity",
        "potential_vorticity",
    }
    assert {name for name, place in places.items() if place == "nEdges"} == {"normal_velocity"}


def test_the_history_says_how_values_stand_for_cells_and_moments(mountain_run: Path) -> None:
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        methods = {name: file[name].cell_methods for name in FIELDS}
        assert "cell_methods" not in file["topography"].ncattrs()
    assert methods.pop("thickness") == "area: mean Time: point"
    assert set(methods.values()) == {"Time: point"}


def test_a_run_writes_the_fields_that_are_asked_for(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    asked = ["potential_vorticity", "thickness"]
    Simulation(small_mesh, Williamson5(), tmp_path / "some", fields=asked).run(days=0.5, progress=False)
    Simulation(small_mesh, Williamson5(), tmp_path / "all").run(days=0.5, progress=False)
    with (
        netCDF4.Dataset(tmp_path / "some" / "history.nc") as some,
        netCDF4.Dataset(tmp_path / "all/history.nc") as all_,
    ):
        assert [name for name in some.variables if name in FIELDS] == ["thickness", "potential_vorticity"]
        for name in (*asked, "topography", "time", "lonCell"):
            np.testing.assert_array_equal(some[name][:], all_[name][:])
    assert json.loads((tmp_path / "some" / "run.json").read_text())["fields"] == ["thickness", "potential_vorticity"]
    snapshot = read_run(tmp_path / "some").last_snapshot()
    assert set(snapshot.fields) == set(asked)
    with pytest.raises(InputError, match=r"history.nc holds no surface_height; run it again with surface_height among"):
        snapshot.fields["surface_height"]


def test_a_run_goes_on_with_its_fields(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    options: dict[str, Any] = {"fields": ["thickness"], "snapshot_interval": 21600.0}
    Simulation(small_mesh, Williamson5(), tmp_path / "parts", **options).run(days=0.25, progress=False)
    Simulation(small_mesh, Williamson5(), tmp_path / "parts", resume=True, **options).run(until=0.5, progress=False)
    Simulation(small_mesh, Williamson5(), tmp_path / "whole", **options).run(days=0.5, progress=False)
    assert (tmp_path / "parts/history.nc").read_bytes() == (tmp_path / "whole/history.nc").read_bytes()
    with pytest.raises(
        InputError, match=r"holds a run with fields = .*'thickness'.*; give the same options, or another"
    ):
        Simulation(small_mesh, Williamson5(), tmp_path / "parts", resume=True, snapshot_interval=21600.0)


def test_runs_of_earlier_versions_had_all_fields(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    Simulation(small_mesh, Williamson5(), tmp_path).run(days=0.25, progress=False)
    record = json.loads((tmp_path / "run.json").read_text())
    for name in ("fields", "forcings", "loops"):
        del record[name]
    (tmp_path / "run.json").write_text(json.dumps(record))
    Simulation(small_mesh, Williamson5(), tmp_path, resume=True).run(until=0.5, progress=False)
    with pytest.raises(InputError, match="holds a run with fields = "):
        Simulation(small_mesh, Williamson5(), tmp_path, resume=True, fields=["thickness"])


def test_fields_that_are_none() -> None:
    assert chosen_fields(None) == tuple(FIELDS)
    assert chosen_fields("thickness") == ("thickness",)
    with pytest.raises(
        InputError, match="there is no output field 'vorticity'; choose among thickness, surface_height"
    ):
        chosen_fields(["thickness", "vorticity"])
    with pytest.raises(InputError, match="no output fields are asked for; choose among thickness"):
        chosen_fields([])


def test_a_field_is_added_by_one_entry(
    small_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As docs/extending.md says: an entry of the table, and history and readers have it."""
    head = Field("nCells", "m", "height of the free surface and of the kinetic energy", lambda now: _head(now))

    def _head(now: object) -> np.ndarray:
        return now.state.thickness + now.model.topography + now.diagnosis.kinetic_energy / now.model.gravity  # type: ignore[attr-defined,no-any-return]

    monkeypatch.setitem(FIELDS, "total_head", head)
    simulation = Simulation(small_mesh, Williamson5(), tmp_path)
    simulation.run(days=0.25, progress=False)
    fields = read_run(tmp_path).last_snapshot().fields
    expected = fields["surface_height"] + fields["kinetic_energy"] / simulation.model.gravity
    np.testing.assert_allclose(fields["total_head"], expected, rtol=1e-14)
    with netCDF4.Dataset(tmp_path / "history.nc") as file:
        assert file["total_head"].units == "m"

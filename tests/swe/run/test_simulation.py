import json
from dataclasses import replace
from pathlib import Path

import netCDF4
import numba
import numpy as np
import pytest
import xarray

from cases import Williamson2, Williamson5
from mesh import VoronoiMesh
from swe import RunError, Simulation
from swe.diagnostics.outputs import FIELDS, SERIES
from swe.errors import InputError
from swe.output.files import read_series
from swe.state import State


def test_run_directory_holds_what_scripts_rely_on(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "run")
    simulation.run(days=2.5, progress=False)
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["status"] == "completed"
    assert record["case"] == "williamson5"
    assert record["day_reached"] == 2.5
    assert record["parameters"]["mountain_height"] == 2000.0
    assert record["steps"] == simulation.steps
    assert len(record["mesh_hash"]) == 64
    with netCDF4.Dataset(tmp_path / "run" / "history.nc") as file:
        assert file["time"][:].tolist() == [0.0, 86400.0, 172800.0, 216000.0]
        for name, field in FIELDS.items():
            assert file[name].dimensions == ("Time", field.place)
            assert np.all(np.isfinite(file[name][:]))
        assert file["topography"][:].max() > 1500.0
        np.testing.assert_array_equal(file["thickness"][-1], simulation.state.thickness)
        surface = file["surface_height"][:] - file["thickness"][:] - file["topography"][:]
        assert np.abs(surface).max() < 1e-9
    series = read_series(tmp_path / "run" / "diagnostics.nc")
    assert set(series) == {"time", *SERIES}
    np.testing.assert_array_equal(series["time"], 21600.0 * np.arange(11))
    assert series["mass_change"][0] == series["total_energy_change"][0] == 0.0
    with netCDF4.Dataset(tmp_path / "run" / "mesh.nc") as file:
        assert file.sphere_radius == 6371220.0


def test_conservation_over_two_days(any_mesh: VoronoiMesh) -> None:
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("a streamfunction gives no velocity on edges of no length")
    simulation = Simulation(any_mesh, Williamson5(), time_step=300.0)
    start = simulation.initial_invariants
    simulation.run(days=2, progress=False)
    now = simulation.invariants
    assert now.mass == pytest.approx(start.mass, rel=1e-14)
    assert abs(now.absolute_vorticity - start.absolute_vorticity) < 1e-14 * start.planetary_vorticity_magnitude
    assert now.total_energy == pytest.approx(start.total_energy, rel=1e-6)
    assert simulation.state.normal_velocity.std() > 1.0


def test_result_does_not_depend_on_the_number_of_threads(larger_mesh: VoronoiMesh) -> None:
    states = []
    for threads in (1, 2):
        simulation = Simulation(larger_mesh, Williamson5())
        numba.set_num_threads(threads)
        try:
            for _ in range(20):
                simulation.method.advance(simulation.state, 600.0)
        finally:
            numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
        states.append(simulation.state)
    np.testing.assert_array_equal(states[0].thickness, states[1].thickness)
    np.testing.assert_array_equal(states[0].normal_velocity, states[1].normal_velocity)


def test_default_step_divides_the_output_interval_below_its_courant_number(larger_mesh: VoronoiMesh) -> None:
    simulation = Simulation(larger_mesh, Williamson5())
    count = 21600.0 / simulation.configuration.time_step
    assert count == pytest.approx(round(count))
    assert 0.6 < simulation.initial_courant_number <= 0.8


def test_output_times_are_met_with_a_step_that_does_not_divide_them(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path
) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path, time_step=1000.0, diagnostics_interval=3600.0)
    simulation.run(days=0.25, progress=False)
    assert read_series(tmp_path / "diagnostics.nc")["time"].tolist() == [3600.0 * k for k in range(7)]
    assert simulation.steps == 24


def test_a_run_goes_on_where_it_stood(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    parts = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "parts")
    parts.run(until=1, progress=False)
    parts.run(until=2, progress=False)
    whole = Simulation(icosahedral_mesh, Williamson5(), tmp_path / "whole")
    whole.run(until=2, progress=False)
    np.testing.assert_array_equal(parts.state.thickness, whole.state.thickness)
    series = [read_series(tmp_path / name / "diagnostics.nc") for name in ("parts", "whole")]
    for name in series[0]:
        np.testing.assert_array_equal(series[0][name], series[1][name])


def test_blow_up_stops_at_once_and_keeps_what_was_written(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path, time_step=7200.0)
    with pytest.raises(RunError, match=r"at day .* thickness is .* m in cell .* smaller time step"):
        simulation.run(days=15, progress=False)
    record = json.loads((tmp_path / "run.json").read_text())
    assert record["status"] == "failed"
    assert "thickness is" in record["reason"]
    assert record["day_reached"] < 15
    assert len(read_series(tmp_path / "diagnostics.nc")["time"]) >= 1


def test_interruption_is_recorded(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson5(), tmp_path)
    simulation.run(days=1, progress=False)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(simulation.stepper, "advance", interrupt)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(days=2, progress=False)
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "interrupted"
    assert len(read_series(tmp_path / "diagnostics.nc")["time"]) == 5


def test_wrong_requests_are_refused(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    case = Williamson5()
    with pytest.raises(InputError, match=r"the time step is -1 s; it must be positive"):
        Simulation(icosahedral_mesh, case, time_step=-1.0)
    with pytest.raises(InputError, match="the snapshot interval is nan"):
        Simulation(icosahedral_mesh, case, snapshot_interval=float("nan"))
    with pytest.raises(InputError, match=r"the initial thickness is -.* m in cell .* correct the parameters"):
        Simulation(icosahedral_mesh, replace(case, mountain_height=7000.0))
    with pytest.raises(InputError, match="cannot go to day -2"):
        Simulation(icosahedral_mesh, case).run(days=-2)
    Simulation(icosahedral_mesh, case, tmp_path).run(days=0.1, progress=False)
    with pytest.raises(InputError, match="holds a run already"):
        Simulation(icosahedral_mesh, case, tmp_path)
    Simulation(icosahedral_mesh, case, tmp_path, overwrite=True)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be used as a run directory"):
        Simulation(icosahedral_mesh, case, tmp_path / "file" / "run")


@pytest.mark.slow
def test_uxarray_opens_and_plots_a_run(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    uxarray = pytest.importorskip("uxarray")
    Simulation(icosahedral_mesh, Williamson5(), tmp_path).run(days=1, progress=False)
    for grid in ("mesh.nc", "history.nc"):
        data = uxarray.open_dataset(tmp_path / grid, tmp_path / "history.nc")
        assert data.uxgrid.n_face == 642
        field = data["thickness"].isel(Time=-1)
        assert field.dims == ("n_face",)
        np.testing.assert_allclose(data.uxgrid.face_areas.sum(), 4 * np.pi, rtol=1e-2)
        collection = field.to_polycollection()
        assert len(collection.get_array()) >= 642 - 60
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(tmp_path / "history.nc") as history:
        assert str(history["time"].values[1]) == "2000-01-02T00:00:00.000000000"


def test_steady_state_case_stays_close(icosahedral_mesh: VoronoiMesh) -> None:
    simulation = Simulation(icosahedral_mesh, Williamson2())
    before = simulation.state.copy()
    simulation.run(days=1, progress=False)
    assert np.abs(simulation.state.thickness - before.thickness).max() < 0.01 * before.thickness.max()


def test_history_and_diagnostics_tell_what_they_are_of(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Coordinates as the CF conventions have them, so that other programs find them; the run by name."""
    Simulation(icosahedral_mesh, Williamson5(wind_speed=21.0), tmp_path, integrator="rrk4").run(0.5, progress=False)
    record = json.loads((tmp_path / "run.json").read_text())
    with xarray.open_dataset(tmp_path / "history.nc") as history:
        depth = history["thickness"]
        assert set(depth.coords) == {"Time", "lonCell", "latCell"}
        assert set(history["normal_velocity"].coords) == {"Time", "lonEdge", "latEdge"}
        assert set(history["potential_vorticity"].coords) == {"Time", "lonVertex", "latVertex"}
        assert set(history["topography"].coords) == {"lonCell", "latCell"}
        at_noon = depth.sel(Time="2000-01-01T12:00")
        np.testing.assert_array_equal(at_noon, depth[-1])
        for name in ("Cell", "Edge", "Vertex"):
            longitude, latitude = history[f"lon{name}"], history[f"lat{name}"]
            assert (longitude.standard_name, latitude.standard_name) == ("longitude", "latitude")
            assert longitude.units == latitude.units == "rad"
        assert history["Time"].standard_name == "time"
        assert history.sphere_radius == 6371220.0
        assert history.mesh_spec == "1.0"
    with xarray.open_dataset(tmp_path / "diagnostics.nc") as diagnostics:
        assert diagnostics["mass"].sel(Time="2000-01-01T06:00").size == 1
    for name in ("history.nc", "diagnostics.nc"):
        with xarray.open_dataset(tmp_path / name) as file:
            assert file.title == "williamson5, a run of the shallow-water model of trisk"
            assert file.case == "williamson5"
            assert json.loads(file.parameters) == record["parameters"]
            assert json.loads(file.parameters)["wind_speed"] == 21.0
            assert file.mesh_hash == record["mesh_hash"]
            assert file.scheme.startswith("ringler2010: ")
            assert "Ringler et al. (2010)" in file.scheme
            assert file.trisk_version == record["versions"]["trisk"]
            for option, value in record["configuration"].items():
                # No slip along walls is told only where there is some.
                assert option in ("scheme", "wall_slip") or file.attrs[option] == value
            assert "wall_slip" not in file.attrs
            assert file.integrator == "rrk4"
            assert np.datetime64("2000-01-01T12:00") == file["Time"][-1]
            np.testing.assert_array_equal(file["time"], file["Time"])


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ((np.ones(7), np.zeros(480)), r"initial thickness has shape \(7,\), but the mesh needs \(162,\)"),
        ((np.ones(162, "f4"), np.zeros(480)), "initial thickness has numbers of type float32; it must have float64"),
        ((np.ones(162), np.zeros(7)), r"initial normal velocity has shape \(7,\), but the mesh needs \(480,\)"),
    ],
)
def test_a_state_of_another_mesh_is_refused(small_mesh: VoronoiMesh, fields, words: str) -> None:
    class Wrong(Williamson2):
        def initial_state(self, *_: object) -> State:
            return State(*fields)

    with pytest.raises(InputError, match=words):
        Simulation(small_mesh, Wrong())


def test_a_simulation_shows_what_it_computes_and_how_far_it_is(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(small_mesh, Williamson2(), tmp_path / "run", time_step=1800.0, upwinding=0.5)
    title, *rows = repr(simulation).splitlines()
    assert title == "<Simulation of williamson2"
    assert rows[0] == "  case: Williamson test case 2: steady geostrophic flow"
    assert rows[1].startswith("  mesh: 162 cells on a sphere of radius 6371.22 km, mean spacing 1")
    assert rows[2:5] == ["  scheme: ringler2010", "  integrator: rk4, fused loops", "  options: upwinding 0.5"]
    assert rows[5].startswith("  step: 1800 s, Courant number 0.")
    assert rows[6:] == ["  reached: day 0, 0 steps", f"  output: {tmp_path}/run>"]
    simulation.run(days=0.5, progress=False)
    assert "reached: day 0.5, 24 steps\n" in repr(simulation)
    assert repr(Simulation(small_mesh, Williamson2())).endswith("output: none>")
    damped = Simulation(small_mesh, Williamson2(), anticipation=0.5, dissipation=1e15, wall_slip=0.25)
    assert "  options: anticipation 0.5, dissipation 1e+15 m4/s, wall slip 0.25\n" in repr(damped)
    state = State(np.linspace(50.0, 200.0, 162), np.linspace(-7.0, 3.0, 480))
    assert repr(state) == (
        "<State of 162 cells and 480 edges\n  thickness: 50 to 200 m\n  normal velocity: -7 to 3 m/s>"
    )

"""Every field, series and attribute that a run writes: its value by plain numpy from the state, and its units."""

import json
from pathlib import Path
from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest

from tests.swe import plain_model as plain
from tests.swe.plain_model import GRAVITY, PlainMesh

TIME_STEP = 1800.0
DISSIPATION = 1e17
RADIUS = 6371220.0
RUNS = ("mountain_run", "damped_run", "bell_run")

FIELD_UNITS = {
    "thickness": ("nCells", "m", "thickness"),
    "surface_height": ("nCells", "m", "free surface"),
    "kinetic_energy": ("nCells", "m2 s-2", "kinetic energy per unit mass"),
    "velocity_zonal": ("nCells", "m s-1", "eastward velocity"),
    "velocity_meridional": ("nCells", "m s-1", "northward velocity"),
    "normal_velocity": ("nEdges", "m s-1", "velocity along the normal, from cellsOnEdge 1 to 2"),
    "relative_vorticity": ("nVertices", "s-1", "relative vorticity"),
    "potential_vorticity": ("nVertices", "m-1 s-1", "(f + zeta)/h"),
}

SERIES_UNITS = {
    "mass": ("m3", "integral of thickness"),
    "total_energy": ("m5 s-2", "kinetic plus potential energy"),
    "kinetic_energy": ("m5 s-2", "kinetic energy"),
    "available_potential_energy": ("m5 s-2", "potential energy above that of a level surface"),
    "potential_enstrophy": ("m s-2", "integral of h q2 / 2"),
    "absolute_vorticity": ("m2 s-1", "integral of f + zeta"),
    "mass_change": ("1", "relative to the initial mass"),
    "total_energy_change": ("1", "relative to the initial available energy"),
    "total_energy_change_of_total": ("1", "relative to the initial total energy"),
    "potential_enstrophy_change": ("1", "relative to its initial value"),
    "absolute_vorticity_change": ("1", "relative to the integral of |f|"),
    "courant_number": ("1", "(sqrt(g h) + |u|) dt / d"),
    "max_speed": ("m s-1", "largest speed sqrt(2 K)"),
    "mass_rate_transport": ("m3 s-1", "rate of mass by the divergence of the mass flux"),
    "mass_rate_time": ("m3 s-1", "rate of mass since the row before"),
    "total_energy_rate_coriolis": ("m5 s-3", "rate of total energy by the work of the Coriolis force"),
    "total_energy_rate_exchange": ("m5 s-3", "rate of total energy by the gradient of the Bernoulli function"),
    "total_energy_rate_dissipation": ("m5 s-3", "rate of total energy by biharmonic dissipation"),
    "total_energy_rate_time": ("m5 s-3", "rate of total energy since the row before"),
    "potential_enstrophy_rate_coriolis": ("m s-3", "rate of potential enstrophy by the Coriolis force"),
    "potential_enstrophy_rate_anticipation": ("m s-3", "rate of potential enstrophy by the anticipation"),
    "potential_enstrophy_rate_upwinding": ("m s-3", "rate of potential enstrophy by the upwinding"),
    "potential_enstrophy_rate_dissipation": ("m s-3", "rate of potential enstrophy by biharmonic dissipation"),
    "potential_enstrophy_rate_time": ("m s-3", "rate of potential enstrophy since the row before"),
    "absolute_vorticity_rate_coriolis": ("m2 s-2", "rate of absolute vorticity by the curl of the Coriolis force"),
    "absolute_vorticity_rate_gradient": ("m2 s-2", "rate of absolute vorticity by the gradient of the Bernoulli"),
    "absolute_vorticity_rate_dissipation": ("m2 s-2", "rate of absolute vorticity by biharmonic dissipation"),
    "absolute_vorticity_rate_time": ("m2 s-2", "rate of absolute vorticity since the row before"),
}


class Written:
    """What a run left: mesh, snapshots, series and record, and what follows from the snapshots."""

    def __init__(self, directory: Path, kind: str) -> None:
        self.kind = kind
        self.mesh = PlainMesh(directory / "mesh.nc")
        with netCDF4.Dataset(directory / "history.nc") as file:
            self.history = {name: np.asarray(file[name][:]) for name in (*FIELD_UNITS, "time", "topography")}
        with netCDF4.Dataset(directory / "diagnostics.nc") as file:
            self.series = {name: np.asarray(variable[:]) for name, variable in file.variables.items()}
        self.snapshots = [self._snapshot(row) for row in range(len(self.history["time"]))]

    def _snapshot(self, row: int) -> SimpleNamespace:
        mesh, h, u = self.mesh, self.history["thickness"][row], self.history["normal_velocity"][row]
        return SimpleNamespace(
            h=h,
            u=u,
            F=plain.flux(mesh, h, u),
            K=plain.kinetic_energy(mesh, u),
            zeta=plain.relative_vorticity(mesh, u),
            q=plain.potential_vorticity(mesh, h, u),
            b=self.history["topography"],
        )


@pytest.fixture(params=RUNS)
def written(request: pytest.FixtureRequest) -> Written:
    return Written(request.getfixturevalue(request.param), request.param.removesuffix("_run"))


def close(found: np.ndarray, expected: np.ndarray, part: float = 1e-12) -> None:
    """Equal to a small part of the largest value, which must not vanish."""
    expected = np.asarray(expected)
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=part * np.abs(expected).max())


def test_fields_of_the_history_follow_from_the_state(written: Written) -> None:
    history, mesh = written.history, written.mesh
    assert history["time"].tolist() == [0.0, 21600.0, 43200.0]
    for row, now in enumerate(written.snapshots):
        close(history["surface_height"][row], now.h + now.b)
        close(history["kinetic_energy"][row], now.K)
        close(history["relative_vorticity"][row], now.zeta)
        close(history["potential_vorticity"][row], now.q)
        zonal, meridional = plain.velocity_at_cells(mesh, now.u)
        close(history["velocity_zonal"][row], zonal, 1e-11)
        assert np.abs(history["velocity_meridional"][row] - meridional).max() < 1e-11 * np.abs(zonal).max()


def test_the_state_of_the_history_is_that_of_the_case(mountain_run: Path) -> None:
    """Test case 5 at the start, from equations (95) and (134) of Williamson et al. (1992) worked out here."""
    mesh, written = PlainMesh(mountain_run / "mesh.nc"), Written(mountain_run, "mountain")
    away = (mesh.lonCell - 1.5 * np.pi + np.pi) % (2.0 * np.pi) - np.pi
    distance = np.minimum(np.pi / 9.0, np.sqrt(away**2 + (mesh.latCell - np.pi / 6.0) ** 2))
    mountain = 2000.0 * (1.0 - distance * 9.0 / np.pi)
    surface = 5960.0 - (RADIUS * 7.292e-5 * 20.0 + 200.0) * np.sin(mesh.latCell) ** 2 / 9.80616
    close(written.history["topography"], mountain)
    close(written.history["thickness"][0], surface - mountain)
    normal = RADIUS * 20.0 * -np.sin(mesh.latVertex)
    drop = normal[mesh.verticesOnEdge[:, 0]] - normal[mesh.verticesOnEdge[:, 1]]
    close(written.history["normal_velocity"][0], drop / mesh.dvEdge)
    assert np.abs(written.history["velocity_zonal"][0] - 20.0 * np.cos(mesh.latCell)).max() < 0.6
    assert written.history["velocity_zonal"][0].max() == pytest.approx(20.0, abs=0.4)


def test_integrals_of_the_diagnostics(written: Written) -> None:
    mesh, series = written.mesh, written.series
    A, A_v = mesh.areaCell, mesh.areaTriangle
    for row, now in enumerate(written.snapshots):
        level = (A @ (now.h + now.b)) / A.sum()
        kinetic = A @ (now.h * now.K)
        potential = GRAVITY * (A @ (now.h * (0.5 * now.h + now.b)))
        h_v = plain.thickness_at_vertices(mesh, now.h)
        expected = {
            "mass": A @ now.h,
            "kinetic_energy": kinetic,
            "total_energy": kinetic + potential,
            "available_potential_energy": 0.5 * GRAVITY * (A @ (now.h + now.b - level) ** 2),
            "potential_enstrophy": 0.5 * (A_v @ (h_v * now.q**2)),
        }
        for name, value in expected.items():
            assert series[name][row] == pytest.approx(value, rel=1e-11), name
        planetary = A_v @ np.abs(plain.coriolis(mesh))
        vorticity = A_v @ (plain.coriolis(mesh) + now.zeta)
        assert series["absolute_vorticity"][row] == pytest.approx(vorticity, abs=1e-13 * planetary)


def test_absolute_vorticity_of_a_hemisphere_is_not_zero(small_mesh) -> None:
    """The integral vanishes in every run; with a Coriolis parameter of one sign it has a value."""
    from swe import ShallowWaterModel, State
    from swe.diagnostics.invariants import measure_invariants

    mesh = small_mesh.scaled(2.0)
    f, u = np.linspace(1.0, 3.0, mesh.n_vertices), np.random.default_rng(0).normal(size=mesh.n_edges)
    model = ShallowWaterModel(mesh, np.zeros(mesh.n_cells), f, 9.0)
    state = State(np.full(mesh.n_cells, 5.0), u)
    found = measure_invariants(model, state, model.diagnose(state))
    assert found.absolute_vorticity == pytest.approx(mesh.area_triangle @ f, rel=1e-12)
    assert found.planetary_vorticity_magnitude == pytest.approx(mesh.area_triangle @ f, rel=1e-12)
    assert found.potential_energy == pytest.approx(0.5 * 9.0 * 25.0 * 16.0 * np.pi, rel=1e-12)
    assert found.potential_energy_of_depth == found.potential_energy
    assert found.available_potential_energy == pytest.approx(0.0, abs=1e-12 * found.potential_energy)


def test_changes_are_relative_to_their_yardsticks(written: Written) -> None:
    mesh, series = written.mesh, written.series
    first = {name: values[0] for name, values in series.items()}
    available = first["kinetic_energy"] + first["available_potential_energy"]
    planetary = mesh.areaTriangle @ np.abs(plain.coriolis(mesh))
    yardsticks = {
        "mass_change": ("mass", first["mass"], 1e-15),
        "total_energy_change": ("total_energy", available, 1e-15 * first["total_energy"] / available),
        "total_energy_change_of_total": ("total_energy", first["total_energy"], 1e-15),
        "potential_enstrophy_change": ("potential_enstrophy", first["potential_enstrophy"], 1e-15),
        "absolute_vorticity_change": ("absolute_vorticity", planetary, 1e-15),
    }
    for name, (integral, yardstick, noise) in yardsticks.items():
        expected = (series[integral] - first[integral]) / yardstick
        np.testing.assert_allclose(series[name], expected, rtol=1e-6, atol=4.0 * noise, err_msg=name)
        assert series[name][0] == 0.0
    for name in ("total_energy_change", "total_energy_change_of_total", "potential_enstrophy_change"):
        assert np.all(np.abs(series[name][1:]) > 1e-10)


def test_changes_of_invented_integrals() -> None:
    """Integrals that are all different, so that none can stand for another."""
    from swe.diagnostics.invariants import Invariants, relative_changes

    changes = relative_changes(Invariants(10.0, 1.0, 7.0, 3.0, 8.0, 5.0, 2.0, 16.0), Invariants(*[11.0] * 8))
    assert changes.mass == pytest.approx(1.0 / 10.0)
    assert changes.total_energy == pytest.approx(14.0 / 4.0)
    assert changes.total_energy_of_total == pytest.approx(14.0 / 8.0)
    assert changes.potential_enstrophy == pytest.approx(6.0 / 5.0)
    assert changes.absolute_vorticity == pytest.approx(9.0 / 16.0)


def test_courant_number_and_largest_speed(written: Written) -> None:
    mesh, series = written.mesh, written.series
    for row, now in enumerate(written.snapshots):
        waves = 0.0 if written.kind == "bell" else np.sqrt(GRAVITY * now.h[mesh.cellsOnEdge].max(axis=1))
        rates = (waves + np.abs(now.u)) / mesh.dcEdge
        assert rates.max() > 1.05 * rates.min()
        assert series["courant_number"][row] == pytest.approx(TIME_STEP * rates.max(), rel=1e-12)
        assert series["max_speed"][row] == pytest.approx(np.sqrt(2.0 * now.K.max()), rel=1e-12)


def test_rates_of_the_budgets(written: Written) -> None:
    """The terms that vanish do so beside what cancels in them; the others have their values."""
    mesh, series = written.mesh, written.series
    anticipation = 0.5 * TIME_STEP if written.kind == "damped" else 0.0
    nu = DISSIPATION if written.kind == "damped" else 0.0
    for row, now in enumerate(written.snapshots):
        dh = -plain.outflow(mesh, now.F) / mesh.areaCell
        assert abs(series["mass_rate_transport"][row]) < 1e-13 * (mesh.areaCell @ np.abs(dh))
        if written.kind == "bell":
            forces = [name for name in series if "_rate_" in name and not name.endswith("_time")]
            assert all(series[name][row] == 0.0 for name in forces if not name.startswith("mass"))
            continue
        at_edges = 0.5 * (now.q[mesh.verticesOnEdge[:, 0]] + now.q[mesh.verticesOnEdge[:, 1]])
        Q = plain.coriolis_force(mesh, now.F, at_edges)
        Q_more = plain.coriolis_force(mesh, now.F, plain.anticipated(mesh, now.u, now.q, anticipation))
        damping = -nu * plain.laplacian(mesh, plain.laplacian(mesh, now.u))
        pressure = plain.difference(mesh, GRAVITY * (now.h + now.b) + now.K) / mesh.dcEdge
        h_v_rate = mesh.areaTriangle * plain.thickness_at_vertices(mesh, dh)
        advected = now.q @ plain.circulation(mesh, Q) - 0.5 * (now.q**2 @ h_v_rate)
        scale = np.abs(now.q) @ np.abs(plain.circulation(mesh, Q)) + 0.5 * (now.q**2 @ np.abs(h_v_rate))
        assert row == 0 or abs(advected) > 1e-9 * scale  # the flow is zonal at the start
        assert series["potential_enstrophy_rate_coriolis"][row] == pytest.approx(advected, abs=1e-13 * scale)
        expected = {
            "potential_enstrophy_rate_anticipation": now.q @ plain.circulation(mesh, Q_more),
            "potential_enstrophy_rate_dissipation": now.q @ plain.circulation(mesh, damping),
            "total_energy_rate_dissipation": (mesh.dvEdge * mesh.dcEdge * now.F) @ damping,
        }
        for name, value in expected.items():
            assert series[name][row] == pytest.approx(value, rel=1e-9, abs=0.0), name
            assert (value != 0.0) == (written.kind == "damped"), name
        assert series["potential_enstrophy_rate_upwinding"][row] == 0.0
        work = (mesh.dvEdge * mesh.dcEdge) @ np.abs(now.F * pressure)
        for term in ("coriolis", "exchange"):
            assert abs(series[f"total_energy_rate_{term}"][row]) < 1e-13 * work
        turning = 2.0 * (mesh.dcEdge @ (np.abs(Q) + np.abs(pressure) + np.abs(damping)))
        for term in ("coriolis", "gradient", "dissipation"):
            assert abs(series[f"absolute_vorticity_rate_{term}"][row]) < 1e-13 * turning


def test_rates_of_the_time_step_are_what_the_terms_leave(written: Written) -> None:
    series = written.series
    seconds = np.diff(series["time"])
    terms = {
        "mass": ("transport",),
        "total_energy": ("coriolis", "exchange", "dissipation"),
        "potential_enstrophy": ("coriolis", "anticipation", "upwinding", "dissipation"),
        "absolute_vorticity": ("coriolis", "gradient", "dissipation"),
    }
    for integral, names in terms.items():
        explained = sum(series[f"{integral}_rate_{name}"] for name in names)
        expected = np.diff(series[integral]) / seconds - 0.5 * (explained[1:] + explained[:-1])
        found = series[f"{integral}_rate_time"]
        assert found[0] == 0.0
        np.testing.assert_allclose(found[1:], expected, rtol=1e-9, atol=1e-30, err_msg=integral)
    if written.kind == "damped":
        assert np.all(series["total_energy_rate_dissipation"] < 0.0)
        assert np.all(series["potential_enstrophy_rate_dissipation"] < 0.0)


def test_fields_of_the_history_have_their_units(mountain_run: Path) -> None:
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        for name, (place, units, meaning) in FIELD_UNITS.items():
            assert file[name].dimensions == ("Time", place)
            assert file[name].units == units
            assert meaning in file[name].long_name
        assert (file["topography"].dimensions, file["topography"].units) == (("nCells",), "m")
        assert "height of the bottom" in file["topography"].long_name
        assert {place: len(file.dimensions[place]) for place in ("nCells", "nEdges", "nVertices")} == {
            "nCells": 162,
            "nEdges": 480,
            "nVertices": 320,
        }
        assert file.sphere_radius == RADIUS
        assert set(FIELD_UNITS) == {name for name in file.variables if file[name].dimensions[0] == "Time"} - {
            "time",
            "Time",
        }


def test_series_of_the_diagnostics_have_their_units(mountain_run: Path) -> None:
    with netCDF4.Dataset(mountain_run / "diagnostics.nc") as file:
        assert set(file.variables) == {"time", "Time", *SERIES_UNITS}
        for name, (units, meaning) in SERIES_UNITS.items():
            assert file[name].dimensions == ("Time",)
            assert file[name].units == units, name
            assert meaning in file[name].long_name, name


@pytest.mark.parametrize("name", ["history.nc", "diagnostics.nc"])
def test_time_is_in_seconds_since_a_day_that_readers_know(mountain_run: Path, name: str) -> None:
    with netCDF4.Dataset(mountain_run / name) as file:
        time = file["time"]
        assert time.units == "seconds since 2000-01-01 00:00:00"
        assert file["Time"].standard_name == "time"
        assert file["Time"].units == time.units
        assert time.calendar == "proleptic_gregorian"
        assert time[:].tolist() == [0.0, 21600.0, 43200.0]
        last = netCDF4.num2date(time[-1], time.units, time.calendar)
        assert (last.year, last.month, last.day, last.hour) == (2000, 1, 1, 12)


def test_geometry_in_the_history_is_that_of_the_mesh(mountain_run: Path) -> None:
    history, mesh = PlainMesh(mountain_run / "history.nc"), PlainMesh(mountain_run / "mesh.nc")
    shared = set(history.arrays) & set(mesh.arrays)
    assert {"xCell", "lonVertex", "areaCell", "dcEdge", "dvEdge", "verticesOnCell", "cellsOnVertex"} <= shared
    for name in shared:
        np.testing.assert_array_equal(history.arrays[name], mesh.arrays[name])
    with netCDF4.Dataset(mountain_run / "history.nc") as file, netCDF4.Dataset(mountain_run / "mesh.nc") as other:
        for name in shared & set(other.variables):
            assert getattr(file[name], "units", "") == getattr(other[name], "units", "")


def test_record_of_the_run(damped_run: Path) -> None:
    record = json.loads((damped_run / "run.json").read_text())
    assert record["status"] == "completed"
    assert (record["days"], record["day_reached"], record["steps"], record["cells"]) == (0.5, 0.5, 24, 162)
    assert record["threads"] >= 1
    assert 0.0 < record["wall_seconds"] < 3600.0
    expected = {
        "time_step": 1800.0,
        "snapshot_interval": 21600.0,
        "diagnostics_interval": 21600.0,
        "sampling": "point",
        "integrator": "rk4",
        "anticipation": 0.5,
        "dissipation": 1e17,
    }
    assert {name: record["configuration"][name] for name in expected} == expected
    assert record["parameters"] == {
        "radius": 6371220.0,
        "gravity": 9.80616,
        "rotation_rate": 7.292e-5,
        "mountain_height": 2000.0,
        "mountain_radius": np.pi / 9.0,
        "mountain_longitude": 1.5 * np.pi,
        "mountain_latitude": np.pi / 6.0,
        "wind_speed": 20.0,
        "reference_depth": 5960.0,
    }
    with netCDF4.Dataset(damped_run / "mesh.nc") as file:
        assert record["mesh_hash"].startswith(file.file_id)


def test_checkpoint_holds_the_state_and_what_was_written(mountain_run: Path) -> None:
    paths = sorted(mountain_run.glob("checkpoint.*.npz"))
    assert [path.name for path in paths] == ["checkpoint.shared.npz"]
    with np.load(paths[-1]) as file, netCDF4.Dataset(mountain_run / "history.nc") as history:
        np.testing.assert_array_equal(file["thickness"], history["thickness"][-1])
        np.testing.assert_array_equal(file["normal_velocity"], history["normal_velocity"][-1])
        assert file["time"] == 43200.0
        sizes = [(mountain_run / name).stat().st_size for name in ("history.nc", "diagnostics.nc")]
        assert file["counts"].tolist() == [24, 3, 3, *sizes]


@pytest.mark.parametrize("name", RUNS)
def test_default_step_and_its_limit(name: str, request: pytest.FixtureRequest) -> None:
    """The Courant number of the first row is that of the step in the record, and a default step has 0.8 at most."""
    from cases import find_case
    from mesh import read_mesh
    from swe import Simulation

    directory = request.getfixturevalue(name)
    case = json.loads((directory / "run.json").read_text())["case"]
    with netCDF4.Dataset(directory / "diagnostics.nc") as file:
        per_second = float(file["courant_number"][0]) / TIME_STEP
    steps = np.ceil(21600.0 * per_second / 0.8)
    simulation = Simulation(read_mesh(directory / "mesh.nc"), find_case(case))
    assert simulation.configuration.time_step == pytest.approx(21600.0 / steps, rel=1e-12)
    assert simulation.initial_courant_number == pytest.approx(per_second * 21600.0 / steps, rel=1e-12)


def test_limit_of_the_courant_number_is_that_of_classical_runge_kutta_on_hexagons(small_mesh) -> None:
    """2 sqrt(2) on the imaginary axis over the largest frequency, sqrt(6 g h) / d: 2 / sqrt(3)."""
    import warnings

    from cases import Williamson5
    from swe import Simulation
    from swe.errors import SetupWarning
    from swe.integrators import STEPPINGS

    assert pytest.approx(np.sqrt(8.0) / np.sqrt(6.0), rel=1e-14) == STEPPINGS["rk4"].stable_courant_number
    per_second = Simulation(small_mesh, Williamson5(), time_step=1.0).initial_courant_number
    limit = 1.1547005383792515 / per_second
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Simulation(small_mesh, Williamson5(), time_step=0.999 * limit)
    words = (
        rf"^a time step of {1.01 * limit:.6g} s is likely to be unstable, as the Courant number is 1\.17; "
        rf"one of {0.95 * limit:.3g} s would do$"
    )
    with pytest.warns(SetupWarning, match=words.replace("+", r"\+")):
        Simulation(small_mesh, Williamson5(), time_step=1.01 * limit)

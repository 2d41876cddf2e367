"""Options, paths and parameters of any type that means one, and a run that goes on after each."""

import contextlib
import inspect
import json
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from cases import CASES, LakeAtRest, Williamson2, Williamson5, find_case
from cases.parameters import with_parameters
from mesh import VoronoiMesh, scvt_mesh
from swe import RunError, Simulation
from swe.configuration import Options
from swe.errors import InputError

HOUR = 3600.0


@pytest.fixture(scope="module")
def small_mesh() -> VoronoiMesh:
    return scvt_mesh(42)


@dataclass(frozen=True)
class Listed(LakeAtRest):
    """A case with parameters that are no numbers."""

    name: ClassVar[str] = "listed"
    heights: tuple[float, ...] = (1.0, 2.0)


@pytest.mark.parametrize("number", [np.float64, np.float32, np.int64, np.int16, int, lambda value: np.array(value)])
def test_options_of_any_type_give_the_same_run(small_mesh: VoronoiMesh, tmp_path: Path, number: type) -> None:
    def run(folder: str | Path, convert: type, days: float) -> Simulation:
        simulation = Simulation(
            small_mesh,
            Williamson5(wind_speed=convert(20)),
            folder,
            time_step=convert(1800),
            diagnostics_interval=convert(7200),
            dissipation=convert(1000),
            resume=True,
        )
        simulation.run(convert(days), progress=False)
        return simulation

    run(tmp_path / "float", float, 1)
    run(str(tmp_path / "other"), number, 1)
    run(str(tmp_path / "other"), number, 2)
    run(tmp_path / "float", float, 2)
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "float" / name).read_bytes() == (tmp_path / "other" / name).read_bytes()


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("time_step", "300", "the time step is '300'; it must be a number"),
        ("time_step", 1j, "the time step is 1j; it must be a number"),
        ("snapshot_interval", None, "the snapshot interval is None; it must be a number"),
        ("diagnostics_interval", True, "the diagnostics interval is True; it must be a number"),
        ("checkpoint_interval", [1.0], r"the checkpoint interval is \[1.0\]; it must be a number"),
        ("dissipation", np.array([1.0]), r"the dissipation is array\(\[1.\]\); it must be a number"),
        ("sampling", "means", "the sampling is 'means'; it must be 'point' or 'mean'"),
        ("integrator", 4, "the integrator is 4; it must be 'rk4', 'rrk4', 'fbrk3' or 'rfbrk3'"),
        ("output", 3, "output is 3; it must be a path"),
    ],
)
def test_options_of_no_use_are_named(small_mesh: VoronoiMesh, option: str, value: object, words: str) -> None:
    with pytest.raises(InputError, match=f"^{words}"):
        Simulation(small_mesh, Williamson5(), **{option: value})


def test_days_must_be_a_number(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(InputError, match=r"^the number of days is '1'; it must be a number$"):
        Simulation(small_mesh, Williamson5()).run("1")


def test_parameters_of_numpy_become_plain() -> None:
    case = Williamson2(angle=np.float32(0.1), wind_speed=np.int64(20))
    assert type(case.angle) is float
    assert case.angle == float(np.float32(0.1))
    assert type(case.wind_speed) is float
    json.dumps(case.parameters())
    assert with_parameters(Williamson2(), {"angle": np.float32(0.1)}) == with_parameters(
        Williamson2(), {"angle": float(np.float32(0.1))}
    )


@pytest.mark.parametrize("heights", [(1.0, 3.0), [1.0, 3.0], np.array([1.0, 3.0]), (np.float32(1.0), np.int64(3))])
def test_a_run_goes_on_with_parameters_that_are_lists(small_mesh: VoronoiMesh, tmp_path: Path, heights: object) -> None:
    for days in (0.5, 1.0):
        Simulation(small_mesh, Listed(heights=heights), tmp_path, time_step=HOUR, resume=True).run(
            until=days, progress=False
        )
    record = json.loads((tmp_path / "run.json").read_text())
    assert record["parameters"]["heights"] == [1.0, 3.0]
    assert record["day_reached"] == 1.0
    with pytest.raises(
        InputError, match=r"holds a run with heights = \[1.0, 3(.0)?\], not \[1.0, 4.0\]; give the same"
    ):
        Simulation(small_mesh, Listed(heights=(1.0, 4.0)), tmp_path, time_step=HOUR, resume=True)


def test_a_tuple_is_the_list_that_the_record_has() -> None:
    assert with_parameters(Listed(), {"heights": [1.0, 2.0]}) == Listed()


def test_parameters_that_cannot_be_recorded_are_named(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"^the parameters of listed cannot be recorded .*; give numbers, words, or lists"
    ):
        Simulation(small_mesh, Listed(heights=({1j},)), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_mesh_of_another_radius_is_refused(small_mesh: VoronoiMesh) -> None:
    words = r"^the mesh has a radius of 1 m, but williamson2 one of 6371220 m; scale .*, mesh.scaled\(6371220\)$"
    with pytest.raises(InputError, match=words):
        Williamson2().state_on(small_mesh)
    state = Williamson2().initial_state(small_mesh.scaled(6371220.0 * (1.0 + 1e-12)))
    assert 30.0 < np.abs(state.normal_velocity).max() < 39.0


@pytest.mark.parametrize("value", ["0", "-1", "1e295", "1e-300"])
@pytest.mark.parametrize("name", list(CASES))
def test_extreme_parameters_run_or_are_refused_in_a_sentence(small_mesh: VoronoiMesh, name: str, value: str) -> None:
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for parameter in find_case(name).parameters():
            with contextlib.suppress(InputError, RunError):
                simulation = Simulation(small_mesh, find_case(name, {parameter: value}))
                simulation.run(0.01, progress=False)
                assert np.isfinite(list(vars(simulation.invariants).values())).all()


def test_integrals_beyond_the_numbers_are_refused(small_mesh: VoronoiMesh) -> None:
    words = "^the initial .* is inf, beyond the range of numbers; correct the parameters of williamson2$"
    with np.errstate(all="ignore"), pytest.raises(InputError, match=words):
        Simulation(small_mesh, Williamson2(reference_depth=1e295), time_step=1.0)


def test_the_error_of_earlier_versions_is_the_same() -> None:
    from swe.errors import InputError, SetupError

    assert SetupError is InputError


def test_defaults_are_those_of_simulations_and_of_the_page() -> None:
    options = vars(Options())
    parameters = inspect.signature(Simulation).parameters
    assert options == {name: parameters[name].default for name in options}
    assert (options["sampling"], options["integrator"]) == ("point", "rk4")
    assert (options["anticipation"], options["dissipation"], options["time_step"]) == (0.0, 0.0, None)

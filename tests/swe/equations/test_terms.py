"""Terms of the user's own: what they add, what the budgets say of them, and how they are refused."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from cases import LakeAtRest, Williamson1, Williamson2
from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.discrete.operators import normal_component
from swe import Forcing, InputError, Simulation, State
from swe.diagnostics.budgets import RATES, measure_rates, rate_name
from swe.output.files import read_series
from tests.swe.random_model import derivatives_along, random_model

STRESS = 1e-4


def wind(mesh: VoronoiMesh, state: State, time: float) -> Array:
    """Westerlies that push a layer the more, the thinner it is."""
    depth = state.thickness[mesh.cells_on_edge].mean(axis=1)
    return normal_component(mesh, STRESS * np.cos(mesh.lat_edge), np.zeros(mesh.n_edges)) / depth


@dataclass(frozen=True, repr=False)
class WindyLake(LakeAtRest):
    """A lake that the wind sets in motion."""

    name: ClassVar[str] = "windy-lake"

    def terms(self) -> tuple[Forcing, ...]:
        return (Forcing("wind", wind), Forcing("rain", source=lambda mesh, state, time: 1e-6))


def test_a_tendency_is_the_bracket_and_its_terms(icosahedral_mesh: VoronoiMesh) -> None:
    forcings = Forcing("wind", wind), Forcing("rain", source=lambda mesh, state, time: 1e-6 * time)
    (plain, state), (forced, _) = (
        random_model(icosahedral_mesh, seed=2),
        random_model(icosahedral_mesh, *forcings, seed=2),
    )
    without, found = state.empty_like(), state.empty_like()
    plain.tendency(state, without)
    forced.tendency(state, found, 50.0)
    np.testing.assert_array_equal(found.normal_velocity, without.normal_velocity + wind(forced.mesh, state, 50.0))
    np.testing.assert_array_equal(found.thickness, without.thickness + 1e-6 * 50.0)


def test_budgets_of_forcings_add_up(any_mesh: VoronoiMesh) -> None:
    """With the other causes they make the derivatives of the integrals, and leave those causes what they were."""
    random = np.random.default_rng(6)
    push, pour = random.normal(size=any_mesh.n_edges) * 1e-3, random.normal(size=any_mesh.n_cells) * 1e-3
    forcing = Forcing("both", lambda mesh, state, time: push, lambda mesh, state, time: pour)
    (plain, state), (forced, _) = random_model(any_mesh, seed=2), random_model(any_mesh, forcing, seed=2)
    slope, without = state.empty_like(), state.empty_like()
    forced.tendency(state, slope)
    plain.tendency(state, without)
    rates = measure_rates(forced, state, forced.diagnose(state), slope)
    others = measure_rates(plain, state, plain.diagnose(state), without)

    derivatives = derivatives_along(forced, state, slope)
    for integral, (_, causes) in RATES.items():
        derivative, noise = derivatives[integral]
        own = rates[rate_name(integral, "both")]
        assert sum(rates[rate_name(integral, cause)] for cause in causes) + own == pytest.approx(
            derivative, rel=1e-5, abs=2.0 * noise
        ), integral
        assert own != 0.0
    scale = abs(rates["total_energy_rate_both"])
    for cause in ("coriolis", "exchange"):
        assert abs(rates[f"total_energy_rate_{cause}"] - others[f"total_energy_rate_{cause}"]) < 1e-9 * scale
    assert rates["potential_enstrophy_rate_coriolis"] == pytest.approx(
        others["potential_enstrophy_rate_coriolis"], rel=1e-6
    )


def test_a_case_with_terms_runs_with_their_budgets(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = Simulation(small_mesh, WindyLake(), tmp_path, time_step=900.0, diagnostics_interval=900.0)
    assert simulation.loops == "fused"
    simulation.run(days=0.25, progress=False)
    series = read_series(tmp_path / "diagnostics.nc")
    assert np.all(series["total_energy_rate_wind"][1:] > 0.0)
    np.testing.assert_allclose(series["mass_rate_rain"], 1e-6 * simulation.model.area, rtol=1e-14)
    # What the causes do, summed over time by the trapezoidal rule, is what changed.
    causes = sum(series[f"total_energy_rate_{name}"] for name in ("wind", "rain", "coriolis", "exchange"))
    done = 900.0 * (causes.sum() - 0.5 * (causes[0] + causes[-1]))
    assert series["total_energy"][-1] - series["total_energy"][0] == pytest.approx(done, rel=1e-4)
    assert series["mass"][-1] - series["mass"][0] == pytest.approx(1e-6 * simulation.model.area * 21600.0, rel=1e-9)
    assert "mass_rate_wind" not in series


def test_times_of_the_stages(small_mesh: VoronoiMesh) -> None:
    """A source that is a polynomial of time is integrated exactly, as the stages are at their times."""

    @dataclass(frozen=True, repr=False)
    class Filling(LakeAtRest):
        name: ClassVar[str] = "filling"

        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("tide", source=lambda mesh, state, time: 1e-9 * time**2),)

    simulation = Simulation(small_mesh, Filling(mountain_height=0.0), time_step=1800.0)
    before = simulation.state.thickness.copy()
    simulation.run(days=0.25, progress=False)
    simulation.run(days=0.25, progress=False)
    risen = simulation.state.thickness - before
    np.testing.assert_allclose(risen, 1e-9 * 43200.0**3 / 3.0, rtol=1e-9)


def test_a_resumed_run_asks_for_the_same_forcing(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    Simulation(small_mesh, WindyLake(), tmp_path).run(days=0.25, progress=False)
    Simulation(small_mesh, WindyLake(), tmp_path, resume=True).run(until=0.5, progress=False)

    @dataclass(frozen=True, repr=False)
    class Calm(WindyLake):
        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("wind", lambda mesh, state, time: 0.0), Forcing("rain", source=lambda *now: 1e-6))

    with pytest.raises(InputError, match="another start, topography, rotation or forcing"):
        Simulation(small_mesh, Calm(), tmp_path, resume=True)

    @dataclass(frozen=True, repr=False)
    class Dry(WindyLake):
        def terms(self) -> tuple[Forcing, ...]:
            return ()

    with pytest.raises(InputError, match=r"holds a run .*; give the same options, or another directory"):
        Simulation(small_mesh, Dry(), tmp_path, resume=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("wind",), "the term wind does nothing; give it a function, acceleration= or source="),
        (("wind stress", wind), "the name of a term is 'wind stress'; it must be made of letters, digits and"),
        ((3, wind), "the name of a term is 3;"),
        (("coriolis", wind), "a term cannot be named 'coriolis', which every budget uses already; choose another name"),
    ],
)
def test_terms_that_are_refused(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Forcing(*arguments)  # type: ignore[arg-type]


def test_forcings_that_fail_are_named(icosahedral_mesh: VoronoiMesh) -> None:
    def fail(mesh: VoronoiMesh, state: State, time: float) -> Array:
        raise ZeroDivisionError("no wind")

    for forcing, message in (
        (Forcing("wind", fail), r"the acceleration of the term wind failed at 7 s: ZeroDivisionError\('no wind'\)"),
        (
            Forcing("wind", lambda mesh, state, time: np.zeros(3)),
            r"the acceleration of the term wind has shape \(3,\); the mesh needs \(1920,\), or one number",
        ),
        (
            Forcing("rain", source=lambda mesh, state, time: np.zeros(mesh.n_edges)),
            r"the source of the term rain has shape \(1920,\); the mesh needs \(642,\), or one number",
        ),
    ):
        model, state = random_model(icosahedral_mesh, forcing, seed=2)
        with pytest.raises(InputError, match=message):
            model.tendency(state, state.empty_like(), 7.0)
    with pytest.raises(InputError, match="2 terms of the model are named wind; give each its own name"):
        random_model(icosahedral_mesh, Forcing("wind", wind), Forcing("wind", wind), seed=2)


def test_cases_whose_terms_do_not_fit(small_mesh: VoronoiMesh) -> None:
    for relaxed, plain in (("rrk4", "rk4"), ("rfbrk3", "fbrk3")):
        words = rf"^{relaxed} keeps total energy, which the term wind changes; take the integrator {plain}$"
        with pytest.raises(InputError, match=words):
            Simulation(small_mesh, WindyLake(), integrator=relaxed)

    @dataclass(frozen=True, repr=False)
    class Blown(Williamson1):
        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("wind", wind),)

    with pytest.raises(InputError, match="the wind is prescribed, but the term wind accelerates it; leave it out"):
        Simulation(small_mesh, Blown())

    @dataclass(frozen=True, repr=False)
    class Wrong(Williamson2):
        def terms(self) -> object:
            return wind

    with pytest.raises(InputError, match=r"terms of williamson2 gives .*; it must give a tuple of swe.Forcing"):
        Simulation(small_mesh, Wrong())


def test_a_prescribed_wind_may_have_a_source(small_mesh: VoronoiMesh) -> None:
    @dataclass(frozen=True, repr=False)
    class Raining(Williamson1):
        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("rain", source=lambda mesh, state, time: 1e-4),)

    simulation = Simulation(small_mesh, Raining())
    mass, wind_before = simulation.invariants.mass, simulation.state.normal_velocity.copy()
    simulation.run(days=0.25, progress=False)
    assert simulation.invariants.mass - mass == pytest.approx(1e-4 * 21600.0 * simulation.model.area, rel=1e-9)
    np.testing.assert_array_equal(simulation.state.normal_velocity, wind_before)

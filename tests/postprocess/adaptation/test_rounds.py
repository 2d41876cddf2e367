"""Rounds of adaptation: what they make, that they go on, and what their report says."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest
from matplotlib.colors import LogNorm, Normalize

from cases import Galewsky
from mesh import VoronoiMesh
from mesh.parts.cutting import without_cells
from postprocess.adaptation.adapt_report import _positive, _view, verdict, write_adaptation
from postprocess.adaptation.energy_density import FLOOR, POWER, SMOOTHING, asked_spacing, smoothed, time_mean
from postprocess.adaptation.errors import EQUAL_COST, FINE, UNIFORM, comparisons, sampling_row
from postprocess.adaptation.rounds import Adaptation, Plan, adapt, cells_of_equal_cost
from swe.configuration import Options
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError
from tests.conftest import stretched_mesh

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    folder = tmp_path_factory.mktemp("adapt")
    return Plan(folder, Galewsky(), 162, 642, 0.5, 2, density_floor=FLOOR, density_power=POWER)


@pytest.fixture(scope="module")
def made(plan: Plan) -> Adaptation:
    return adapt(plan, False, lambda line: None)


def test_each_round_goes_on_from_the_last(plan: Plan, made: Adaptation) -> None:
    assert [each.first_day for each in made.rounds] == [0.0, 0.5, 1.0]
    assert made.fine.days[-1] == made.uniform.days[-1] == 1.5
    masses = [each.run.series["mass"] for each in made.rounds]
    for before, after in pairwise(masses):
        assert after[0] == pytest.approx(before[-1], rel=1e-14)
    speeds = [each.run.series["max_speed"] for each in made.rounds]
    assert speeds[1][0] == pytest.approx(speeds[0][-1], rel=0.3)


def test_meshes_are_fine_where_the_energy_is(made: Adaptation) -> None:
    before, after = made.rounds[0].run, made.rounds[1].run
    energy = time_mean(before, "kinetic_energy")
    fastest = np.argmax(energy)
    near = np.argmin((after.mesh.lat_cell - before.mesh.lat_cell[fastest]) ** 2)
    far = np.argmin(after.mesh.lat_cell)
    assert after.mesh.area_cell[far] > 4.0 * after.mesh.area_cell[near]


def test_the_field_of_the_density_is_the_mean_over_its_largest_value(plan: Plan, made: Adaptation) -> None:
    energy = time_mean(made.rounds[0].run, "kinetic_energy")
    spread = smoothed(made.rounds[0].run.mesh, energy, SMOOTHING)
    with netCDF4.Dataset(plan.folder / "energy-1.nc") as file:
        np.testing.assert_array_equal(file["kinetic_energy"][:], spread / spread.max())
    run = made.rounds[0].run
    last = [run.snapshot(day).fields["kinetic_energy"] for day in run.days if day >= 0.25 - 1e-9]
    assert len(last) == 11
    np.testing.assert_array_equal(energy, sum(last) / 11)


def test_a_second_call_makes_nothing_new(plan: Plan, made: Adaptation) -> None:
    told: list[str] = []
    stamps = {path: path.stat().st_mtime_ns for path in plan.folder.rglob("*.nc")}
    adapt(plan, False, told.append)
    assert told == []
    assert stamps == {path: path.stat().st_mtime_ns for path in plan.folder.rglob("*.nc")}


def test_another_plan_wants_another_folder(plan: Plan, made: Adaptation) -> None:
    with pytest.raises(InputError, match="choose another folder"):
        adapt(replace(plan, days=0.25), False, lambda line: None)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"rounds": 0}, "0 times"),
        ({"fine": 162}, "finer"),
        ({"days": 0.0}, "0 days"),
        ({"density_floor": 0.0}, "floor 0 and"),
        ({"density_power": float("nan")}, "power nan"),
    ],
)
def test_plans_that_cannot_be(plan: Plan, changed: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(plan, **changed)  # type: ignore[arg-type]


def test_errors_are_those_against_the_fine_run_on_the_same_days(plan: Plan, made: Adaptation) -> None:
    rows = {each.row["name"]: each.row for each in comparisons(plan, made)}
    assert list(rows) == ["round 0", "round 1", "round 2", UNIFORM, EQUAL_COST]
    assert rows["round 1"]["largest_km"] > 2.0 * rows["round 1"]["smallest_km"]
    assert rows["round 2"]["off_the_law"] < 0.1
    # The fine run itself has no error but that of taking means.
    itself = comparisons(plan, replace(made, uniform=made.fine))[-2]
    assert itself.row["surface_end_m"] < 1e-9
    assert itself.row["energy_mean_l2"] < 1e-12
    assert np.abs(itself.surface).max() < 1e-9
    assert rows[UNIFORM]["surface_end_m"] > 1.0


def test_a_uniform_mesh_of_equal_cost_stands_beside(plan: Plan, made: Adaptation) -> None:
    rows = {each.row["name"]: each.row for each in comparisons(plan, made)}
    assert rows[EQUAL_COST]["cells"] == cells_of_equal_cost(made.uniform, made.rounds[-1].run)
    # Steps of so short a round divide its snapshots coarsely.
    assert rows[EQUAL_COST]["cell_steps"] == pytest.approx(rows["round 2"]["cell_steps"], rel=0.3)


def test_the_cost_goes_like_the_cells_to_the_power_of_three_halves(made: Adaptation) -> None:
    days = float(made.uniform.days[-1])
    dearer = SimpleNamespace(steps=made.uniform.steps * 8, cells=made.uniform.cells, days=[0.0, days])
    assert cells_of_equal_cost(made.uniform, dearer) == 4 * made.uniform.cells  # type: ignore[arg-type]


def test_sampling_is_the_difference_of_halves_of_the_averaged_days(plan: Plan, made: Adaptation) -> None:
    fine, area = made.fine, made.fine.mesh.area_cell

    def distance(one: np.ndarray, other: np.ndarray) -> float:
        return float(np.sqrt(np.sum(area * (one - other) ** 2) / area.sum()))

    halves = time_mean(fine, "thickness", 1.25, 1.375), time_mean(fine, "thickness", 1.375, 1.5)
    row = sampling_row(plan, made)
    assert row["name"] == FINE
    assert row["surface_mean_m"] == pytest.approx(distance(*halves) / np.sqrt(2.0))
    ends = (fine.snapshot(day).fields["thickness"] for day in (1.5, 1.375))
    assert row["surface_end_m"] == pytest.approx(distance(*ends))


def test_steps_of_long_rounds_are_not_cut_to_rows_of_diagnostics(plan: Plan) -> None:
    assert plan.diagnostics_interval == Options.diagnostics_interval
    assert replace(plan, days=720.0).diagnostics_interval == 3.6 * SECONDS_PER_DAY


def test_spacings_vary_less_by_default(plan: Plan, tmp_path: Path) -> None:
    mild = Plan(tmp_path, Galewsky(), 162, 642, 0.5, 2)
    energies = np.array([0.0, 0.5, 1.0])

    def ratio(asked: Plan) -> float:
        spacing = asked_spacing(np.maximum(asked.density_floor, energies) ** asked.density_power, np.ones(3))
        return float(spacing.max() / spacing.min())

    assert ratio(plan) == pytest.approx(10.0)
    assert ratio(mild) == pytest.approx(2.37, abs=0.01)


def test_colours_follow_the_logarithm_where_values_span_a_power_of_ten() -> None:
    near, far = np.array([70.0, 190.0]), np.array([0.01, 190.0])
    assert type(_positive([near])) is Normalize
    norm = _positive([near, far])
    assert isinstance(norm, LogNorm)
    assert (norm.vmin, norm.vmax) == (pytest.approx(0.19), 190.0)


def test_maps_of_a_sea_show_its_middle_wherever_cells_are_fine() -> None:
    mesh = stretched_mesh(642)
    assert _view(mesh) == {}
    middle = np.array([0.0, 0.8, 0.6])
    sea = without_cells(mesh, mesh.cell_points @ middle < 0.5)
    view = _view(sea)
    assert view["centre"] == pytest.approx((90.0, np.degrees(np.arcsin(0.6))), abs=2.0)
    assert view["extent"] == pytest.approx(2.1 * 60.0, abs=6.0)


@pytest.mark.slow
def test_the_report(plan: Plan, made: Adaptation) -> None:
    page = write_adaptation(plan, made, ["trisk", "adapt"]).read_text()
    assert "round 2" in page
    assert "At equal cost it is better in" in page


def test_the_verdict_is_computed() -> None:
    def row(name: str, cost: float, error: float) -> dict[str, float | str]:
        errors = dict.fromkeys(("surface_end_m", "surface_mean_m", "energy_mean_l2"), error)
        return {"name": name, "cells": 300, "cell_steps": cost, **errors}

    rounds = [row("round 0", 2.0, 1.0), row("round 1", 3.0, 0.25)]
    rows = [*rounds, row(UNIFORM, 2.0, 1.0), row(EQUAL_COST, 3.0, 0.2)]
    text = verdict(rows, row(FINE, 9.0, 0.01), begin_again=False)
    assert "costs 1.50 times" in text
    assert "1.00 times as much as the uniform one of 300 cells" in text
    assert "is 0.25, 0.25 times that of as many uniform cells (smaller; times the cost, 0.38)" in text
    assert "1.25 times that of equal cost (larger)" in text
    assert text.endswith("At equal cost it is better in 0 of 3 measures.")
    again = verdict([*rounds, row(EQUAL_COST, 3.0, 0.5)], row(FINE, 9.0, 0.01), begin_again=True)
    assert "(smaller; times the cost, 0.38)" in again
    assert again.endswith("better in 3 of 3 measures.")
    assert "0.50 times that of equal cost (no more than sampling apart)" in verdict(
        [*rounds, row(EQUAL_COST, 3.0, 0.5)], row(FINE, 9.0, 0.3), begin_again=True
    )


def test_spacings_asked_for_fill_the_area() -> None:
    area = np.array([1.0, 2.0, 3.0])
    asked = asked_spacing(np.array([1.0, 1.0, 16.0]), area)
    np.testing.assert_allclose(asked / asked[0], [1.0, 1.0, 0.5])
    assert np.sum(np.sqrt(3.0) / 2.0 * asked**2) == pytest.approx(6.0)


def test_smoothing_is_the_mean_with_those_neighbours_that_are_there(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = without_cells(icosahedral_mesh, icosahedral_mesh.z_cell < 0.0)
    values = np.zeros(mesh.n_cells)
    coastal = int(np.flatnonzero((mesh.on_ring & (mesh.cells_on_cell < 0)).any(axis=1))[0])
    values[coastal] = 1.0
    once = smoothed(mesh, values, 1)
    neighbours = mesh.cells_on_cell[coastal, : mesh.n_edges_on_cell[coastal]]
    assert once[coastal] == pytest.approx(1.0 / (1 + np.count_nonzero(neighbours >= 0)))
    np.testing.assert_array_equal(np.sort(np.flatnonzero(once)), np.sort([coastal, *neighbours[neighbours >= 0]]))
    np.testing.assert_allclose(smoothed(mesh, np.full(mesh.n_cells, 2.0), 20), 2.0)

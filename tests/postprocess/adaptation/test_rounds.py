"""Rounds of adaptation: what they make, that they go on, and what their report says."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from cases import Galewsky
from mesh import VoronoiMesh
from mesh.parts.cutting import without_cells
from postprocess.adaptation.adapt_report import verdict, write_adaptation
from postprocess.adaptation.energy_density import SMOOTHING, asked_spacing, smoothed, time_mean
from postprocess.adaptation.errors import rows_of
from postprocess.adaptation.rounds import Adaptation, Plan, adapt
from swe.errors import InputError


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return Plan(tmp_path_factory.mktemp("adapt"), Galewsky(), 162, 642, 0.5, 2)


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
    [({"rounds": 0}, "0 times"), ({"fine": 162}, "finer"), ({"days": 0.0}, "0 days")],
)
def test_plans_that_cannot_be(plan: Plan, changed: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(plan, **changed)  # type: ignore[arg-type]


def test_rows_compare_with_the_fine_run_on_the_same_days(plan: Plan, made: Adaptation) -> None:
    rows = {row["name"]: row for row in rows_of(plan, made)}
    assert list(rows) == ["round 0", "round 1", "round 2", "uniform"]
    assert rows["round 1"]["largest_km"] > 2.0 * rows["round 1"]["smallest_km"]
    assert rows["round 2"]["off_the_law"] < 0.1
    # The fine run itself has no error but that of taking means.
    itself = rows_of(plan, replace(made, uniform=made.fine))[-1]
    assert itself["surface_end_m"] < 1e-9
    assert itself["energy_mean_l2"] < 1e-12
    assert rows["uniform"]["surface_end_m"] > 1.0


def test_the_report(plan: Plan, made: Adaptation) -> None:
    page = write_adaptation(plan, made, ["trisk", "adapt"]).read_text()
    assert "round 2" in page
    assert {path.name for path in Path(plan.folder / "figures").iterdir()} == {
        "spacing.png",
        "kinetic_energy.png",
        "law.png",
    }


def test_the_verdict_is_computed() -> None:
    def row(name: str, cost: float, error: float) -> dict[str, float | str]:
        errors = dict.fromkeys(("surface_end_m", "surface_mean_m", "energy_mean_l2"), error)
        return {"name": name, "cell_steps": cost, **errors}

    rows = [row("round 0", 1.0, 1.0), row("round 1", 3.0, 0.25), row("uniform", 2.0, 1.0)]
    text = verdict(rows, begin_again=False)
    assert "costs 1.50 times" in text
    assert "is smaller: 0.25 for 1, 0.25 times; times the cost, 0.38" in text
    assert "is not smaller" in verdict(rows[1:], begin_again=True)


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

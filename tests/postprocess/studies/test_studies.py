import csv
import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from cases import find_case
from cases.williamson import Williamson2
from mesh import VoronoiMesh, mesh_quality, scvt_mesh, write_mesh
from postprocess.reports.study_report import write_mesh_report, write_time_report
from postprocess.studies import mesh_study, time_study
from postprocess.studies.families import FAMILIES, STOPPED_RESIDUALS
from postprocess.studies.mesh_study import Plan
from postprocess.studies.page import write_page
from postprocess.studies.study_figures import conservation_figure, error_figure, quality_figure, truncation_figure
from postprocess.studies.study_folder import TABLE_FILE, StudyRow, Task, fitted_order
from postprocess.studies.study_maps import draw_closeup
from postprocess.studies.time_study import TimePlan
from swe.errors import InputError


def silent(line: str) -> None:
    pass


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    folder = tmp_path_factory.mktemp("study")
    return Plan(folder, find_case("williamson2"), 1.0, 0.5, ("bisection", "scvt"), (162, 642))


@pytest.fixture(scope="module")
def study(plan: Plan) -> tuple[list[mesh_study.Member], list[StudyRow]]:
    return mesh_study.carry_out(plan, False, silent)


@pytest.mark.parametrize("family", FAMILIES)
def test_families_are_what_they_are_called(family: str) -> None:
    mesh = FAMILIES[family].make(642)
    quality = mesh_quality(mesh)
    assert mesh.n_cells == 642 or (family == "nested" and 162 < mesh.n_cells < 642)
    if family == "bisection":
        assert quality.residual > max(STOPPED_RESIDUALS)
    elif family.startswith("stopped"):
        residual = float(family.removeprefix("stopped-"))
        assert 0.7 * residual < quality.residual < residual
    elif family != "nested":  # whose fixed generators are no centroids
        assert quality.residual < 1e-6
    wide = mesh.area_cell.max() > 4.0 * mesh.area_cell.min()
    assert wide == (family in ("refined-circle", "nested"))


def test_table_holds_quality_errors_and_conservation(plan: Plan, study: tuple) -> None:
    with (plan.folder / TABLE_FILE).open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["family"], row["cells"]) for row in rows] == [
        ("bisection", "162"),
        ("scvt", "162"),
        ("bisection", "642"),
        ("scvt", "642"),
    ]
    for row in rows:
        assert row["reference"] == "exact solution"
        assert float(row["error_day"]) == 0.5
        assert float(row["mass_change"]) < 1e-14
        assert 0.0 < float(row["truncation_perp_linf"]) < 1.0
        assert row["failure"] == ""
    errors = [float(row["thickness_l2"]) for row in rows]
    assert errors[3] < 0.5 * errors[2], "an SCVT is better than a bisected icosahedron"
    assert errors[3] < 0.35 * errors[1], "second order"


def test_worst_cell_is_where_the_error_is_largest(study: tuple) -> None:
    member, row = study[0][0], study[1][2]
    error = mesh_study.thickness_error(member, 0.5)
    depth = member.comparison.solution.thickness(member.mesh.lon_cell, member.mesh.lat_cell, 0.5)
    worst = int(np.argmax(np.abs(error)))
    assert abs(error[worst]) / depth.max() == pytest.approx(row["thickness_linf"], rel=1e-12)
    assert row["worst_latitude"] == pytest.approx(np.degrees(member.mesh.lat_cell[worst]))


def test_a_finished_study_is_not_run_again(plan: Plan, study: tuple) -> None:
    directory = plan.folder / "runs" / "scvt-642"
    before = os.stat(directory / "history.nc").st_mtime_ns
    lines: list[str] = []
    members, rows = mesh_study.carry_out(plan, False, lines.append)
    assert lines == []
    assert rows == study[1]
    assert os.stat(directory / "history.nc").st_mtime_ns == before
    task = Task(directory, plan.case, members[1].mesh, plan.days, plan.error_day)
    assert task.finished_run() is not None
    for change in (
        {"days": 2.0},
        {"snapshot_days": 1.0},
        {"time_step": 1.0},
        {"case": Williamson2(angle=0.1)},
        {"mesh": members[0].mesh},
        {"directory": plan.folder},
    ):
        assert dataclasses.replace(task, **change).finished_run() is None, change


@pytest.mark.slow
def test_report_holds_everything(plan: Plan, study: tuple) -> None:
    page = write_mesh_report(plan, *study, ["trisk", "study", "mesh"]).read_text()
    assert page.count('<img src="data:image/png;base64,') == 6
    assert 'src="http' not in page
    for words in ("Fitted orders", "Truncation errors", "trisk study mesh", "exact solution", "bisection"):
        assert words in page
    pictures = list((plan.folder / "figures").glob("*.png"))
    assert len(pictures) == 6
    for path in pictures:
        assert imread(path).std() > 0.05, f"{path} is blank"


def test_a_page_is_written_over_the_one_before(tmp_path: Path) -> None:
    for text in ("first", "second"):
        page = write_page(tmp_path, "Title", text, ["trisk"], {}, {"chart": Figure()})
        assert f"<p>{text}</p>" in page.read_text()
    assert [path.name for path in (tmp_path / "figures").iterdir()] == ["chart.png"]


def test_charts_say_what_they_show(study: tuple) -> None:
    members, rows = study
    conservation = conservation_figure(members, "Heading")
    assert [axes.get_title() for axes in conservation.axes] == [
        "|mass change|",
        "|absolute vorticity change|",
        "|total energy change of total|",
        "|potential enstrophy change|",
    ]
    assert {(axes.get_xlabel(), axes.get_ylabel()) for axes in conservation.axes} == {("day", "relative change")}
    errors = error_figure(rows, "Heading")
    assert [axes.get_title() for axes in errors.axes] == [
        "relative error of thickness, l2",
        "relative error of thickness, l∞",
        "relative error of normal velocity, l2",
        "relative error of vorticity, l2",
    ]
    assert {axes.get_xlabel() for axes in errors.axes} == {"mean distance between cells (km)"}
    assert conservation.get_suptitle() == errors.get_suptitle() == "Heading"


def test_charts_of_meshes_show_the_rows_of_the_table(study: tuple) -> None:
    rows = study[1]
    truncation = truncation_figure(rows, "Heading")
    names = ("gradient", "divergence", "curl", "perp", "kinetic energy")
    titles = [f"{name}, {norm}" for name in names for norm in ("l2", "l∞")]
    assert [axes.get_title() for axes in truncation.axes] == titles
    bisection, scvt, *slopes = truncation.axes[2].get_lines()
    for line, ours in ((bisection, rows[0::2]), (scvt, rows[1::2])):
        np.testing.assert_array_equal(line.get_xdata(), [row["spacing_km"] for row in ours])
        np.testing.assert_array_equal(line.get_ydata(), [row["truncation_divergence_l2"] for row in ours])
    for order, line in enumerate(slopes, 1):
        x, y = line.get_xdata(), line.get_ydata()
        assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(order)
    quality = quality_figure(rows, "Heading")
    assert {axes.get_ylabel() for axes in quality.axes} == {"relative l2 error of thickness"}
    assert [axes.get_xlabel()[:5] for axes in quality.axes[:3]] == ["σ avg", "q min", "dista"]
    places = quality.axes[0].collections[1].get_offsets()
    np.testing.assert_array_equal(places, [[row["sigma_avg"], row["thickness_l2"]] for row in rows[1::2]])


def test_closeups_reach_six_cells_from_the_worst(study: tuple) -> None:
    member = study[0][1]
    axes = draw_closeup(Figure().subplots(), member, 0.5, member.family)
    worst = int(np.argmax(np.abs(mesh_study.thickness_error(member, 0.5))))
    reach = 6.0 * np.sqrt(member.mesh.area_cell[worst]) / member.mesh.sphere_radius
    assert axes.get_xlim() == axes.get_ylim() == pytest.approx((-reach, reach))
    longitude, latitude = np.degrees((member.mesh.lon_cell[worst], member.mesh.lat_cell[worst]))
    assert axes.get_title() == f"scvt\n{longitude:.1f}°E {abs(latitude):.1f}°{'N' if latitude > 0.0 else 'S'}"


def test_a_run_that_fails_is_a_line_of_the_table(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Courant number 5: the run blows up, the study goes on and says so."""
    monkeypatch.setattr("swe.integrators.DEFAULT_COURANT_NUMBER", 5.0)
    small = dataclasses.replace(plan, folder=tmp_path, families=("scvt",), cells=(162,), days=20.0, error_day=20.0)
    lines: list[str] = []
    members, rows = mesh_study.carry_out(small, False, lines.append)
    assert "thickness" in rows[0]["failure"] or "velocity" in rows[0]["failure"]
    assert rows[0]["failure"] in lines[-1]
    assert members[0].run is None
    page = write_mesh_report(small, members, rows, ["trisk"]).read_text()
    assert page.count("<img") == 1


@pytest.mark.slow
def test_fluid_at_rest_has_no_errors_to_draw(tmp_path: Path) -> None:
    plan = Plan(tmp_path, find_case("lake-at-rest"), 0.25, 0.25, ("scvt",), (162, 642))
    members, rows = mesh_study.carry_out(plan, False, silent)
    assert rows[1]["thickness_linf"] < 1e-15
    assert write_mesh_report(plan, members, rows, ["trisk"]).read_text().count("<img") == 6


def test_a_mesh_made_otherwise_and_a_damaged_run_are_made_again(plan: Plan, tmp_path: Path) -> None:
    small = dataclasses.replace(plan, folder=tmp_path, families=("scvt",), cells=(162, 162))
    _, rows = mesh_study.carry_out(small, False, silent)
    assert len(rows) == 1
    directory, lines = tmp_path / "runs" / "scvt-162", []
    (directory / "history.nc").write_bytes(b"damaged")
    mesh_study.carry_out(small, False, lines.append)
    assert len(lines) == 1
    for record in ("[]", "no JSON", ""):
        (directory / "run.json").write_text(record)
        task = Task(directory, plan.case, scvt_mesh(162), plan.days, plan.error_day)
        assert task.finished_run() is None
    write_mesh(scvt_mesh(42), tmp_path / "meshes" / "scvt-162.nc", "some other mesh")
    assert mesh_study.carry_out(small, False, silent)[1][0]["cells"] == 162


@pytest.mark.slow
def test_without_a_solution_there_is_conservation(plan: Plan, tmp_path: Path) -> None:
    case = dataclasses.replace(find_case("williamson5"), mountain_height=1000.0)
    small = dataclasses.replace(plan, folder=tmp_path, case=case, families=("scvt",), cells=(162,))
    lines: list[str] = []
    members, rows = mesh_study.carry_out(small, False, lines.append)
    assert "no errors: there is nothing to compare" in lines[-1]
    assert "thickness_l2" not in rows[0]
    assert rows[0]["mass_change"] < 1e-14
    assert write_mesh_report(small, members, rows, ["trisk"]).read_text().count("<img") == 2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"families": ("hexagons",)}, "no family of meshes named 'hexagons'; choose among bisection"),
        ({"cells": (1000,)}, "1000 cells are no bisected icosahedron"),
        ({"cells": (42,)}, "42 cells are no bisected icosahedron of a suitable size"),
        ({"error_day": 2.0}, "cannot be taken on day 2 of a run of 1 days"),
        ({"error_day": 0.0}, "cannot be taken on day 0 of a run"),
    ],
)
def test_plans_that_are_refused(plan: Plan, change: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        dataclasses.replace(plan, **change)


def test_time_steps_show_the_orders_of_runge_kutta(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Fourth order of the solution, fifth of the energy drift, Runge-Kutta's dissipation."""
    mesh = scvt_mesh(162)
    plan = TimePlan(tmp_path, find_case("williamson5"), mesh, 1.0, (3600.0, 1800.0, 900.0, 300.0))
    rows = time_study.carry_out(plan, False, silent)
    orders = time_study.orders(rows)
    assert orders["thickness_difference_l2"] == pytest.approx(4.0, abs=0.4)
    assert orders["velocity_difference_l2"] == pytest.approx(4.0, abs=0.4)
    assert orders["total_energy_change_of_total"] == pytest.approx(5.0, abs=0.5)
    assert [row["time_step_s"] for row in rows] == [300.0, 900.0, 1800.0, 3600.0]
    assert write_time_report(plan, rows, ["trisk"]).read_text().count("<img") == 1
    with pytest.raises(InputError, match="a study of time steps needs at least two of them; give --dt more than once"):
        dataclasses.replace(plan, time_steps=(900.0, 900.0))


def test_fitted_order() -> None:
    size = np.array([1.0, 2.0, 4.0])
    assert fitted_order(size, 3.0 * size**1.7) == pytest.approx(1.7)
    assert fitted_order([1.0, 2.0, 4.0], [0.0, 1.0, 2.0]) == pytest.approx(1.0)
    assert np.isnan(fitted_order([1.0], [2.0]))

"""Studies of meshes on planes: which hexagons they take, their order, and their report."""

from pathlib import Path

import numpy as np
import pytest

from cases import find_case
from mesh import mesh_quality
from postprocess.reports.mesh_verdict import mesh_verdict
from postprocess.reports.study_report import write_mesh_report
from postprocess.studies import mesh_study
from postprocess.studies.mesh_study import Member, Plan
from postprocess.studies.plane_families import StudyPlane, plane_of_study
from postprocess.studies.study_folder import StudyRow
from swe.errors import InputError
from tests.postprocess.conftest import LENGTHS

WAVE = find_case("inertia-gravity-wave")


@pytest.mark.parametrize(
    ("plane", "asked", "cells"),
    [
        (StudyPlane(LENGTHS), 150, 144),
        (StudyPlane(LENGTHS), 576, 576),
        (StudyPlane((1e6, 1e6 * 1.2 * np.sqrt(0.75))), 480, 480),
        (StudyPlane((1e6, 1e6 * 1.1 * np.sqrt(0.75)), "x"), 110, 110),
    ],
)
def test_hexagons_are_those_that_fit_and_are_nearest(plane: StudyPlane, asked: int, cells: int) -> None:
    mesh = plane.families["hexagons"].make(asked)
    assert mesh.n_cells == cells
    assert (mesh.x_period, mesh.y_period > 0.0) == (pytest.approx(plane.lengths[0]), plane.periodic == "xy")


@pytest.mark.parametrize(
    ("plane", "cells", "words"),
    [
        (StudyPlane((1e6, 1e6)), 100, "no regular hexagons, about 100 of them, fit a plane of 1000000 by 1000000 m"),
        (StudyPlane(LENGTHS), 2, "cannot have 2 cells"),
        (StudyPlane((1e6, -1.0)), 100, "give positive, finite ones"),
        (StudyPlane((np.inf, 1.0)), 100, "give positive, finite ones"),
    ],
)
def test_planes_without_hexagons_are_refused(plane: StudyPlane, cells: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        plane.require_cells("hexagons", cells)


@pytest.mark.parametrize("family", ["cvt", "random"])
def test_voronoi_meshes_fit_any_plane(family: str) -> None:
    plane = StudyPlane((1e6, 1e6), "none")
    plane.require_cells(family, 100)
    mesh = plane.families[family].make(100)
    assert mesh.n_cells == 100
    assert mesh.area_cell.sum() == pytest.approx(1e12)
    assert mesh_quality(mesh).residual < 1e-6


def test_cases_tell_their_plane() -> None:
    assert plane_of_study(WAVE, None, None) == StudyPlane((WAVE.x_length, WAVE.y_length), "xy")
    assert plane_of_study(WAVE, (2.0, 3.0), "x") == StudyPlane((2.0, 3.0), "x")
    box = plane_of_study(find_case("munk-box"), None, None)
    assert box is not None
    assert box.periodic == "none"
    assert plane_of_study(find_case("williamson2"), None, None) is None
    with pytest.raises(InputError, match="williamson2 is on a sphere, and --plane"):
        plane_of_study(find_case("williamson2"), LENGTHS, None)


def test_a_study_on_a_plane_finds_the_order(tmp_path: Path) -> None:
    _, _, rows = small_study(tmp_path)
    assert [row["spacing_km"] for row in rows] == pytest.approx([125.0, 62.5])
    assert np.log2(rows[0]["thickness_l2"] / rows[1]["thickness_l2"]) > 1.8
    assert 0.0 <= rows[1]["worst_x_km"] <= 1000.0
    assert not {"worst_longitude", "worst_to_irregular"} & rows[1].keys()
    assert "the second order that theory expects" in " ".join(mesh_verdict(rows, WAVE.convergence_order)["Which order"])


@pytest.mark.slow
def test_the_report_of_a_plane_is_one_of_x_and_y(tmp_path: Path) -> None:
    plan, finest, rows = small_study(tmp_path)
    page = write_mesh_report(plan, finest, rows, ["trisk"]).read_text()
    assert "worst cell: x (km)" in page
    assert "latitude" not in page
    assert len(list((plan.folder / "figures").glob("*.png"))) == 6


def small_study(tmp_path: Path) -> tuple[Plan, list[Member], list[StudyRow]]:
    plan = Plan(tmp_path / "study", WAVE, 0.05, 0.05, ("hexagons",), (64, 256), plane=plane_of_study(WAVE, None, None))
    finest, rows = mesh_study.carry_out(plan, False, lambda line: None)
    return plan, finest, rows


def test_other_families_are_of_the_sphere(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no family of meshes named 'scvt'; choose among hexagons"):
        Plan(tmp_path, WAVE, 0.1, 0.1, ("scvt",), (144,), plane=StudyPlane(LENGTHS))

"""What holds for every case on a plane: it is found by its name, documented, and shows itself in a few lines."""

from pathlib import Path

import numpy as np
import pytest

from cases import PLANE_CASES, find_case
from cases.parameters import units_and_meanings
from mesh import VoronoiMesh, hexagon_mesh
from mesh.integrals.quadrature import cell_means
from mesh.parts.mesh_part import cut_part
from swe import InputError


def test_every_case_is_found_by_its_name() -> None:
    assert set(PLANE_CASES) == {
        "inertia-gravity-wave",
        "manufactured",
        "geostrophic-adjustment",
        "dual-vortex",
        "stommel-box",
        "munk-box",
        "kelvin-channel",
    }


@pytest.mark.parametrize("name", PLANE_CASES)
def test_every_case_is_documented(name: str) -> None:
    page = (Path(__file__).parents[3] / "docs" / "cases.md").read_text()
    case = find_case(name)
    assert type(case) is PLANE_CASES[name]
    assert case.name == name
    assert "doi.org" in case.reference
    assert not {"radius", "rotation_rate"} & set(case.parameters())
    assert all(meaning for _, meaning in units_and_meanings(case).values())
    row = next(line for line in page.splitlines() if line.startswith(f"| `{name}` |"))
    assert f"| {case.recommended_days:g} |" in row
    assert row.split("|")[-2].strip().startswith("yes" if case.has_exact_solution else "no")
    assert f"**`{name}`**" in page
    assert case.convergence_order is None or case.has_exact_solution


@pytest.mark.parametrize("name", PLANE_CASES)
def test_every_case_shows_its_parameters_and_no_sphere(name: str) -> None:
    case = PLANE_CASES[name]()
    assert len(repr(case).splitlines()) <= 13
    assert "sphere" not in repr(case)
    assert repr(case).endswith("gravity: 9.80616 m/s2>")
    for parameter in case.parameters():
        assert parameter.replace("_", " ") in repr(case)


def plane_of(name: str) -> VoronoiMesh:
    """The plane that a case asks for by default, of 8 by 8 hexagons."""
    length = PLANE_CASES[name]().parameters()["x_length"]
    return hexagon_mesh((length, 0.5 * np.sqrt(3.0) * length), (8, 8), PLANE_CASES[name].periodic)


@pytest.mark.parametrize("name", PLANE_CASES)
def test_a_process_starts_its_part_as_the_whole(name: str) -> None:
    """Also at the edges of its rim, beyond which cells are missing that are no walls."""
    mesh, case = plane_of(name), PLANE_CASES[name]()
    whole = case.state_on(mesh, 100.0 if case.has_exact_solution else 0.0)
    blocks = (np.arange(mesh.n_cells) // (mesh.n_cells // 2)).astype(np.int32)
    for block in (0, 1):
        part = cut_part(mesh, blocks, block, 1)
        assert part.mesh.n_cells < mesh.n_cells
        mine = case.state_on(part.mesh, 100.0 if case.has_exact_solution else 0.0)
        np.testing.assert_array_equal(mine.thickness, whole.thickness[part.cells])
        inner = part.mesh.cells_on_edge.min(axis=1) >= 0
        np.testing.assert_array_equal(mine.normal_velocity[inner], whole.normal_velocity[part.edges][inner])
        assert np.abs(mine.normal_velocity).max() > 0.0


@pytest.mark.parametrize("name", ["inertia-gravity-wave", "manufactured", "dual-vortex"])
def test_the_mesh_must_repeat_itself_as_the_case_does_in_y_too(name: str) -> None:
    case = PLANE_CASES[name]()
    x_length, y_length = (case.parameters()[f"{axis}_length"] for axis in "xy")
    assert case.state_on(hexagon_mesh((x_length, 2.0 * y_length), (8, 16))).thickness.shape == (128,)
    with pytest.raises(InputError, match=f"{name} repeats itself after y_length = "):
        case.state_on(hexagon_mesh((x_length, 1.5 * y_length), (8, 12)))


@pytest.mark.parametrize("name", ["inertia-gravity-wave", "kelvin-channel"])
def test_a_period_that_misses_a_length_by_little_is_refused(name: str) -> None:
    length = 1e6 * (1.0 + 1e-5)
    mesh = hexagon_mesh((length, 0.5 * np.sqrt(3.0) * length), (8, 8), PLANE_CASES[name].periodic)
    with pytest.raises(InputError, match="x_length = 1000000 m, but the mesh after 1000010 m in x"):
        PLANE_CASES[name]().state_on(mesh)


@pytest.mark.parametrize("name", PLANE_CASES)
def test_thickness_is_sampled_as_asked_for(name: str) -> None:
    mesh, case = plane_of(name), PLANE_CASES[name]()
    point, mean = case.state_on(mesh, sampling="point").thickness, case.state_on(mesh, sampling="mean").thickness
    np.testing.assert_array_equal(point, case.thickness(mesh.x_cell, mesh.y_cell))
    np.testing.assert_array_equal(mean, cell_means(mesh, case.thickness))
    assert np.abs(mean - point).max() > 1e-3 * np.ptp(point)


@pytest.mark.parametrize("name", PLANE_CASES)
def test_norms_are_those_of_the_departure_from_the_depth(name: str) -> None:
    assert PLANE_CASES[name]().background_depth == PLANE_CASES[name]().parameters()["depth"]

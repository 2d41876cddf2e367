"""What holds for every case on a plane: it is found by its name, documented, and shows itself in a few lines."""

from pathlib import Path

import pytest

from cases import PLANE_CASES, find_case
from cases.parameters import units_and_meanings


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
    (row,) = [line for line in page.splitlines() if line.startswith(f"| `{name}` |")]
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

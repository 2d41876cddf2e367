"""The programs of docs/extending.md and docs/first-steps.md run as they stand."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

DOCS = Path(__file__).parents[2] / "docs"
PROGRAM = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


def names_after(page: str) -> dict[str, Any]:
    """What the programs of a page have defined, run one after the other."""
    names: dict[str, Any] = {"__name__": "program"}
    for program in PROGRAM.findall((DOCS / page).read_text()):
        exec(compile(program, page, "exec"), names)
    return names


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for what the programs write."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_case_a_term_and_a_scheme_are_added(elsewhere: Path) -> None:
    names = names_after("extending.md")
    assert names["simulation"].case.title == "Vortex over the pole"
    rates = names["trisk"].open_run("rainy").series["mass_rate_rain"]
    assert np.all(rates > 0.0)
    assert 0.0 < abs(names["energy_change"]) < 1e-11  # 2e-10 with the flux of the default scheme
    assert names["model"].scheme.name == "by-area"


@pytest.mark.slow
def test_the_first_steps_lead_to_a_picture(elsewhere: Path) -> None:
    assert names_after("first-steps.md")["run"].days[-1] == 2.0
    assert (elsewhere / "vorticity.png").stat().st_size > 10_000

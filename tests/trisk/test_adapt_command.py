"""`trisk adapt`: what it writes, that it goes on, and how it refuses."""

import json
from pathlib import Path

from tests.trisk.conftest import Call

ROUNDS = ("adapt", "galewsky", "--cells", "162", "--days", "0.25", "--rounds", "1", "--quiet")


def test_rounds_and_report(trisk: Call, tmp_path: Path) -> None:
    folder = tmp_path / "adapted"
    code, out, err = trisk(*ROUNDS, "--fine", "642", "-o", folder)
    assert (code, out, err) == (0, "", "")
    assert {path.name for path in folder.iterdir() if path.is_dir()} == {
        *("round-0", "round-1", "uniform", "equal-cost", "fine", "figures")
    }
    assert {path.name for path in (folder / "figures").iterdir()} == {
        *("spacing.png", "kinetic_energy.png", "error.png", "law.png")
    }
    plan = json.loads((folder / "plan.json").read_text())
    assert (plan["density_floor"], plan["density_power"]) == (0.001, 0.5)
    assert "round 1" in (folder / "report.html").read_text()
    assert (folder / "adapt.csv").read_text().count("\n") == 6
    code, out, err = trisk(*ROUNDS, "--fine", "1000", "-o", folder)
    assert code == 2
    assert "choose another folder" in err


def test_the_fine_mesh_must_be_finer(trisk: Call, tmp_path: Path) -> None:
    code, _, err = trisk(*ROUNDS, "--fine", "162", "-o", tmp_path / "adapted")
    assert code == 2
    assert "ask for more cells" in err

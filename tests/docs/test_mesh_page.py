"""The page on mesh generation, which only a checkout can make."""

from pathlib import Path

import numpy as np
import pytest

import mesh_page
import mesh_report
from mesh.generation.optimizer import Limits
from mesh.mesh_request import MeshRequest
from mesh_report import Start, converge_from, distribution_figure, sizes_figure, starts_lines
from postprocess.studies.table1 import Row, table1
from postprocess.studies.table1_page import save


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return table1(5, 1e-6)


@pytest.fixture(scope="module")
def meshes() -> list[Start]:
    return [converge_from(MeshRequest(300, "refined-circle", "random", tolerance=1e-4, seed=k)) for k in (0, 1)]


def test_starts_are_listed_and_drawn(meshes: list[Start], tmp_path: Path) -> None:
    lines = starts_lines(meshes)
    assert len(lines) == 4
    assert {line.count("|") for line in lines} == {13}
    assert all(mesh.dislocations >= 0 for mesh in meshes)
    shown = save(distribution_figure(meshes, (1.0,) * 5, "Title"), tmp_path, "starts")
    assert shown == "![starts](starts.png)"
    assert (tmp_path / "starts.png").stat().st_size > 5000
    left, right = sizes_figure({"one": meshes[0].mesh}).axes
    assert left.get_lines()[0].get_ydata()[0] < left.get_lines()[0].get_ydata()[-1]
    assert np.mean(right.get_lines()[0].get_ydata()) == pytest.approx(1.0)


@pytest.mark.slow
def test_the_page_has_every_part(rows: list[Row], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page on mesh generation, of few and small meshes."""
    small = {"CIRCLE_CELLS": 200, "RANDOM_CELLS": 162, "OPTIMIZER_CELLS": 162, "RANDOM_SEEDS": range(1)}
    small |= {"SHAKEN_SEEDS": range(1), "CIRCLE_STARTS": [("fibonacci", 0)]}
    small["OPTIMIZER_LIMITS"] = {"lbfgs": Limits(1e-4), "multilevel": Limits(1e-4), "lloyd": Limits(1e-8, 3)}
    for module in (mesh_report, mesh_page):
        for name, value in small.items():
            if hasattr(module, name):
                monkeypatch.setattr(module, name, value)
    monkeypatch.setattr(mesh_page, "COARSE_CELLS", 162)
    monkeypatch.setattr(mesh_page, "NESTED_CELLS", 300)
    monkeypatch.setattr(mesh_page, "VARIABLE_TOLERANCE", 1e-2)
    monkeypatch.setattr(mesh_page, "NESTED_STARTS", (("icosahedral", 0), ("fibonacci", 1)))
    told: list[str] = []
    text = mesh_page.write_page(tmp_path, rows, told.append).read_text()
    assert [line for line in text.splitlines() if line.startswith("#")] == [
        "# Mesh generation: quality and convergence",
        "## Table 1, ours and published",
        "## Variable resolution",
        "## Random starts and the icosahedron",
        "## Optimisers",
    ]
    for name in ("meshes", "sizes", "refined-circle-starts", "nested-starts", "optimizers"):
        assert f"![{name.replace('-', ' ')}]({name}.png)" in text
        assert (tmp_path / f"{name}.png").stat().st_size > 3000
    assert "docs/tools/mesh_page.py FOLDER --max-level 5" in text
    assert "5.7079, 0.9006, 0.4012, 0.9904, 0.7114" in text
    tables = [line for line in text.splitlines() if line.startswith(("| icosahedral", "| fibonacci", "| random"))]
    assert [line.split("|")[1].strip() for line in tables] == [
        *("fibonacci", "icosahedral", "fibonacci", "icosahedral", "icosahedral, shaken", "random"),
    ]
    assert "| fibonacci | 1 |" in text
    assert told[0].startswith("refined-circle from fibonacci 0: ")
    assert told[1].startswith("nested mesh from icosahedral 0: least q 0.")
    assert told[2].startswith("nested mesh from fibonacci 1: least q 0.")
    assert told[3] == "162 cells, icosahedral 0: 0 dislocations"
    assert "shaken by\n20% of the spacing" in text
    residuals = {line.split(":")[0]: float(line.split()[2]) for line in told[-3:]}
    assert max(residuals["lbfgs"], residuals["multilevel"]) < 1e-4 < residuals["lloyd"]
    assert told[-1].endswith(" after 3 iterations")

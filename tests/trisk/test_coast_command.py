"""`trisk mesh --coast`: cells that the coast of a region clips."""

import re
from pathlib import Path

import numpy as np
import pytest

from mesh import MeshError, find_region, mesh_quality, read_mesh
from mesh.coast.generation import coast_smoothing
from mesh.discrete.walls import has_walls
from mesh.regions.coastline import LONGEST
from tests.trisk.conftest import Call

BOX = "300,340,20,50"


def test_file_has_the_cells_of_the_region(trisk: Call, tmp_path: Path) -> None:
    target = tmp_path / "sea.nc"
    code, out, _ = trisk("mesh", "--coast", BOX, "--cells", 150, "-o", target)
    assert code == 0
    assert "Quality of" in out
    mesh = read_mesh(target)
    assert mesh.n_cells == 150
    assert has_walls(mesh)
    assert mesh_quality(mesh).q_avg > 0.9


def test_what_does_not_go_with_a_coast_is_refused(trisk: Call, tmp_path: Path) -> None:
    target = tmp_path / "sea.nc"
    for extra in (["--resume"], ["--well-centred"], ["--method", "multilevel"]):
        code, _, err = trisk("mesh", "--coast", BOX, "--cells", 150, "-o", target, *extra)
        assert code == 2
        assert "coast" in err
        assert err.count("error") == 1
    assert not target.exists()


def test_cells_get_smaller_towards_the_coast(trisk: Call, tmp_path: Path) -> None:
    target = tmp_path / "sea.nc"
    code, _, err = trisk(
        *("mesh", "--coast", BOX, "--cells", 150, "-o", target, "-q", "--coast-width", 500, "--coast-factor", 16)
    )
    assert (code, err) == (0, "")
    mesh = read_mesh(target)
    away = find_region(BOX).distance(mesh.cell_points) * 6371.0
    sizes = np.sqrt(mesh.area_cell)
    assert sizes[away > 900.0].mean() > 1.6 * sizes[away < 200.0].mean()
    assert "raised 16 times" in mesh.density_name
    for wrong, told in (
        (("--coast-width", 0), "--coast-width is 0; give a positive number of km"),
        (("--coast-width", "nan"), "--coast-width is nan; give a positive number of km"),
        (("--coast-width", 100, "--coast-factor", 0.5), "cannot be raised 0.5 times at the coast"),
        (("--coast-factor", 3), "--coast-factor is 3, but over no width; give --coast-width too"),
    ):
        code, _, err = trisk("mesh", "--coast", BOX, "--cells", 150, "-o", target, *wrong)
        assert code == 2
        assert told in err
    for alone in ("--coast-width", "--coast-factor"):
        code, _, err = trisk("mesh", "--cells", 150, "-o", target, alone, 100)
        assert code == 2
        assert f"{alone} goes with --coast alone" in err


def test_too_few_cells_are_told_in_cells(trisk: Call, tmp_path: Path) -> None:
    code, _, err = trisk("mesh", "--coast", BOX, "--cells", 0, "-o", tmp_path / "sea.nc")
    assert code == 2
    assert "a mesh of 0 cells is too small; ask for at least 12" in err
    code, _, err = trisk("mesh", "--coast", "280,350,10,60", "--cells", 12, "-o", tmp_path / "sea.nc")
    assert code == 2
    found = re.search(r"12 cells are too few to follow its coast; ask for at least (\d+)", err)
    assert found is not None
    box, enough = find_region("280,350,10,60"), int(found.group(1))
    assert coast_smoothing(box, enough) <= LONGEST
    with pytest.raises(MeshError, match="too few"):
        coast_smoothing(box, enough - 1)

"""`trisk mesh --coast`: cells that the coast of a region clips."""

from pathlib import Path

import numpy as np

from mesh import find_region, mesh_quality, read_mesh
from mesh.discrete.walls import has_walls
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
    for wrong in (("--coast-width", 0), ("--coast-width", 100, "--coast-factor", 0.5)):
        code, _, err = trisk("mesh", "--coast", BOX, "--cells", 150, "-o", target, *wrong)
        assert code == 2
        assert "raised" in err
    code, _, err = trisk("mesh", "--cells", 150, "-o", target, "--coast-width", 100)
    assert code == 2
    assert "--coast" in err

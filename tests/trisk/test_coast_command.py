"""`trisk mesh --coast`: cells that the coast of a region clips."""

from pathlib import Path

from mesh import mesh_quality, read_mesh
from mesh.discrete.walls import has_walls
from tests.trisk.conftest import Call

BOX = "300,340,20,50"


def test_file_has_the_cells_of_the_region(trisk: Call, tmp_path: Path) -> None:
    target = tmp_path / "sea.nc"
    code, out, _ = trisk("mesh", "--coast", BOX, "--cells", 150, "-o", target)
    assert code == 0
    assert str(target.name) in out.replace("\n", "")
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

from pathlib import Path

import pytest
import typer

from mesh import scvt_mesh, write_mesh
from trisk.arguments.meshes import chosen_mesh


def test_mesh_is_read_or_generated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(scvt_mesh(42), path)
    assert chosen_mesh(path, None, recompute_metrics=True, quiet=True).n_cells == 42
    assert chosen_mesh(None, 100, recompute_metrics=False, quiet=True).n_cells == 100
    assert capsys.readouterr() == ("", "")
    assert chosen_mesh(None, 42, recompute_metrics=False, quiet=False).n_cells == 42
    assert "mesh: iteration" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("mesh_file", "cells", "recompute_metrics", "words"),
    [
        (None, None, False, "either --mesh FILE or --cells N"),
        (Path("mesh.nc"), 42, False, "either --mesh FILE or --cells N"),
        (None, 42, True, "--recompute-metrics goes with --mesh FILE"),
    ],
)
def test_choices_that_are_refused(
    mesh_file: Path | None, cells: int | None, recompute_metrics: bool, words: str
) -> None:
    with pytest.raises(typer.BadParameter, match=words):
        chosen_mesh(mesh_file, cells, recompute_metrics, quiet=True)

"""Some legal variants of mesh files; `python tests/reliability/legal_variants.py 300` makes as many as one likes."""

from pathlib import Path

import numpy as np
import pytest
from legal_variants import CHANGES, Variant, flip_tangents, originals, outcomes

from mesh import VoronoiMesh, read_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.parts.culling import culled


@pytest.mark.slow
def test_legal_variants_give_the_same_run() -> None:
    found = outcomes(60, seed=1)
    assert not [words for words in found if words.startswith("WRONG")]
    assert found["the same run"] > 40
    assert found["says what is missing"] > 0


@pytest.mark.parametrize("change", CHANGES[:6], ids=lambda change: change.__name__)
@pytest.mark.parametrize("which", range(3))
@pytest.mark.filterwarnings("ignore::mesh.MeshWarning")
def test_the_order_in_a_file_changes_no_bit(tmp_path: Path, change, which: int) -> None:
    """All arrays are those of the original, but for where the rings of cells start."""
    assert_same_but_for_starts_of_rings(originals()[which], change, tmp_path)


@pytest.mark.parametrize("change", [*CHANGES[:6], flip_tangents], ids=lambda change: change.__name__)
@pytest.mark.parametrize("which", range(3))
@pytest.mark.filterwarnings("ignore::mesh.MeshWarning")
def test_the_order_in_a_file_with_walls_changes_no_bit(tmp_path: Path, change, which: int) -> None:
    sea = originals()[which].lat_cell < 0.5
    sea[np.argmin(originals()[which].lat_cell)] = False
    assert_same_but_for_starts_of_rings(culled(originals()[which], sea), change, tmp_path)


def assert_same_but_for_starts_of_rings(original: VoronoiMesh, change, tmp_path: Path) -> None:
    write_mesh(original, tmp_path / "mesh.nc")
    variant = Variant(tmp_path / "mesh.nc")
    change(variant, np.random.default_rng(3))
    (tmp_path / "mesh.nc").unlink()
    variant.write(tmp_path / "mesh.nc")
    mesh = read_mesh(tmp_path / "mesh.nc")
    rings = ("edgesOnCell", "cellsOnCell", "verticesOnCell") if change.__name__ == "rotate_rings" else ()
    walls, turned = original.boundary_vertex.any(), ("cellsOnVertex", "edgesOnVertex", "kiteAreasOnVertex")
    for variable in MESH_VARIABLES:
        found = getattr(mesh, variable.name)
        if walls and change.__name__ == "shuffle_corners" and variable.file_name in turned:  # rows may start elsewhere
            np.testing.assert_array_equal(np.sort(found), np.sort(getattr(original, variable.name)))
        elif variable.file_name in rings:  # legal as it stands, so that it stays as it is
            np.testing.assert_array_equal(found + 1, variant.arrays[variable.file_name])
        else:
            np.testing.assert_array_equal(found, getattr(original, variable.name), variable.name)

import numpy as np
import pytest

from mesh import MeshError, mesh_from_points, mesh_quality
from mesh.density.named import RefinedBox
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits, ScvtResult
from mesh.generation.scvt import generate_scvt
from mesh.mesh_request import MeshRequest

BOX = RefinedBox()


@pytest.fixture(scope="module")
def coarse() -> ScvtResult:
    return generate_scvt(MeshRequest(642))


@pytest.mark.slow
def test_generators_beyond_the_transition_stay(coarse: ScvtResult) -> None:
    result = nested_scvt(coarse.points, coarse.triangles, BOX, limits=Limits(1e-4))
    outside = coarse.points[BOX(coarse.points) == 1.0]
    kept = {tuple(point) for point in result.points}
    assert all(tuple(point) in kept for point in outside)
    assert 300 < len(outside) < 600
    quality = mesh_quality(mesh_from_points(result.points, result.triangles, BOX, "refined-box"))
    assert quality.q_avg > 0.98
    assert result.fixed is not None
    np.testing.assert_array_equal(BOX(result.points[result.fixed]), 1.0)
    assert len(result.points) > 1.5 * len(coarse.points)


@pytest.mark.slow
def test_number_of_cells_is_met(coarse: ScvtResult) -> None:
    assert len(nested_scvt(coarse.points, coarse.triangles, BOX, 1500, Limits(1e-3)).points) == 1500


def test_impossible_numbers_are_refused(coarse: ScvtResult) -> None:
    with pytest.raises(MeshError, match="600 cells cannot refine a mesh of 642"):
        nested_scvt(coarse.points, coarse.triangles, BOX, 600)
    with pytest.raises(MeshError, match="yields fewer than 99358 new cells"):
        nested_scvt(coarse.points, coarse.triangles, BOX, 100_000)

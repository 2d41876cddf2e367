import numpy as np
import pytest

from mesh import VoronoiMesh
from postprocess.norms import l1_norm, l2_norm, linf_norm


def test_norms_of_known_fields() -> None:
    area, reference = np.array([1.0, 3.0]), np.array([2.0, 4.0])
    values = reference + np.array([1.0, -2.0])
    assert l1_norm(values, reference, area) == pytest.approx((1 + 6) / (2 + 12))
    assert l2_norm(values, reference, area) == pytest.approx(np.sqrt((1 + 12) / (4 + 48)))
    assert linf_norm(values, reference) == pytest.approx(0.5)


def test_weights_are_areas_on_every_mesh(any_mesh: VoronoiMesh) -> None:
    """A smooth field has the norms of its continuous integrals only if each area counts once."""
    z = any_mesh.cell_points[:, 2]
    ones = np.ones(any_mesh.n_cells)
    coarse = 0.25 if any_mesh.n_cells < 50 else 0.05
    assert l1_norm(1 + np.abs(z), ones, any_mesh.area_cell) == pytest.approx(0.5, rel=coarse)
    assert l2_norm(1 + z, ones, any_mesh.area_cell) == pytest.approx(np.sqrt(1 / 3), rel=coarse)

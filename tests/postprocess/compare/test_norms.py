"""Norms against values worked out by hand, on meshes where a wrong weight shows."""

import math

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.geometry.sphere import from_lonlat
from postprocess.compare.norms import scalar_norms, vector_norms


def test_norms_of_known_fields() -> None:
    area, reference = np.array([1.0, 3.0]), np.array([2.0, 4.0])
    norms = scalar_norms(reference + np.array([1.0, -2.0]), reference, area)
    assert norms.l1 == pytest.approx((1 + 6) / (2 + 12))
    assert norms.l2 == pytest.approx(np.sqrt((1 + 12) / (4 + 48)))
    assert norms.linf == pytest.approx(0.5)


def test_vector_norms_of_known_fields() -> None:
    """The first error is 5 long, the second 1; their components alone would give other norms."""
    area = np.array([1.0, 3.0])
    reference = (np.array([6.0, 0.0]), np.array([8.0, 2.0]))
    values = (np.array([9.0, 1.0]), np.array([4.0, 2.0]))
    norms = vector_norms(values, reference, area)
    assert norms.l1 == pytest.approx((5 + 3) / (10 + 6))
    assert norms.l2 == pytest.approx(np.sqrt((25 + 3) / (100 + 12)))
    assert norms.linf == pytest.approx(0.5)


def test_reference_of_zero_gives_no_number() -> None:
    zero, one = np.zeros(2), np.ones(2)
    for norms in (scalar_norms(one, zero, one), vector_norms((one, one), (zero, zero), one)):
        assert math.isnan(norms.l1)
        assert math.isnan(norms.l2)
        assert math.isnan(norms.linf)


def test_weights_are_areas_on_every_mesh(any_mesh: VoronoiMesh) -> None:
    """A smooth field has the norms of its continuous integrals only if each area counts once."""
    z = any_mesh.cell_points[:, 2]
    ones = np.ones(any_mesh.n_cells)
    coarse = 0.25 if any_mesh.n_cells < 50 else 0.05
    norms = scalar_norms(1 + np.abs(z), ones, any_mesh.area_cell)
    assert norms.l1 == pytest.approx(0.5, rel=coarse)
    assert norms.linf == pytest.approx(1.0, rel=coarse)
    assert scalar_norms(1 + z, ones, any_mesh.area_cell).l2 == pytest.approx(np.sqrt(1 / 3), rel=coarse)


def test_where_the_mesh_is_fine_does_not_count_more(refined_mesh: VoronoiMesh) -> None:
    """Errors 1 + s and 1 + s^2, with s the sine of the height above the plane that halves the refined region.

    Over the sphere s has mean 0, s^2 mean 1/3 and s^4 mean 1/5. Cells counted alike, or by the squares of their
    areas, miss these by many times the tolerance, because the refined half holds most cells.
    """
    mesh, ones = refined_mesh, np.ones(refined_mesh.n_cells)
    s = mesh.cell_points @ from_lonlat(np.array(1.5 * np.pi), np.array(np.pi / 6))
    even, linear = scalar_norms(1 + (1 + s**2), ones, mesh.area_cell), scalar_norms(1 + (1 + s), ones, mesh.area_cell)
    assert linear.l1 == pytest.approx(1.0, rel=0.005)
    assert linear.l2 == pytest.approx(np.sqrt(4 / 3), rel=0.005)
    assert even.l1 == pytest.approx(4 / 3, rel=0.005)
    assert even.l2 == pytest.approx(np.sqrt(28 / 15), rel=0.005)
    for wrong in (ones, mesh.area_cell**2):
        assert abs(scalar_norms(1 + (1 + s), ones, wrong).l1 - 1.0) > 0.05


def test_solid_rotation_on_a_refined_mesh(refined_mesh: VoronoiMesh) -> None:
    """Zonal wind cos(lat) against one of 2 cos(lat) and a uniform one aside; the mean of cos is pi/4, of cos^2 2/3."""
    mesh = refined_mesh
    cosine, zero = np.cos(mesh.lat_cell), np.zeros(mesh.n_cells)
    norms = vector_norms((cosine, cosine), (2 * cosine, zero), mesh.area_cell)
    assert norms.l1 == pytest.approx(np.sqrt(2) / 2)
    against_one = vector_norms((1 + 0.3 * cosine, 0.4 * cosine), (1 + zero, zero), mesh.area_cell)
    assert against_one.l1 == pytest.approx(0.5 * np.pi / 4, rel=0.005)
    assert against_one.l2 == pytest.approx(0.5 * np.sqrt(2 / 3), rel=0.005)

"""What two meshes have in common, and means carried from one to the other."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.geometry.sphere import normalize
from mesh.overlap.overlaps import Overlaps, overlaps_of
from mesh.overlap.polygons import area_and_moment
from mesh.parts.cutting import without_cells
from tests.conftest import random_mesh


@pytest.fixture(scope="module")
def meshes(icosahedral_mesh: VoronoiMesh) -> tuple[VoronoiMesh, VoronoiMesh]:
    return icosahedral_mesh, random_mesh(642, seed=3)


@pytest.fixture(scope="module")
def overlaps(meshes: tuple[VoronoiMesh, VoronoiMesh]) -> Overlaps:
    return overlaps_of(*meshes)


def smooth(points: Array) -> Array:
    return 5.0 + points[:, 0] * points[:, 1] + points[:, 2] ** 3


def test_pieces_add_up_to_the_cells_of_both_meshes(meshes: tuple[VoronoiMesh, VoronoiMesh], overlaps: Overlaps) -> None:
    source, target = meshes
    np.testing.assert_allclose(overlaps.covered, target.area_cell, rtol=1e-9)
    np.testing.assert_allclose(
        np.bincount(overlaps.sources, overlaps.areas, source.n_cells), source.area_cell, rtol=1e-11
    )
    np.testing.assert_allclose(overlaps.source_areas, source.area_cell, rtol=1e-12)
    assert np.abs(overlaps.moments.sum(axis=0)).max() < 1e-13  # the integral of the position over the sphere


def test_an_octant_has_an_eighth_of_the_area_and_a_quarter_of_pi_in_each_direction() -> None:
    area, *moment = area_and_moment(np.eye(3), 3)
    assert area == pytest.approx(np.pi / 2.0, rel=1e-15)
    np.testing.assert_allclose(moment, np.pi / 4.0, rtol=1e-15)


def test_a_mesh_meets_itself_alone(icosahedral_mesh: VoronoiMesh) -> None:
    overlaps = overlaps_of(icosahedral_mesh, icosahedral_mesh)
    own = overlaps.sources == overlaps.targets
    np.testing.assert_allclose(overlaps.areas[own], icosahedral_mesh.area_cell, rtol=1e-12)
    assert np.all(overlaps.areas[~own] < 1e-15)
    values = smooth(icosahedral_mesh.cell_points)
    np.testing.assert_allclose(overlaps.means(values), values, rtol=1e-12)


def test_integrals_are_kept_and_constants_stay(meshes: tuple[VoronoiMesh, VoronoiMesh], overlaps: Overlaps) -> None:
    source, target = meshes
    values = smooth(source.cell_points)
    before = source.area_cell @ values
    assert abs(target.area_cell @ overlaps.means(values) - before) < 1e-13 * before
    np.testing.assert_allclose(overlaps.means(np.full(source.n_cells, 7.0)), 7.0, rtol=1e-14)


def test_means_of_a_smooth_field_are_of_second_order(
    icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh, meshes: tuple[VoronoiMesh, VoronoiMesh]
) -> None:
    target = meshes[1]
    errors = []
    for source in (icosahedral_mesh, larger_mesh):
        overlaps = overlaps_of(source, target)
        means = source_means(overlaps)
        exact = target_means(overlaps)
        errors.append(np.abs(overlaps.means(means) - exact).max())
    assert np.log2(errors[0] / errors[1]) > 1.8


def source_means(overlaps: Overlaps) -> Array:
    """Means of x over the source cells, which their moments give exactly."""
    return overlaps.source_moments[:, 0] / overlaps.source_areas


def target_means(overlaps: Overlaps) -> Array:
    """Means of x over the target cells."""
    integrals = np.bincount(overlaps.targets, overlaps.moments[:, 0], len(overlaps.starts) - 1)
    return integrals / overlaps.covered


def test_what_is_not_covered_takes_means_of_the_rest_or_the_nearest_value(icosahedral_mesh: VoronoiMesh) -> None:
    missing = icosahedral_mesh.z_cell < 0.0
    source = without_cells(icosahedral_mesh, missing)
    overlaps = overlaps_of(source, icosahedral_mesh)
    values = np.arange(source.n_cells, dtype=float)
    means = overlaps.means(values)
    np.testing.assert_allclose(means[~missing], values, rtol=1e-12, atol=1e-12)
    far = np.flatnonzero(overlaps.covered == 0.0)
    assert len(far) > 200
    away = normalize(icosahedral_mesh.cell_points)[far] @ normalize(source.cell_points).T
    np.testing.assert_array_equal(means[far], values[np.argmax(away, axis=1)])

"""Patches of the sphere by their numbers."""

import numpy as np

from mesh.geometry.cube import patch_centers, patch_of, points_on_faces


def test_a_patch_holds_its_centre() -> None:
    assert [patch_of(*center, 5) for center in patch_centers(5)] == list(range(150))


def test_points_on_faces_are_unit_vectors_in_the_order_of_patches() -> None:
    points = points_on_faces(np.array([-0.5, 0.5]))
    np.testing.assert_array_equal(points, patch_centers(2))
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)

"""Patches of the sphere by their numbers."""

import numpy as np

from mesh.geometry.cube import patch_centers, patch_of, place_in_patch, points_in_patches, points_on_faces


def test_a_patch_holds_its_centre() -> None:
    assert [patch_of(*center, 5) for center in patch_centers(5)] == list(range(150))


def test_points_on_faces_are_unit_vectors_in_the_order_of_patches() -> None:
    points = points_on_faces(np.array([-0.5, 0.5]))
    np.testing.assert_array_equal(points, patch_centers(2))
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)


def test_points_in_patches_are_found_at_their_places() -> None:
    patches, places = np.array([3, 17, 60, 149]), np.array([0.25, 0.75])
    points = points_in_patches(patches, 5, places)
    np.testing.assert_allclose(np.linalg.norm(points, axis=-1), 1.0, rtol=1e-15)
    for number, patch in enumerate(patches):
        for row, up in enumerate(places):
            for column, across in enumerate(places):
                found = place_in_patch(*points[number, row, column], 5)
                np.testing.assert_allclose(found, (patch, across, up), rtol=1e-12)
    centers = points_in_patches(np.arange(150), 5, np.array([0.5]))[:, 0, 0]
    np.testing.assert_allclose(centers, patch_centers(5), atol=1e-15)

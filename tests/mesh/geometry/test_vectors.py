"""Vectors of compiled code beside those of whole arrays, and options that depend on no caller."""

import numba
import numpy as np
import pytest

from mesh.geometry import vectors
from mesh.geometry.sphere import triangle_area
from mesh.geometry.vectors import (
    area_parts,
    chord,
    cross_product,
    determinant,
    dot_product,
    triangle_normal,
    triple_product,
    vector_between,
    vector_to,
)
from mesh.integrals import moments

POINTS = np.random.default_rng(5).uniform(-1.0, 1.0, (4, 3))
U, V, W = (tuple(row) for row in POINTS[:3].tolist())


def test_vectors_are_those_of_rows() -> None:
    assert vector_to(POINTS, 1) == V
    np.testing.assert_array_equal(vector_between(POINTS, 2, -POINTS, 0), -POINTS[0] - POINTS[2])


def test_products_are_those_of_numpy() -> None:
    np.testing.assert_allclose(dot_product(U, V), np.dot(U, V), rtol=1e-14)
    np.testing.assert_allclose(cross_product(U, V), np.cross(U, V), rtol=1e-13)
    volume = np.linalg.det(POINTS[:3])
    np.testing.assert_allclose([triple_product(U, V, W), determinant(POINTS, 0, 1, 2)], volume, rtol=1e-12)
    np.testing.assert_allclose(chord(POINTS, 3, 1), np.linalg.norm(POINTS[3] - POINTS[1]), rtol=1e-14)
    normal = np.cross(POINTS[1] - POINTS[0], POINTS[2] - POINTS[0])
    np.testing.assert_allclose(triangle_normal(POINTS, 0, 1, 2), normal, rtol=1e-13)


def test_areas_are_to_the_last_digit_those_of_rows() -> None:
    a = np.random.default_rng(6).normal(size=(500, 3))
    b, c = a + 0.01 * np.roll(a, 1, axis=0), a + 0.01 * np.roll(a, 2, axis=0)
    parts = [area_parts(*(tuple(corner) for corner in corners)) for corners in zip(a, b, c, strict=True)]
    np.testing.assert_array_equal(2.0 * np.arctan2(*np.array(parts).T), triangle_area(a, b, c))


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("module", [vectors, moments], ids=lambda module: module.__name__)
def test_options_depend_on_no_caller(module: object) -> None:
    """A mesh once had other last digits where another command had compiled the moments of its cells first."""
    functions = [each for each in vars(module).values() if hasattr(each, "targetoptions")]
    assert len(functions) > 5
    assert not [each.__name__ for each in functions if "fastmath" not in each.targetoptions]

"""Flips from one side on, until all near it are Delaunay or there are too many."""

import numpy as np
import pytest

from mesh.arrays import Array, Index
from mesh.generation.generators import icosahedral_points
from mesh.geometry.sphere import circumcenter
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins, first_corners
from mesh.triangulation.ordering import sort_triangles
from mesh.triangulation.repair import _settle_edge, flip

Arrays = tuple[Array, Index, Index, Index, Index, Array]
WRONG = 7


@pytest.fixture
def with_a_wrong_side() -> Arrays:
    """A triangulation that is Delaunay but for the side of half-edge 1 of a triangle."""
    points = np.ascontiguousarray(icosahedral_points(2))
    triangles = np.array(delaunay(points), np.int32, order="C")
    twins = build_twins(triangles, len(points))
    first_corner, degrees = first_corners(triangles, len(points))
    flip(triangles, twins, first_corner, degrees, WRONG, twins.ravel()[WRONG])
    centers = circumcenter(*(points[triangles[:, k]] for k in range(3)))
    return points, triangles, twins, first_corner, degrees, centers


def wrong_half_edge(triangles: Index) -> int:
    """`flip` leaves the side that it turned opposite to the second corner of the first triangle."""
    return 3 * (WRONG // 3) + 1


def test_a_side_is_settled_within_the_limit(with_a_wrong_side: Arrays) -> None:
    points, triangles, *_ = with_a_wrong_side
    stack = np.empty(100, np.int32)
    assert _settle_edge(*with_a_wrong_side, wrong_half_edge(triangles), stack, 1) == 1
    np.testing.assert_array_equal(sort_triangles(triangles), sort_triangles(delaunay(points)))
    centers = circumcenter(*(points[triangles[:, k]] for k in range(3)))
    np.testing.assert_allclose(with_a_wrong_side[5], centers, atol=1e-13)


@pytest.mark.parametrize(("limit", "room"), [(0, 100), (5, 3)])
def test_beyond_the_limit_or_the_stack_it_is_said_that_nothing_settles(
    with_a_wrong_side: Arrays, limit: int, room: int
) -> None:
    before = with_a_wrong_side[1].copy()
    stack = np.empty(room, np.int32)
    assert _settle_edge(*with_a_wrong_side, wrong_half_edge(before), stack, limit) == -1
    np.testing.assert_array_equal(with_a_wrong_side[1], before)

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mesh import MeshError, mesh_from_points
from mesh.generation.generators import icosahedron
from mesh.geometry.sphere import dot, normalize
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins
from tests.mesh.plain_moments import is_delaunay


def spread_points(count: int, seed: int) -> np.ndarray:
    """Random points, the first six near the octahedron's vertices so that no hemisphere stays empty."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points[:6] = 0.1 * points[:6] + np.concatenate([np.eye(3), -np.eye(3)])
    return normalize(points)


@settings(deadline=None, max_examples=30)
@given(count=st.integers(12, 300), seed=st.integers(0, 10**6))
def test_no_generator_lies_inside_a_circumcircle(count: int, seed: int) -> None:
    points = spread_points(count, seed)
    assert is_delaunay(points, delaunay(points))


def test_the_plain_check_sees_a_flipped_edge() -> None:
    points = spread_points(50, 3)
    triangles = delaunay(points)
    twin = build_twins(triangles, 50)[0, 0]
    c, a, b = triangles[0]
    d = triangles.ravel()[twin]
    flipped = triangles.copy()
    flipped[0], flipped[twin // 3] = (c, a, d), (d, b, c)
    build_twins(flipped, 50)
    assert not is_delaunay(points, flipped)


def test_twins_are_the_same_side_run_back() -> None:
    triangles = delaunay(spread_points(200, 1))
    twins = build_twins(triangles, 200)
    start, end = (np.roll(triangles, shift, axis=1).ravel() for shift in (-1, 1))
    np.testing.assert_array_equal(start[twins.ravel()], end)
    np.testing.assert_array_equal(twins.ravel()[twins.ravel()], np.arange(twins.size))


def test_triangles_run_counter_clockwise() -> None:
    points = icosahedron()
    a, b, c = (points[delaunay(points)[:, k]] for k in range(3))
    assert np.all(dot(np.cross(a, b), c) > 0.0)


def test_coinciding_generators_are_named() -> None:
    points = spread_points(30, 0)
    points[17] = points[4]
    with pytest.raises(MeshError, match=r"generators \[(4|17)\] coincide with others; remove the duplicates"):
        mesh_from_points(points)


def test_hemisphere_is_refused() -> None:
    points = spread_points(60, 0)
    points[:, 2] = np.abs(points[:, 2]) + 0.1
    with pytest.raises(MeshError, match="the generators lie in one hemisphere; spread them over the whole sphere"):
        mesh_from_points(points)


def test_points_on_one_circle_are_refused() -> None:
    angle = np.linspace(0, 6, 20)
    with pytest.raises(MeshError, match="span no closed surface"):
        delaunay(np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))


def test_open_surface_is_refused() -> None:
    triangles = delaunay(icosahedron())
    with pytest.raises(MeshError, match="do not close the sphere"):
        build_twins(triangles[:-2], 12)

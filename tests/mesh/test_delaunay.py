import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mesh import MeshError, mesh_from_points
from mesh.delaunay import delaunay, half_edge_twins, is_delaunay
from mesh.generators import icosahedron
from mesh.sphere import dot, normalize


def spread_points(count: int, seed: int) -> np.ndarray:
    """Random points, the first six near the octahedron's vertices so that no hemisphere stays empty."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points[:6] = 0.1 * points[:6] + np.concatenate([np.eye(3), -np.eye(3)])
    return normalize(points)


@settings(deadline=None, max_examples=30)
@given(count=st.integers(12, 300), seed=st.integers(0, 10**6))
def test_no_generator_lies_inside_a_circumcircle(count: int, seed: int) -> None:
    points = spread_points(count, seed)
    triangles = delaunay(points)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    assert np.all(dot(normals, a) != 0.0)
    heights = normals @ points.T - dot(normals, a)[:, None]
    assert heights.max() < 1e-12
    assert is_delaunay(points, triangles, half_edge_twins(triangles))


def test_a_flipped_edge_is_not_delaunay() -> None:
    points = spread_points(50, 3)
    triangles = delaunay(points)
    twin = half_edge_twins(triangles)[0]
    a, b, c = triangles[0]
    d = triangles[twin // 3, (twin % 3 + 2) % 3]
    flipped = triangles.copy()
    flipped[0], flipped[twin // 3] = (a, d, c), (d, b, c)
    assert not is_delaunay(points, flipped, half_edge_twins(flipped))


def test_inverted_triangle_is_not_delaunay() -> None:
    points = icosahedron()
    triangles = delaunay(points)
    moved = points.copy()
    moved[0] = -points[0]
    assert not is_delaunay(moved, triangles, half_edge_twins(triangles))


def test_triangles_run_counter_clockwise() -> None:
    points = icosahedron()
    a, b, c = (points[delaunay(points)[:, k]] for k in range(3))
    assert np.all(dot(np.cross(a, b), c) > 0.0)


def test_coinciding_generators_are_named() -> None:
    points = spread_points(30, 0)
    points[17] = points[4]
    with pytest.raises(MeshError, match="coincide"):
        mesh_from_points(points)


def test_hemisphere_is_refused() -> None:
    points = spread_points(60, 0)
    points[:, 2] = np.abs(points[:, 2]) + 0.1
    with pytest.raises(MeshError, match="hemisphere"):
        mesh_from_points(points)


def test_points_on_one_circle_are_refused() -> None:
    angle = np.linspace(0, 6, 20)
    with pytest.raises(MeshError, match="span no closed surface"):
        delaunay(np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))


def test_open_surface_is_refused() -> None:
    triangles = delaunay(icosahedron())
    with pytest.raises(MeshError, match="do not close the sphere"):
        half_edge_twins(triangles[:-2])

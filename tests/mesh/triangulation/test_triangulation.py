"""A repaired triangulation is the rebuilt one after every move, however the points lie."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from test_delaunay import spread_points

from mesh.generation.generators import icosahedral_points
from mesh.geometry.sphere import circumcenter, normalize
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.moving import Triangulation
from mesh.triangulation.ordering import hilbert_order, sort_triangles
from tests.mesh.plain_moments import is_delaunay


def assert_consistent(triangulation: Triangulation, points: np.ndarray) -> None:
    """Twins, circumcentres and rings belong to the triangles."""
    triangles, twins = triangulation.triangles, triangulation.twins.ravel()
    np.testing.assert_array_equal(twins[twins], np.arange(twins.size))
    start, end = (np.roll(triangles, shift, axis=1).ravel() for shift in (-1, 1))
    np.testing.assert_array_equal(start[twins], end)
    expected = circumcenter(*(points[triangles[:, k]] for k in range(3)))
    np.testing.assert_allclose(triangulation.circumcenters, expected, atol=1e-7)
    for point in range(0, len(points), 5):
        ring = triangulation.rings[triangulation.ring_starts[point] : triangulation.ring_starts[point + 1]]
        assert set(ring) == set(np.flatnonzero((triangles == point).any(axis=1)))


def in_one_hemisphere(points: np.ndarray) -> bool:
    """Whether all points lie on one side of some plane through the origin."""
    return linprog(np.zeros(3), A_ub=-points, b_ub=-np.ones(len(points)), bounds=(None, None)).status == 0


@settings(deadline=None, max_examples=60)
@example(count=12, seed=28819, size=2.0)  # flips leave a tangle: Delaunay at every side, and not the triangulation
@given(
    count=st.integers(12, 2000),
    seed=st.integers(0, 10**6),
    size=st.sampled_from([1e-3, 0.1, 0.5, 2.0]),
)
def test_repaired_and_rebuilt_are_equal_after_every_move(count: int, seed: int, size: float) -> None:
    points = spread_points(count, seed)
    triangulation = Triangulation(points)
    random = np.random.default_rng(seed + 1)
    for _ in range(3):
        moved = normalize(points + size / np.sqrt(count) * random.normal(size=points.shape))
        assume(not in_one_hemisphere(moved))
        triangulation.update(moved, points)
        np.testing.assert_array_equal(sort_triangles(triangulation.triangles), sort_triangles(delaunay(moved)))
        points = moved
    assert_consistent(triangulation, points)


def test_small_moves_need_flips_but_no_hull() -> None:
    points = normalize(np.random.default_rng(0).normal(size=(3000, 3)))
    triangulation = Triangulation(points)
    for seed in range(10):
        moved = normalize(points + 2e-4 * np.random.default_rng(seed).normal(size=points.shape))
        triangulation.update(moved, points)
        points = moved
    assert triangulation.flips > 50
    assert triangulation.rebuilds == 0
    assert is_delaunay(points, triangulation.triangles)


def test_unrelated_points_are_rebuilt() -> None:
    first, second = spread_points(100, 1), spread_points(100, 2)
    triangulation = Triangulation(first)
    triangulation.update(second)
    assert triangulation.rebuilds == 1
    np.testing.assert_array_equal(sort_triangles(triangulation.triangles), sort_triangles(delaunay(second)))


def grid_points(side: int) -> np.ndarray:
    """Points of a cube's surface lattice on the sphere: four on a circle everywhere."""
    line = np.linspace(-1.0, 1.0, side)
    x, y, z = np.meshgrid(line, line, line)
    surface = np.maximum(np.maximum(abs(x), abs(y)), abs(z)) == 1.0
    return normalize(np.stack([x[surface], y[surface], z[surface]], axis=1))


CIRCLES = {
    "octahedron": np.concatenate([np.eye(3), -np.eye(3)]),
    "cube": grid_points(2),
    "cube lattice": grid_points(9),
    "icosahedral": icosahedral_points(4),
}


@pytest.mark.parametrize("name", CIRCLES)
def test_points_on_one_circle_settle(name: str) -> None:
    """Co-circular points, exactly and with coordinates shaken in the last place, never flip for ever."""
    points = CIRCLES[name]
    points = points[hilbert_order(points)]
    triangulation = Triangulation(points)
    random = np.random.default_rng(0)
    for _ in range(5):
        points = points * (1.0 + 2.2e-16 * random.integers(-1, 2, points.shape))
        triangulation.update(points)
        assert_consistent(triangulation, points)
        assert is_delaunay(points, triangulation.triangles, rounding=1e-14)
    assert triangulation.flips < 10 * len(points)

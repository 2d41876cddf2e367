"""Cells of moving generators in rectangles: those that scipy finds, and those that walls clip."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from mesh.arrays import Array
from mesh.integrals.plane_moments import plane_cell
from mesh.plane.domain import Rectangle
from mesh.plane.moving import PlaneCells
from mesh.plane.starts import rows_of_points, starting_points

PLANES = [Rectangle(3.0, 2.0, periodic) for periodic in ("xy", "x", "none")]


def flat(places: Array) -> Array:
    return np.column_stack([places, np.zeros(len(places))])


def moments(cells: PlaneCells, points: Array) -> Array:
    """Area, moments and energy (n, 4) of all cells."""
    circles = cells.circumcenters, cells.ring_starts, cells.rings
    return np.array([plane_cell(points, *circles, cell) for cell in range(len(points))])


def sampled(plane: Rectangle, points: Array, side: int) -> tuple[Array, Array]:
    """Areas and energies (n,) by a lattice of side x side places, each given to the nearest image of a generator."""
    places = np.stack(np.meshgrid(*((np.arange(side) + 0.5) / side * length for length in plane.lengths)), axis=-1)
    places = places.reshape(-1, 2)
    ways = places[:, None] - points[None, :, :2]
    for axis, repeats in enumerate(plane.repeats):
        if repeats:
            ways[..., axis] -= plane.lengths[axis] * np.rint(ways[..., axis] / plane.lengths[axis])
    squares = (ways**2).sum(axis=-1)
    nearest, part = squares.argmin(axis=1), plane.area / side**2
    return np.bincount(nearest, minlength=len(points)) * part, np.bincount(nearest, squares.min(axis=1)) * part


@pytest.mark.parametrize("plane", PLANES, ids=lambda plane: plane.periodic)
def test_cells_are_those_of_the_nearest_generators(plane: Rectangle) -> None:
    points = starting_points(plane, 60, start="random", seed=3)
    found = moments(PlaneCells(points, plane), points)
    areas, energies = sampled(plane, points, 300)
    assert found[:, 0].sum() == pytest.approx(plane.area, rel=1e-13)
    np.testing.assert_allclose(found[:, 0], areas, atol=0.02 * plane.area / 60)
    np.testing.assert_allclose(found[:, 3], energies, rtol=0.05)


@pytest.mark.parametrize("plane", PLANES, ids=lambda plane: plane.periodic)
def test_cells_follow_generators_on_their_way(plane: Rectangle) -> None:
    """Beyond seams too, in steps small and large, cells are those made anew."""
    random = np.random.default_rng(1)
    points = starting_points(plane, 100, start="random", seed=2)
    cells = PlaneCells(points, plane)
    for size in (0.01, 0.05, 0.2, 0.05, 1.0):
        previous, points = points, points + flat(size * random.normal(size=(100, 2)))
        cells.update(points, previous)
        expected = moments(PlaneCells(points.copy(), plane), points)
        np.testing.assert_allclose(moments(cells, points), expected, rtol=1e-9, atol=1e-12)
        assert expected[:, 0].sum() == pytest.approx(plane.area, rel=1e-12)


def test_triangles_are_those_of_scipy() -> None:
    plane = Rectangle(3.0, 2.0, "none")
    points = starting_points(plane, 200, start="random", seed=4)
    cells = PlaneCells(points, plane)
    places = np.concatenate([points[:, :2], cells.images.places(points)])
    expected = {tuple(sorted(map(int, triangle))) for triangle in Delaunay(places).simplices if triangle.min() < 200}
    found = {tuple(sorted(map(int, triangle))) for triangle in cells.triangles if triangle.min() < 200}
    # Round vertices on walls four generators stand on one circle, which either diagonal may divide.
    images = cells.images.numbers
    inner = {each for each in expected if all(corner < 200 for corner in each)}
    assert len(images) > 100
    assert len(inner) > 300
    assert inner == {each for each in found if all(corner < 200 for corner in each)}


@pytest.mark.parametrize("plane", PLANES, ids=lambda plane: plane.periodic)
def test_points_fold_into_the_rectangle(plane: Rectangle) -> None:
    points = flat(np.random.default_rng(0).uniform(-9.0, 9.0, (200, 2)))
    inside = plane.folded(points)
    assert (inside[:, :2] >= 0.0).all()
    assert (inside[:, :2] <= plane.lengths).all()
    np.testing.assert_allclose(plane.folded(inside), inside)
    mirrored = points * [1.0 if plane.repeats[0] else -1.0, 1.0 if plane.repeats[1] else -1.0, 1.0]
    np.testing.assert_allclose(plane.folded(mirrored), inside, atol=1e-12)


def test_rows_are_nearly_hexagons() -> None:
    for plane in PLANES:
        for count in (7, 100, 1001):
            points = rows_of_points(plane, count)
            assert len(np.unique(points, axis=0)) == count
            assert (plane.folded(points) == points).all()
    distances = np.linalg.norm(points[:, None] - points[None], axis=-1) + np.diag(np.full(count, 9.0))
    assert distances.min() > 0.8 * plane.spacing(count)

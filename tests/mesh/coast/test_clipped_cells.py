"""Clipped cells: they fill the sea, and the gradient of their energy is that of the optimiser."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mesh.arrays import Array
from mesh.coast.coastline import Coastline
from mesh.coast.sea_cells import SeaCells
from mesh.coast.start import fillers, sea_spacing
from mesh.density.named import uniform
from mesh.geometry.sphere import fibonacci_points, normalize
from mesh.integrals.moments import evaluate, number_of_blocks
from mesh.integrals.weighted_moments import WeightedCells
from tests.mesh.coast.shores import POLE, RADIUS, cells_of_sea, converged, wavy_ring, wavy_sea


def energy_and_moments(points: Array, sea: SeaCells) -> tuple[float, Array]:
    """Energy, and the gradient (n, 3) along the sphere, without the scales of the optimiser."""
    n = len(points)
    gradient, scales, partials = np.empty((n, 3)), np.empty(n), np.empty((number_of_blocks(n), 3))
    evaluate(
        points,
        sea.circumcenters,
        sea.ring_starts,
        sea.rings,
        np.zeros((n, 3)),
        np.ones(n),
        gradient,
        scales,
        partials,
    )
    return float(partials[:, 0].sum()), gradient / scales[:, None]


def masses(points: Array, sea: SeaCells) -> Array:
    cells = WeightedCells(uniform, len(points))
    return cells.integrate(points, sea.circumcenters, sea.ring_starts, sea.rings)[:, 0]


def at_sea(sea: SeaCells, count: int) -> Array:
    samples = fibonacci_points(count)
    samples = samples[samples @ POLE > np.cos(1.2 * RADIUS)]
    inside: NDArray[np.bool_] = sea.coastline.contains(samples)
    return samples[inside]


@pytest.mark.parametrize("start", ["fibonacci", "random"])
def test_areas_of_cells_sum_to_that_of_the_sea(start: str) -> None:
    coast = wavy_sea(600)
    points, sea = cells_of_sea(coast, 600, start)
    area = masses(points, sea)
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(coast.area, rel=1e-6 if start == "random" else 1e-9)
    settled = converged(coast, 600, 1e-3)
    assert masses(settled.result.points, settled.sea).sum() == pytest.approx(coast.area, rel=1e-9)


def test_masses_are_those_of_the_nearest_samples() -> None:
    points, sea = cells_of_sea(wavy_sea(60), 60)
    samples = at_sea(sea, 400_000)
    counts = np.bincount(cKDTree(points).query(samples)[1], minlength=60)
    np.testing.assert_allclose(masses(points, sea), counts * (4.0 * np.pi / 400_000), rtol=0.01, atol=2e-4)


def test_gradient_is_that_of_the_energy() -> None:
    points, sea = cells_of_sea(wavy_sea(60), 60)
    energy, gradient = energy_and_moments(points, sea)
    generator = np.random.default_rng(3)
    for _ in range(5):
        direction = generator.normal(size=points.shape)
        direction -= (direction * points).sum(axis=1)[:, None] * points
        step, values = 1e-5, []
        for sign in (1.0, -1.0):
            moved = normalize(points + sign * step * direction)
            sea.update(moved, points)
            values.append(energy_and_moments(moved, sea)[0])
        slope = (values[0] - values[1]) / (2.0 * step)
        assert slope == pytest.approx(float((gradient * direction).sum()), rel=1e-6, abs=1e-9 * energy)


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_energy_falls_until_generators_are_centroids(method: str) -> None:
    found = converged(wavy_sea(300), 300, 1e-6 if method == "lbfgs" else 1e-3, method)
    history = found.result.history
    assert found.result.reason == "tolerance"
    assert np.diff(history.energy).max() < 1e-13 * history.energy[0]
    assert found.sea.coastline.contains(found.result.points).all()
    samples = at_sea(found.sea, 400_000)
    _, nearest = cKDTree(found.result.points).query(samples)
    sums = np.stack([np.bincount(nearest, samples[:, k], 300) for k in range(3)], axis=1)
    distance = np.linalg.norm(normalize(sums) - found.result.points, axis=1)
    assert distance.max() < 0.03 * sea_spacing(found.sea.coastline, 300)


def test_cells_under_a_density_are_smaller_where_it_is_larger() -> None:
    found = converged(wavy_sea(400), 400, 1e-4, density=lambda x: 8.5 + 7.5 * np.tanh(20.0 * (x[:, 2] - 0.65)))
    points = found.result.points
    area = masses(points, found.sea)
    dense, rest = points[:, 2] > 0.75, points[:, 2] < 0.55
    assert 3.0 < np.median(area[rest]) / np.median(area[dense]) < 5.0


def test_an_island_within_a_cell_is_left_out_of_it() -> None:
    first = wavy_sea(60, island=False)
    points, sea = cells_of_sea(first, 60, "fibonacci")
    longitude, latitude = np.arctan2(points[30, 1], points[30, 0]), np.arcsin(points[30, 2])
    island = wavy_ring(20, (longitude, latitude + 0.02), 0.01, 0.0, sea_within=False)
    coast = Coastline([first.points, island])
    pierced = SeaCells(points, coast, fillers(coast, sea_spacing(coast, 60)))
    assert pierced.loops[30] == 2
    lost = masses(points, sea) - masses(points, pierced)
    assert lost[30] == pytest.approx(first.area - coast.area, rel=1e-6)
    np.testing.assert_allclose(np.delete(lost, 30), 0.0, atol=1e-15)

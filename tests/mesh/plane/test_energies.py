"""Energies of centroidal Voronoi tessellations of planes: ten generators in a square, and regular hexagons."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mesh import hexagon_mesh
from mesh.arrays import Array
from mesh.generation.optimizer import Limits, ScvtResult
from mesh.integrals.plane_centroids import plane_centroids
from mesh.plane.domain import Rectangle
from mesh.plane.generation import converge_on_plane
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points

TOLERANCE = 1e-10
LOWEST, OTHER = 0.016992964761, 0.017062174466
"""Energies of the local minima with ten generators that random starts lead to: rows of 3, 4, 3 and of 4, 3, 3."""

HEXAGON = 5.0 / (18.0 * np.sqrt(3.0))
"""Energy of a regular hexagon of area one."""


def ten_generators(seed: int, method: str = "lbfgs") -> tuple[ScvtResult, Rectangle]:
    square = Rectangle(1.0, 1.0, "none")
    start = starting_points(square, 10, start="random", seed=seed)
    return converge_on_plane(start, square, method, limits=Limits(TOLERANCE)), square


def row_sizes(places: Array) -> list[int]:
    """How many of the places (n,) are in each of the rows that gaps part."""
    gaps = np.flatnonzero(np.diff(np.sort(places)) > 0.2)
    return np.diff([0, *(gaps + 1), len(places)]).tolist()


def mean_square_distance(points: Array) -> float:
    """The energy of points (n, 3) of the unit square, from distances of a grid to the nearest."""
    middles = (np.arange(300) + 0.5) / 300
    grid = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    return float((cKDTree(points[:, :2]).query(grid)[0] ** 2).mean())


def test_random_starts_of_ten_generators_reach_the_lowest_energy_or_one_other() -> None:
    results = [ten_generators(seed)[0] for seed in range(12)]
    assert {result.reason for result in results} == {"tolerance"}
    energies = np.array([result.history.energy[-1] for result in results])
    lowest, other = np.abs(energies - LOWEST) < 1e-11, np.abs(energies - OTHER) < 1e-11
    assert (lowest | other).all()
    assert lowest.any()
    assert other.any()
    best = Rectangle(1.0, 1.0, "none").folded(results[int(np.argmin(energies))].points)
    assert [3, 4, 3] in [row_sizes(best[:, axis]) for axis in range(2)]
    assert mean_square_distance(best) == pytest.approx(LOWEST, abs=5e-6)


def test_lloyd_falls_at_every_iteration_and_ends_on_centroids() -> None:
    result, square = ten_generators(4, "lloyd")
    assert result.reason == "tolerance"
    falls = -np.diff(result.history.energy)
    assert (falls[: len(falls) // 2] > 0.0).all()
    assert falls.min() >= -1e-15 * result.history.energy[0]
    mesh = plane_mesh(result.points, square)
    off = np.linalg.norm(plane_centroids(mesh) - mesh.cell_points, axis=1).max()
    assert off < TOLERANCE * square.spacing(10)
    assert mesh.area_cell.sum() == pytest.approx(1.0, rel=1e-14)
    # L-BFGS goes to the same one.
    assert ten_generators(4)[0].history.energy[-1] == pytest.approx(result.history.energy[-1], rel=1e-13)


def test_regular_hexagons_have_the_least_energy_to_round_off() -> None:
    mesh = hexagon_mesh((40.0, 36.0 * np.sqrt(0.75)), (40, 36))
    plane = Rectangle(mesh.x_period, mesh.y_period, "xy")
    result = converge_on_plane(mesh.cell_points, plane)
    assert result.history.iterations == 0
    least = mesh.n_cells * HEXAGON * (plane.area / mesh.n_cells) ** 2
    assert result.history.energy[0] == pytest.approx(least, rel=1e-13)


@pytest.mark.parametrize(("periodic", "highest"), [("xy", 1.015), ("none", 1.018)])
def test_converged_energies_are_a_little_above_that_of_hexagons(periodic: str, highest: float) -> None:
    plane = Rectangle(1.0, 1.0, periodic)
    start = starting_points(plane, 1000, start="random", seed=1)
    result = converge_on_plane(start, plane, limits=Limits(1e-5))
    assert 1.0 < result.history.energy[-1] / (HEXAGON / 1000) < highest

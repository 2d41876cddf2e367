"""Where a density is constant, and integrals that make use of it, against quadrature everywhere."""

from collections.abc import Callable

import numba
import numpy as np
import pytest

from mesh.arrays import Array
from mesh.density.named import NAMED
from mesh.density.plateaus import FEWEST_CELLS, Plateaus, plateaus_of
from mesh.geometry.cube import patch_centers
from mesh.geometry.sphere import fibonacci_points
from mesh.integrals.weighted_moments import WeightedCells
from mesh.triangulation.moving import Triangulation


class Counted:
    """A density that counts the points it was asked for."""

    def __init__(self, name: str) -> None:
        self.density, self.count = NAMED[name], 0

    def __call__(self, points: Array) -> Array:
        self.count += len(points)
        return self.density(points)


@pytest.mark.parametrize("resolution", [24, 25])
@pytest.mark.parametrize("jump_along", [lambda points: points[:, 2] > 0.1, lambda points: points[:, 0] > points[:, 1]])
def test_all_within_reach_has_the_value_of_the_patch(jump_along: Callable[[Array], Array], resolution: int) -> None:
    """A jump within faces, and one along their common sides, of which no patch has both sides but on its border."""
    plateaus = Plateaus(lambda points: np.where(jump_along(points), 2.0, 1.0), resolution)
    known = np.flatnonzero(plateaus.reaches > 0.0)
    assert len(known) > 0.5 * len(plateaus.reaches)
    points = fibonacci_points(20_000)
    values = np.where(jump_along(points), 2.0, 1.0)
    for patch in known[::11]:
        near = np.linalg.norm(points - patch_centers(resolution)[patch], axis=1) <= plateaus.reaches[patch]
        assert (values[near] == plateaus.values[patch]).all()


def test_a_density_without_plateaus_and_a_coarse_mesh_have_none() -> None:
    assert plateaus_of(NAMED["smooth-transition"], 4 * FEWEST_CELLS) is None
    assert plateaus_of(NAMED["uniform"], FEWEST_CELLS - 1) is None
    uniform = plateaus_of(NAMED["uniform"], FEWEST_CELLS)
    assert uniform is not None
    assert uniform.reaches.min() > 0.3


@pytest.mark.parametrize("name", ["refined-circle", "refined-box", "uniform"])
def test_integrals_with_plateaus_are_those_of_quadrature(name: str) -> None:
    points = fibonacci_points(6000)
    cells = Triangulation(points)
    mesh = (points, cells.circumcenters, cells.ring_starts, cells.rings)
    plain, density = WeightedCells(NAMED[name], len(points)), Counted(name)
    quick = WeightedCells(density, len(points), often=True)
    density.count = 0
    sums, expected = quick.integrate(*mesh), plain.integrate(*mesh)
    assert density.count < 0.4 * 42 * len(points)
    np.testing.assert_allclose(sums[:, [0, 4]], expected[:, [0, 4]], rtol=1e-10)
    np.testing.assert_allclose(sums[:, 5], expected[:, 5], rtol=1e-6)
    np.testing.assert_allclose(sums[:, 1:4], expected[:, 1:4], atol=1e-9 * expected[:, 0].max())


def test_integrals_do_not_depend_on_the_number_of_threads() -> None:
    points = fibonacci_points(6000)
    cells = Triangulation(points)
    mesh = (points, cells.circumcenters, cells.ring_starts, cells.rings)
    results, threads = [], numba.get_num_threads()
    for count in (1, threads):
        numba.set_num_threads(count)
        results.append(WeightedCells(NAMED["refined-box"], len(points), often=True).integrate(*mesh).copy())
    np.testing.assert_array_equal(*results)

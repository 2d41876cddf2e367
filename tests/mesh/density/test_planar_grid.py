"""Densities from grids of x and y: which value is where, what holds beyond the grid, and smoothing."""

from pathlib import Path

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.density.gridded import Shaping
from mesh.density.planar import named_on_plane
from mesh.density.planar_grid import read_density_on_plane
from tests.mesh.density.density_files import Variable, write_file

X, Y = np.array([0.0, 1.0, 3.0, 4.0]), np.array([10.0, 20.0, 25.0])
VALUES = 1.0 + X + 2.0 * Y[:, None] + 0.5 * X * Y[:, None]
"""Bilinear, and neither axis is like the other."""


def write_values(path: Path, turned: bool = False, step: tuple[int, int] = (1, 1), values: Array = VALUES) -> Path:
    """A file with the values at Y and X, whose order is that of the `step` of each."""
    values = values[:: step[0], :: step[1]]
    dimensions, values = (("x", "y"), values.T) if turned else (("y", "x"), values)
    axes: dict[str, Variable] = {"x": (("x",), X[:: step[1]], {}), "y": (("y",), Y[:: step[0]], {})}
    return write_file(path, density=(dimensions, values, {}), **axes)


def at(x: float, y: float) -> Array:
    return np.array([[x, y, 0.0]])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("step", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_values_are_where_the_file_has_them(tmp_path: Path, turned: bool, step: tuple[int, int]) -> None:
    density = read_density_on_plane(write_values(tmp_path / "grid.nc", turned, step), "density", Shaping())
    for x, y in ((0.0, 10.0), (3.0, 25.0), (2.0, 13.0), (3.5, 21.0)):
        assert density(at(x, y)) == pytest.approx(1.0 + x + 2.0 * y + 0.5 * x * y, rel=1e-14)


def test_beyond_the_grid_the_nearest_value_holds(tmp_path: Path) -> None:
    density = read_density_on_plane(write_values(tmp_path / "grid.nc"), "density", Shaping())
    for beyond, nearest in (((-1.0, 12.0), (0.0, 12.0)), ((9.0, 99.0), (4.0, 25.0)), ((1.5, 0.0), (1.5, 10.0))):
        np.testing.assert_array_equal(density(at(*beyond)), density(at(*nearest)))


def test_smoothing_takes_half_of_the_neighbours(tmp_path: Path) -> None:
    values = np.zeros((3, 4))
    values[0, 0], values[1, 2] = 8.0, 16.0
    path = write_values(tmp_path / "grid.nc", values=values)
    density = read_density_on_plane(path, "density", Shaping(smoothing=1))
    found = [[density(at(x, y))[0] for x in X] for y in Y]
    # In the corner two of the four neighbours are beyond the edges, where it stands for them itself.
    np.testing.assert_allclose(found, [[6.0, 1.0, 2.0, 0.0], [1.0, 2.0, 8.0, 2.0], [0.0, 0.0, 2.0, 0.0]], atol=1e-14)


@pytest.mark.parametrize("lengths", [(10.0, 30.0), (30.0, 10.0)])
def test_the_refined_circle_is_in_the_middle_and_a_fifth_of_the_shorter_length(lengths: tuple[float, float]) -> None:
    density = named_on_plane("refined-circle", np.array(lengths))
    assert density is not None
    for axis in range(2):
        distances = np.array([0.0, 1.99, 2.5, 3.0, 4.9])
        points = np.zeros((5, 3))
        points[:, :2] = 0.5 * np.array(lengths)
        points[:, axis] -= distances
        np.testing.assert_allclose(density(points), [81.0, 81.0, 16.0, 1.0, 1.0], rtol=1e-12)

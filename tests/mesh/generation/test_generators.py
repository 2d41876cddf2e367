import numpy as np
import pytest

import mesh.generation.generators
from mesh import MeshError
from mesh.generation.generators import (
    MAXIMUM_CELLS,
    icosahedral_level,
    icosahedral_mesh,
    icosahedral_points,
    refine,
    starting_points,
)
from mesh.geometry.sphere import fibonacci_points, triangle_area


@pytest.mark.parametrize("level", [0, 1, 2, 3])
def test_bisection_gives_unit_points_in_the_known_number(level: int) -> None:
    points = icosahedral_points(level)
    assert len(points) == 10 * 4**level + 2
    assert icosahedral_level(len(points)) == level
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)
    np.testing.assert_allclose(points.sum(axis=0), 0.0, atol=1e-12)


def test_each_level_keeps_the_points_of_the_one_before() -> None:
    coarse, fine = icosahedral_points(1), icosahedral_points(2)
    np.testing.assert_array_equal(fine[: len(coarse)], coarse)


@pytest.mark.parametrize("cells", [162, 163, 165, 242])
def test_refined_mesh_has_any_number_of_cells_and_covers_the_sphere_once(cells: int) -> None:
    points, triangles = refine(*icosahedral_mesh(1), cells)
    assert points.shape == (cells, 3)
    assert triangles.shape == (2 * cells - 4, 3)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)
    areas = triangle_area(*(points[triangles[:, k]] for k in range(3)))
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(4.0 * np.pi, rel=1e-12)
    assert len(np.unique(triangles)) == cells


def test_fibonacci_points_are_spread_evenly() -> None:
    points = fibonacci_points(1000)
    cosines = points @ points.T - 2 * np.eye(1000)
    nearest = np.arccos(cosines.max(axis=1))
    assert nearest.max() / nearest.min() < 1.6


def test_default_start_follows_the_number() -> None:
    np.testing.assert_array_equal(starting_points(162), icosahedral_points(2))
    np.testing.assert_array_equal(starting_points(163), fibonacci_points(163))


@pytest.mark.parametrize(
    ("cells", "start", "words"),
    [
        (11, None, "11 cells is too small"),
        (-3, None, "too small"),
        (100, "icosahedral", "choose 42 or 162"),
        (100, "cubed", "no start named 'cubed'"),
    ],
)
def test_wrong_requests_say_what_to_do(cells: int, start: str | None, words: str) -> None:
    with pytest.raises(MeshError, match=words):
        starting_points(cells, start)


def test_the_most_cells_are_those_whose_half_edges_have_numbers_of_32_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """n cells have 2 n - 4 triangles of three half-edges each."""
    assert 3 * (2 * MAXIMUM_CELLS - 4) < 2**31 <= 3 * (2 * (MAXIMUM_CELLS + 3) - 4)
    with pytest.raises(
        MeshError, match=f"mesh of {10**13} cells has too many half-edges to number; ask for at most 35"
    ):
        starting_points(10**13)
    monkeypatch.setattr(mesh.generation.generators, "MAXIMUM_CELLS", 20)
    assert len(starting_points(20)) == 20
    with pytest.raises(MeshError, match="mesh of 21 cells has too many half-edges to number; ask for at most 20"):
        starting_points(21)

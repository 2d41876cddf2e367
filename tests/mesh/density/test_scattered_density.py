from pathlib import Path

import numpy as np
import pytest
from density_files import field, write_file

from mesh import MeshError, mesh_quality, scvt_mesh
from mesh.density.gridded import read_density
from mesh.density.scattered import _walk, density_from_cells, density_from_points
from mesh.geometry.sphere import fibonacci_points, normalize, to_lonlat
from mesh.triangulation.delaunay import delaunay


def random_points(count: int, seed: int = 0) -> np.ndarray:
    return normalize(np.random.default_rng(seed).normal(size=(count, 3)))


def smooth(points: np.ndarray) -> np.ndarray:
    return field(*np.degrees(to_lonlat(points)))


@pytest.mark.parametrize("centers", [fibonacci_points(12), random_points(300), fibonacci_points(3000)])
def test_exact_at_centres_and_never_beyond_the_values(centers: np.ndarray) -> None:
    values = np.exp(np.random.default_rng(1).normal(size=len(centers)) * 100.0)
    density = density_from_cells(centers, values)
    np.testing.assert_array_equal(density(centers), values)
    between = density(random_points(2000, 2))
    assert values.min() <= between.min() < between.max() <= values.max()


def test_error_has_second_order() -> None:
    probes = random_points(5000, 3)
    errors = [
        np.abs(density_from_cells(centers, smooth(centers))(probes) - smooth(probes)).max()
        for centers in (fibonacci_points(400), fibonacci_points(6400))
    ]
    assert errors[0] < 0.03
    assert np.log(errors[0] / errors[1]) / np.log(4.0) == pytest.approx(2.0, abs=0.3)


def test_means_are_those_of_plane_triangles() -> None:
    """An octahedron: in the octant of positive coordinates the shares are those coordinates over their sum."""
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    points = np.abs(random_points(50))
    density = density_from_cells(corners, np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]))
    np.testing.assert_allclose(density(points), points @ [1.0, 2.0, 4.0] / points.sum(axis=1), rtol=1e-14)
    np.testing.assert_allclose(density(-points), points @ [8.0, 16.0, 32.0] / points.sum(axis=1), rtol=1e-14)


def test_nothing_jumps() -> None:
    """Along a circle in steps a thousand times smaller than the cells, changes are as small."""
    centers = random_points(642, 5)
    angle = np.linspace(0.0, 2.0 * np.pi, 200_001)
    a, b = normalize(np.array([[1.0, 2.0, 3.0], [3.0, 0.0, -1.0]]))
    circle = np.cos(angle)[:, None] * a + np.sin(angle)[:, None] * b
    change = np.abs(np.diff(density_from_cells(centers, random_points(642, 6)[:, 0] + 2.0)(circle)))
    assert 0.0 < change.max() < 0.01


def test_walk_that_goes_nowhere_ends_in_the_right_triangle() -> None:
    """Where twins lead back, all triangles are tried."""
    centers, probes = random_points(50, 7), random_points(30, 8)
    triangles = delaunay(centers)
    astray = np.repeat(3 * np.arange(96, dtype=np.int32)[:, None], 3, axis=1)
    for probe in range(30):
        a, b, c = centers[triangles[_walk(probes, probe, centers, triangles, astray, 5)]]
        assert min(np.linalg.det([b, c, probes[probe]]), np.linalg.det([c, a, probes[probe]])) >= 0.0
        assert np.linalg.det([a, b, probes[probe]]) >= 0.0


def test_points_that_coincide_are_one() -> None:
    centers = fibonacci_points(100)
    twice = np.concatenate([centers, centers[:10]])
    values = np.concatenate([smooth(centers), np.full(10, 99.0)])
    np.testing.assert_array_equal(density_from_points(twice, values, "field")(centers), smooth(centers))


def test_too_few_points_of_a_region_are_refused() -> None:
    with pytest.raises(MeshError, match=r"field lies on points that do not go round the sphere .*in one hemisphere"):
        density_from_points(normalize(np.add(fibonacci_points(12), [5.0, 0.0, 0.0])), np.ones(12), "field")


@pytest.mark.parametrize("scale", [1.0, 1e-300, 1e300])
def test_mesh_converges_under_a_density_on_cells(scale: float, tmp_path: Path) -> None:
    centers = fibonacci_points(200)
    cells = {f"{axis}Cell": (("nCells",), centers[:, k], {}) for k, axis in enumerate("xyz")}
    values = 1.0 + 8.0 * np.exp(-4.0 * (1.0 - centers[:, 0]))
    path = write_file(tmp_path / "cells.nc", **cells, meshDensity=(("nCells",), scale * values, {}))
    mesh = scvt_mesh(162, density=read_density(path, "meshDensity"))
    quality = mesh_quality(mesh)
    assert quality.residual < 1.1e-6
    assert quality.area_ratio == pytest.approx(3.3, abs=0.3)

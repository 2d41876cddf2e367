"""Meshes that the tests share, made once a session."""

import numpy as np
import pytest

from mesh import VoronoiMesh, mesh_from_points, scvt_mesh


def random_mesh(cells: int, seed: int) -> VoronoiMesh:
    """Voronoi mesh of uniformly random points: obtuse triangles, cells with 3 to 11 edges."""
    return mesh_from_points(np.random.default_rng(seed).normal(size=(cells, 3)))


def stretched_mesh(cells: int) -> VoronoiMesh:
    """SCVT moved towards one point, so that cell widths vary by about three."""
    points = scvt_mesh(cells, start="fibonacci", tolerance=1e-6).cell_points
    points = points + np.array([0.3, -0.35, 0.2])
    return mesh_from_points(points)


@pytest.fixture(scope="session")
def icosahedral_mesh() -> VoronoiMesh:
    return scvt_mesh(642)


@pytest.fixture(scope="session")
def larger_mesh() -> VoronoiMesh:
    return scvt_mesh(2562)


@pytest.fixture(scope="session", params=["icosahedral", "octahedron-like", "random", "stretched"])
def any_mesh(request: pytest.FixtureRequest, icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    """One mesh of each family; identities must hold on all."""
    if request.param == "icosahedral":
        return icosahedral_mesh
    if request.param == "random":
        return random_mesh(500, seed=1)
    if request.param == "stretched":
        return stretched_mesh(600)
    grid = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float)
    return mesh_from_points(grid)

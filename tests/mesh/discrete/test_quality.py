import numpy as np
import pytest

from mesh import mesh_from_points, mesh_quality
from mesh.generation.generators import icosahedral_points, icosahedron
from mesh.geometry.sphere import triangle_area

BISECTION = {  # mu, sigma_avg, sigma_min, q_avg, q_min of recursive bisection, two independent programs
    42: (1.130826, 0.917364, 0.884309, 0.987163, 0.982884),
    162: (1.177653, 0.880883, 0.858862, 0.986547, 0.972995),
    642: (1.190652, 0.873666, 0.848162, 0.986552, 0.970155),
    2562: (1.193992, 0.880362, 0.840483, 0.986564, 0.969422),
}


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_quality_of_bisection(level: int) -> None:
    measured = mesh_quality(mesh_from_points(icosahedral_points(level)))
    found = (measured.mu, measured.sigma_avg, measured.sigma_min, measured.q_avg, measured.q_min)
    np.testing.assert_allclose(found, BISECTION[measured.cells], atol=1.1e-6)


def test_icosahedron_is_perfect() -> None:
    measured = mesh_quality(mesh_from_points(icosahedron()))
    for value in (measured.mu, measured.sigma_avg, measured.sigma_min, measured.q_avg, measured.q_min):
        assert value == pytest.approx(1.0, abs=1e-14)
    assert measured.obtuse == 0
    assert measured.residual < 1e-14


def test_obtuse_triangles_are_those_whose_circumcentre_lies_outside() -> None:
    mesh = mesh_from_points(np.random.default_rng(0).normal(size=(2000, 3)))
    corners = mesh.cell_points[mesh.cells_on_vertex]
    parts = [triangle_area(mesh.vertex_points, corners[:, k], corners[:, (k + 1) % 3]) for k in range(3)]
    outside = (np.array(parts) < 0).any(axis=0)
    # The circle lies in a plane parallel to the triangle's: the two notions agree on the sphere as in the plane.
    assert mesh_quality(mesh).obtuse == outside.sum()
    assert outside.sum() > 500


def test_quality_does_not_depend_on_the_radius() -> None:
    mesh = mesh_from_points(icosahedral_points(2))
    unit, earth = mesh_quality(mesh), mesh_quality(mesh.scaled(6371220.0))
    assert earth.mu == pytest.approx(unit.mu, rel=1e-12)
    assert earth.residual == pytest.approx(unit.residual, rel=1e-9)

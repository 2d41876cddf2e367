"""Balance in a thin layer, whose bottom carries the surface of test case 2, and how schemes keep it."""

import numpy as np
import pytest

from cases import Hollingsworth, Williamson2
from mesh import VoronoiMesh
from postprocess.compare.norms import scalar_norms
from swe import Simulation
from swe.configuration import SchemeName


def test_surface_is_that_of_test_case_2_but_for_a_constant() -> None:
    longitude, latitude = np.array([0.3, 4.6, 5.0, 0.0]), np.array([0.9, 0.5, -0.4, np.pi / 2])
    thin, deep = Hollingsworth(angle=0.4, depth=5.0), Williamson2(angle=0.4)
    np.testing.assert_array_equal(thin.thickness(longitude, latitude), np.full(4, 5.0))
    surface = thin.topography(longitude, latitude) + 5.0
    lower = deep.thickness(longitude, latitude) - surface
    np.testing.assert_allclose(lower, lower[0], rtol=1e-12)
    np.testing.assert_array_equal(thin.coriolis(longitude, latitude), deep.coriolis(longitude, latitude))
    np.testing.assert_array_equal(thin.velocity(longitude, latitude), deep.velocity(longitude, latitude))
    upright = Hollingsworth()
    bottom = upright.topography(np.zeros(2), np.array([0.0, np.pi / 2]))
    drop = (6371220.0 * 7.292e-5 * upright.wind_speed + 0.5 * upright.wind_speed**2) / 9.80616
    np.testing.assert_allclose(bottom, [drop, 0.0], rtol=1e-12, atol=1e-9)


def departure(mesh: VoronoiMesh, depth: float, day: float, scheme: SchemeName, dissipation: float = 0.0) -> float:
    """The relative l2 departure of the normal velocity from the steady state on a day."""
    simulation = Simulation(mesh, Hollingsworth(depth=depth), scheme=scheme, dissipation=dissipation)
    start = simulation.state.copy()
    simulation.run(until=day, progress=False)
    area = simulation.mesh.dc_edge * simulation.mesh.dv_edge
    return scalar_norms(simulation.state.normal_velocity, start.normal_velocity, area).l2


@pytest.mark.parametrize(
    ("depth", "day", "expected"), [(50.0, 10.0, (1.17e-2, 3.13e-3)), (5.0, 16.0, (6.89e-2, 8.06e-3))]
)
def test_departure_grows_less_with_the_consistent_scheme(
    larger_mesh: VoronoiMesh, depth: float, day: float, expected: tuple[float, float]
) -> None:
    """Measured elsewhere as 1.2e-2 and 3.2e-3, 6.9e-2 and 8.2e-3; at least three times smaller is asked for."""
    found = (departure(larger_mesh, depth, day, "ringler2010"), departure(larger_mesh, depth, day, "consistent"))
    assert found == pytest.approx(expected, rel=0.05)
    assert found[0] > 3.0 * found[1]


def test_dissipation_slows_the_growth(larger_mesh: VoronoiMesh) -> None:
    assert departure(larger_mesh, 5.0, 10.0, "ringler2010", 1e16) < 0.5 * departure(
        larger_mesh, 5.0, 10.0, "ringler2010"
    )

import numpy as np
import pytest

from cases import CASES, Case, Williamson2, Williamson5, find_case
from mesh import VoronoiMesh, build_operators
from swe.errors import SetupError
from swe.tendency import tendency


def test_every_case_is_found_by_its_name_and_documented() -> None:
    assert set(CASES) == {"williamson2", "williamson5"}
    for name, kind in CASES.items():
        case = find_case(name)
        assert isinstance(case, kind)
        assert case.name == name
        assert case.title
        assert "doi.org" in case.reference
        assert case.recommended_days > 0
        assert case.parameters()["radius"] == 6371220.0


def test_unknown_case_is_refused_with_the_choices() -> None:
    with pytest.raises(SetupError, match="no case named 'tc5'; choose one of williamson2, williamson5"):
        find_case("tc5")


@pytest.mark.parametrize("case", [Williamson2(), Williamson2(angle=0.7), Williamson5()], ids=str)
def test_flow_has_no_divergence(case: Case, icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh.scaled(case.radius)
    u = case.initial_state(mesh).normal_velocity
    divergence = build_operators(mesh).divergence @ u
    assert np.abs(divergence).max() < 1e-14 * np.abs(u).max() / mesh.dc_edge.min() * 100


@pytest.mark.parametrize("angle", [0.0, 0.05, np.pi / 2 - 0.05, np.pi / 2])
def test_steady_flow_is_balanced_at_any_angle(
    angle: float, icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh
) -> None:
    case = Williamson2(angle=angle)
    rates = []
    for mesh in (icosahedral_mesh, larger_mesh):
        mesh = mesh.scaled(case.radius)
        state = case.initial_state(mesh)
        rate = tendency(state, build_operators(mesh), case.topography_on(mesh), case.coriolis_on(mesh), case.gravity)
        coriolis_force = 2 * case.rotation_rate * case.wind_speed
        rates.append(np.sqrt(np.mean(rate.normal_velocity**2)) / coriolis_force)
    assert rates[0] < 0.02
    assert rates[1] < 0.7 * rates[0]


def test_mountain_is_a_cone_of_the_given_height() -> None:
    case = Williamson5()
    lon = np.array([1.5 * np.pi, 1.5 * np.pi, 1.5 * np.pi + np.pi / 18, 0.0])
    lat = np.array([np.pi / 6, np.pi / 6 + np.pi / 9, np.pi / 6, np.pi / 6])
    np.testing.assert_allclose(case.topography(lon, lat), [2000.0, 0.0, 1000.0, 0.0], atol=1e-9)
    surface = case.thickness(lon, lat) + case.topography(lon, lat)
    np.testing.assert_allclose(surface[[0, 2, 3]], surface[0], rtol=1e-14)
    assert case.thickness(np.array([0.0]), np.array([0.0]))[0] == 5960.0


def test_mountain_may_stand_on_the_prime_meridian() -> None:
    case = Williamson5(mountain_longitude=0.0)
    east, west = case.topography(np.array([0.1, 2 * np.pi - 0.1]), np.array([0.5, 0.5]))
    assert east == pytest.approx(west)
    assert east > 0.0


def test_wind_blows_eastward_at_its_speed(larger_mesh: VoronoiMesh) -> None:
    from mesh.operators import velocity_at_cells

    case = Williamson5()
    mesh = larger_mesh.scaled(case.radius)
    zonal, meridional = velocity_at_cells(mesh, case.initial_state(mesh).normal_velocity)
    np.testing.assert_allclose(zonal, 20.0 * np.cos(mesh.lat_cell), atol=0.05)
    np.testing.assert_allclose(meridional, 0.0, atol=0.05)

"""States carried over to another mesh, and cases that go on from them."""

import numpy as np
import pytest

from cases import Williamson2, Williamson5
from cases.lake_at_rest import LakeAtRest
from mesh import VoronoiMesh
from mesh.discrete.operators import normal_velocity_from_streamfunction
from mesh.discrete.walls import wall_edges
from mesh.parts.cutting import without_cells
from postprocess.adaptation.carried import Continued, carried_over
from swe import Forcing, Simulation
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError
from swe.state import State
from tests.conftest import stretched_mesh


@pytest.fixture(scope="module")
def stretched() -> VoronoiMesh:
    return stretched_mesh(642)


@pytest.fixture(scope="module")
def both(icosahedral_mesh: VoronoiMesh, stretched: VoronoiMesh) -> tuple[VoronoiMesh, VoronoiMesh]:
    radius = Williamson5().radius
    return icosahedral_mesh.scaled(radius), stretched.scaled(radius)


def test_mass_is_the_same_and_a_lake_stays_at_rest(both: tuple[VoronoiMesh, VoronoiMesh]) -> None:
    source, target = both
    case = LakeAtRest()
    state = case.initial_state(source, "point")
    carried = carried_over(case, state, source, target, "point")
    mass = source.area_cell @ state.thickness
    assert abs(target.area_cell @ carried.thickness - mass) < 1e-14 * mass
    surface = carried.thickness + case.topography_on(target, "point")
    assert np.ptp(surface) < 1e-9
    np.testing.assert_array_equal(carried.normal_velocity, 0.0)


def test_a_steady_flow_is_carried_over_to_second_order(
    icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh, stretched: VoronoiMesh
) -> None:
    case = Williamson2()
    largest_speed = 2.0 * np.pi * case.radius / (12.0 * SECONDS_PER_DAY)
    target = stretched.scaled(case.radius)
    exact = largest_speed * np.cos(target.lat_edge) * np.cos(target.angle_edge)
    errors = []
    for mesh in (icosahedral_mesh, larger_mesh):
        source = mesh.scaled(case.radius)
        carried = carried_over(case, case.initial_state(source, "point"), source, target, "point")
        errors.append(np.sqrt(np.mean((carried.normal_velocity - exact) ** 2)))
    assert errors[1] < 0.03
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_the_bottom_must_stay_below_the_surface(both: tuple[VoronoiMesh, VoronoiMesh]) -> None:
    source, target = both
    state = State(np.full(source.n_cells, 1.0), np.zeros(source.n_edges))
    with pytest.raises(InputError, match="the bottom rises through the surface"):
        carried_over(Williamson5(), state, source, target, "point")


def test_a_case_goes_on_at_its_own_time(icosahedral_mesh: VoronoiMesh) -> None:
    asked: list[float] = []

    def pull(mesh: VoronoiMesh, state: State, time: float) -> np.ndarray:
        asked.append(time)
        return np.zeros(mesh.n_edges)

    class Pulled(Williamson2):
        def terms(self) -> tuple[Forcing, ...]:
            return (Forcing("pull", pull),)

    case = Pulled()
    mesh = icosahedral_mesh.scaled(case.radius)
    continued = Continued(case, 3.0, case.initial_state(mesh, "point"))
    (term,) = continued.terms()
    term.add(mesh, continued.state, 60.0, continued.state.empty_like())
    assert asked == [3.0 * SECONDS_PER_DAY + 60.0]
    assert continued.parameters()["first_day"] == 3.0


def test_another_mesh_is_refused(icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh) -> None:
    case = Williamson2()
    continued = Continued(case, 1.0, case.initial_state(icosahedral_mesh.scaled(case.radius), "point"))
    with pytest.raises(InputError, match="carry it over to this mesh"):
        Simulation(larger_mesh, continued)


def test_walls_let_nothing_through(icosahedral_mesh: VoronoiMesh, stretched: VoronoiMesh) -> None:
    case = Williamson2()
    source = icosahedral_mesh.scaled(case.radius)
    target = without_cells(stretched, stretched.z_cell < -0.3).scaled(case.radius)
    around = normal_velocity_from_streamfunction(source, source.z_vertex * 20.0)
    carried = carried_over(case, State(np.full(source.n_cells, 1000.0), around), source, target, "point")
    np.testing.assert_array_equal(carried.normal_velocity[wall_edges(target)], 0.0)
    assert np.abs(carried.normal_velocity).max() > 5.0
    # Seas of different area: the mean height of the surface is kept.
    assert target.area_cell @ carried.thickness == pytest.approx(1000.0 * target.area_cell.sum(), rel=1e-14)

"""What holds for every case: documentation, wind and vorticity of the streamfunction, balance."""

from pathlib import Path

import numpy as np
import pytest

from cases import (
    CASES,
    Case,
    Galewsky,
    Hollingsworth,
    LakeAtRest,
    Williamson1,
    Williamson2,
    Williamson5,
    Williamson6,
    find_case,
)
from cases.differences import gradient, laplacian
from cases.parameters import units_and_meanings
from mesh import VoronoiMesh, build_operators
from mesh.arrays import Array
from mesh.discrete.operators import normal_velocity_from_streamfunction
from swe import Simulation, State
from swe.errors import InputError

EVERY = [
    Williamson1(angle=0.7),
    Williamson2(angle=0.7),
    Williamson5(),
    Williamson6(),
    Galewsky(),
    Galewsky(perturbed=False),
    LakeAtRest(),
    Hollingsworth(angle=0.7),
]
BALANCED = [
    *(Williamson2(angle=angle) for angle in (0.0, 0.05, np.pi / 2 - 0.05, np.pi / 2)),
    Williamson6(),
    Galewsky(perturbed=False),
    *(Hollingsworth(angle=angle) for angle in (0.0, 0.7)),
]


def positions() -> tuple[Array, Array]:
    """Uniform over the sphere, both poles among them."""
    random = np.random.default_rng(1)
    latitude = np.concatenate([[np.pi / 2, -np.pi / 2], np.arcsin(random.uniform(-1, 1, 600))])
    return random.uniform(0.0, 2.0 * np.pi, len(latitude)), latitude


def test_every_case_is_found_by_its_name_and_documented() -> None:
    assert set(CASES) == {
        "williamson1",
        "williamson2",
        "williamson5",
        "williamson6",
        "galewsky",
        "lake-at-rest",
        "hollingsworth",
        "stommel",
        "munk",
        "kelvin-wave",
        "seiche",
        "double-gyre",
    }
    page = (Path(__file__).parents[2] / "docs" / "cases.md").read_text()
    for name, kind in CASES.items():
        case = find_case(name)
        assert type(case) is kind
        assert case.name == name
        assert "doi.org" in case.reference
        assert case.parameters()["radius"] == 6371220.0
        assert all(meaning for _, meaning in units_and_meanings(case).values())
        assert f"| `{name}` |" in page
        assert f"| {case.recommended_days:g} |" in page
        assert case.convergence_order is None or case.has_exact_solution


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_velocity_and_vorticity_are_those_of_the_streamfunction(case: Case) -> None:
    longitude, latitude = positions()
    expected = Case.velocity(case, longitude, latitude)
    speed = max(np.abs(np.hypot(*expected)).max(), 1.0)
    np.testing.assert_allclose(case.velocity(longitude, latitude), expected, atol=1e-5 * speed)
    vorticity = Case.vorticity(case, longitude, latitude)
    np.testing.assert_allclose(
        case.vorticity(longitude, latitude), vorticity, atol=1e-4 * max(np.abs(vorticity).max(), 1e-10)
    )
    assert isinstance(case, LakeAtRest) or np.abs(vorticity).max() > 1e-6


@pytest.mark.parametrize("case", BALANCED, ids=lambda case: case.name)
def test_divergence_does_not_start_to_change(case: Case) -> None:
    """The nonlinear balance: laplacian(g (h + b) + K) = (f + zeta) zeta + grad(f + zeta) . grad(psi)."""
    longitude, latitude = positions()

    def bernoulli(lon: Array, lat: Array) -> Array:
        zonal, meridional = case.velocity(lon, lat)
        surface = case.thickness(lon, lat) + case.topography(lon, lat)
        return case.gravity * surface + 0.5 * (zonal**2 + meridional**2)

    def absolute_vorticity(lon: Array, lat: Array) -> Array:
        return case.coriolis(lon, lat) + case.vorticity(lon, lat)

    steepness = gradient(absolute_vorticity, longitude, latitude)
    slope = gradient(case.streamfunction, longitude, latitude)
    force = absolute_vorticity(longitude, latitude) * case.vorticity(longitude, latitude)
    force += (steepness[0] * slope[0] + steepness[1] * slope[1]) / case.radius**2
    pressure = laplacian(bernoulli, longitude, latitude) / case.radius**2
    scale = np.abs(force).max()
    np.testing.assert_allclose(pressure, force, atol=1e-4 * scale)
    assert scale > 1e-10


def smooth(points: Array) -> Array:
    """A function with the scale of the sphere and no symmetry, at unit vectors (n, 3)."""
    return np.sin(points @ np.array([2.0, -1.0, 0.5])) + np.cos(points @ np.array([-0.5, 1.5, 2.0]))


def response(simulation: Simulation) -> tuple[float, float]:
    """Tendency of velocity (m/s2) along smooth flows, and root mean square of that of thickness (m/s)."""
    mesh, rate = simulation.mesh, simulation.state.empty_like()
    simulation.model.tendency(simulation.state, rate)
    unit = mesh.scaled(1.0)
    potential = smooth(unit.cell_points)[mesh.cells_on_edge]
    area = mesh.dc_edge * mesh.dv_edge
    along = []
    for flow in (
        normal_velocity_from_streamfunction(unit, smooth(unit.vertex_points)),
        (potential[:, 1] - potential[:, 0]) / unit.dc_edge,
    ):
        along.append(area @ (flow * rate.normal_velocity) / np.sqrt((area @ flow**2) * area.sum()))
    return float(np.hypot(*along)), float(np.sqrt(np.mean(rate.thickness**2)))


@pytest.mark.parametrize("case", [case for case in BALANCED if case.has_exact_solution], ids=lambda case: case.name)
def test_tendency_of_steady_flow_falls_from_mesh_to_mesh(
    case: Case, icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh
) -> None:
    """That of velocity with order two where it acts on smooth flows, that of thickness with order one.

    At single edges near the pentagons the kinetic energy of the scheme is not consistent: there the tendency of
    velocity does not fall, but it does not accumulate either.
    """
    coarse, fine = (response(Simulation(mesh, case)) for mesh in (icosahedral_mesh, larger_mesh))
    assert 3.0 < coarse[0] / fine[0] < 6.0
    uniform = isinstance(case, Hollingsworth)  # a flow without divergence leaves the layer as it is
    assert max(coarse[1], fine[1]) < 1e-15 if uniform else 2.0 < coarse[1] / fine[1] < 6.0
    assert coarse[0] < 1e-3 * 2 * case.rotation_rate * np.abs(case.velocity(*positions())[0]).max()


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_flow_has_no_divergence_on_a_mesh(case: Case, icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh.scaled(case.radius)
    u = case.initial_state(mesh).normal_velocity
    divergence = build_operators(mesh).divergence @ u
    assert np.abs(divergence).max() <= 1e-12 * np.abs(u).max() / mesh.dc_edge.min()


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_fields_at_points_and_as_means_differ_a_little(case: Case, icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh.scaled(case.radius)
    point, mean = (case.state_on(mesh, sampling=sampling) for sampling in ("point", "mean"))
    np.testing.assert_array_equal(mean.normal_velocity, point.normal_velocity)
    bottoms = [case.topography_on(mesh, sampling) for sampling in ("point", "mean")]
    difference = max(np.abs(mean.thickness - point.thickness).max(), np.abs(bottoms[1] - bottoms[0]).max())
    assert 0.0 < difference < 0.1 * np.abs(point.thickness + bottoms[0]).max()


class Plain(Case):
    """Nothing but what a case must say."""

    name = "plain"
    title = "Plain"
    recommended_days = 1.0

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        return 1000  # type: ignore[return-value]

    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        return -self.radius * 10.0 * np.sin(latitude)


def test_case_may_give_numbers_and_no_velocity(icosahedral_mesh: VoronoiMesh) -> None:
    case = Plain()
    state = Simulation(icosahedral_mesh, case).state
    np.testing.assert_array_equal(state.thickness, np.full(642, 1000.0))
    longitude, latitude = positions()
    zonal, meridional = case.velocity(longitude, latitude)
    np.testing.assert_allclose(zonal, 10.0 * np.cos(latitude), atol=1e-10)
    np.testing.assert_allclose(meridional, 0.0, atol=1e-10)
    np.testing.assert_allclose(case.vorticity(longitude, latitude), 20.0 / case.radius * np.sin(latitude), atol=1e-15)


def test_faults_of_a_case_are_told_with_their_place(icosahedral_mesh: VoronoiMesh) -> None:
    class Wrong(Plain):
        def topography(self, longitude: Array, latitude: Array) -> Array:
            return np.zeros(3)

    class Failing(Plain):
        def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
            return longitude / [1.0, 2.0]

    class Infinite(Plain):
        def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
            return np.where(longitude > 1.0, np.inf, 1.0)

    class Integers(Plain):
        def initial_state(self, mesh: VoronoiMesh, sampling: str = "point") -> State:
            return State(np.ones(mesh.n_cells, int), np.zeros(mesh.n_edges))  # type: ignore[arg-type]

    for case, words in (
        (Wrong(), r"topography of plain gives an array of shape \(3,\) for positions of shape \(642,\)"),
        (Failing(), r"thickness of plain failed in line \d+ of .*test_every_case.py: ValueError"),
        (Infinite(), "initial thickness is inf at entity"),
        (Integers(), "initial thickness has numbers of type int64"),
    ):
        with pytest.raises(InputError, match=words):
            Simulation(icosahedral_mesh, case)


def test_parameters_must_make_sense() -> None:
    with pytest.raises(InputError, match="angle is nan; give a finite number"):
        Williamson2(angle=float("nan"))
    with pytest.raises(InputError, match="radius is -1; it must be positive"):
        Williamson2(radius=-1.0)

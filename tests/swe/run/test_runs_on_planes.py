"""The model on planes: all forms agree, both schemes do on hexagons, integrals are kept, processes share a run."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import netCDF4
import numpy as np
import pytest

from cases import PlaneCase
from mesh import VoronoiMesh, build_operators, hexagon_mesh
from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from swe import ShallowWaterModel, Simulation, State, WindStress
from swe.configuration import SchemeName
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.soundness import problem_with_state
from swe.equations.tendency import consistent, ringler2010, tendency
from swe.equations.terms import Forcing
from swe.run.composition import fused_method, plain_method

ROW = 0.5 * np.sqrt(3.0)
GRAVITY = 9.8


def plane(periodic: str, size: int = 8) -> VoronoiMesh:
    return hexagon_mesh((1e4 * size, 1e4 * ROW * size), (size, size), periodic)


def moving_state(mesh: VoronoiMesh, seed: int = 5) -> State:
    random = np.random.default_rng(seed)
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    state.normal_velocity[wall_edges(mesh)] = 0.0
    return state


def model_on(mesh: VoronoiMesh, scheme: type[Scheme]) -> ShallowWaterModel:
    topography = np.random.default_rng(3).uniform(0.0, 500.0, mesh.n_cells)
    return ShallowWaterModel(mesh, topography, 1e-4 + 2e-11 * mesh.y_vertex, GRAVITY, scheme=scheme)


@pytest.fixture(params=["xy", "x", "none"])
def mesh(request: pytest.FixtureRequest) -> VoronoiMesh:
    return plane(request.param)


@pytest.mark.parametrize(("scheme", "energy"), [(Ringler2010, ringler2010), (Consistent, consistent)])
def test_sparse_plain_and_fused_forms_agree(mesh: VoronoiMesh, scheme: type[Scheme], energy: object) -> None:
    model, state = model_on(mesh, scheme), moving_state(mesh)
    expected = tendency(state, build_operators(mesh), model.topography, model.coriolis, GRAVITY, energy)  # type: ignore[arg-type]
    found = state.copy()
    model.tendency(state, found)
    expected.normal_velocity[wall_edges(mesh)] = 0.0
    for name in ("thickness", "normal_velocity"):
        wanted = getattr(expected, name)
        np.testing.assert_allclose(getattr(found, name), wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    fused, plain = state.copy(), state.copy()
    plain_method(model, plain, "rk4").step(plain, 20.0)
    assert fused_method(model, "rk4").advance(fused, 20.0, 1) == 1
    for name in ("thickness", "normal_velocity"):
        value, wanted = getattr(fused, name), getattr(plain, name)
        np.testing.assert_allclose(value, wanted, rtol=0, atol=1e-13 * np.abs(wanted).max())
        assert np.abs(wanted - getattr(state, name)).max() > 1e-3 * np.abs(wanted).max()


def test_both_schemes_are_one_on_hexagons() -> None:
    mesh = plane("xy")
    state, rates = moving_state(mesh), []
    for scheme in (Ringler2010, Consistent):
        rate = state.copy()
        model_on(mesh, scheme).tendency(state, rate)
        rates.append(rate)
    for name in ("thickness", "normal_velocity"):
        one, other = (getattr(rate, name) for rate in rates)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * np.abs(one).max())


@dataclass(frozen=True)
class Hump(PlaneCase):
    """A hump in the middle of a beta-plane, and a jet beside it."""

    name: ClassVar[str] = "hump"
    title: ClassVar[str] = "a hump"
    recommended_days: ClassVar[float] = 0.1

    beta: float = 2e-11
    stress: float = 0.0

    def thickness(self, x: Array, y: Array, time: float = 0.0) -> Array:
        return 500.0 + 50.0 * np.exp(-((x - 4e4) ** 2 + (y - 3e4) ** 2) / 4e8)

    def velocity(self, x: Array, y: Array, time: float = 0.0) -> tuple[Array, Array]:
        return 10.0 * np.exp(-(((y - 4e4) / 2e4) ** 2)), np.zeros(x.shape)

    def vorticity(self, x: Array, y: Array, time: float = 0.0) -> Array:
        return 20.0 * (y - 4e4) / 4e8 * np.exp(-(((y - 4e4) / 2e4) ** 2))

    def topography(self, x: Array, y: Array) -> Array:
        return 50.0 * np.exp(-((x - 6e4) ** 2) / 4e8)

    def terms(self) -> tuple[Forcing, ...]:
        return (WindStress(lambda x, y: self.stress * y),) if self.stress else ()


@pytest.mark.parametrize("scheme", ["ringler2010", "consistent"])
def test_integrals_are_kept_to_round_off(mesh: VoronoiMesh, scheme: SchemeName) -> None:
    simulation = Simulation(mesh, Hump(), scheme=scheme, integrator="rrk4", time_step=40.0)
    before, start = vars(simulation.invariants), simulation.state.thickness.copy()
    simulation.run(days=0.1, progress=False)
    after = vars(simulation.invariants)
    assert simulation.loops == "fused"
    assert np.abs(simulation.state.thickness - start).max() > 20.0
    energy = [each["kinetic_energy"] + each["potential_energy"] for each in (before, after)]
    assert after["mass"] == pytest.approx(before["mass"], rel=1e-14)
    assert energy[1] == pytest.approx(energy[0], rel=1e-13)
    change = after["absolute_vorticity"] - before["absolute_vorticity"]
    assert abs(change) < 1e-13 * before["planetary_vorticity_magnitude"]


def test_energy_and_mass_do_not_change_at_any_moment(mesh: VoronoiMesh) -> None:
    """The parts of their rates cancel: the sums of A (K + g (h + b)) dh/dt and of l d F du/dt, and that of A dh/dt."""
    for scheme in (Ringler2010, Consistent):
        model, state = model_on(mesh, scheme), moving_state(mesh)
        rate, flux, energy = state.copy(), np.empty(mesh.n_edges), np.empty(mesh.n_cells)
        model.tendency(state, rate)
        model.scheme.flux(state.thickness, state.normal_velocity, flux)
        model.scheme.kinetic_energy(state.normal_velocity, energy)
        bernoulli = energy + GRAVITY * (state.thickness + model.topography)
        of_cells = mesh.area_cell * bernoulli * rate.thickness
        of_edges = mesh.dc_edge * mesh.dv_edge * flux * rate.normal_velocity
        assert abs(of_cells.sum() + of_edges.sum()) < 1e-13 * np.abs(of_cells).sum()
        assert abs(mesh.area_cell @ rate.thickness) < 1e-13 * (mesh.area_cell @ np.abs(rate.thickness))


def test_terms_know_the_place_in_metres() -> None:
    mesh, case = plane("none"), Hump(stress=1e-5)
    still = State(np.full(mesh.n_cells, 500.0), np.zeros(mesh.n_edges))
    acceleration = case.terms()[0].acceleration
    assert acceleration is not None
    inner = mesh.cells_on_edge[:, 1] >= 0
    expected = 1e-5 * mesh.y_edge * np.cos(mesh.angle_edge) / (1025.0 * 500.0)
    np.testing.assert_allclose(acceleration(mesh, still, 0.0)[inner], expected[inner], rtol=1e-12, atol=1e-20)


def test_nothing_flows_through_walls_at_the_start(mesh: VoronoiMesh) -> None:
    velocity = Hump().state_on(mesh).normal_velocity
    assert not velocity[wall_edges(mesh)].any()
    assert np.abs(velocity).max() > 5.0


def test_a_wrong_cell_is_told_in_metres() -> None:
    mesh = plane("xy")
    state = moving_state(mesh)
    state.thickness[9] = -1.0
    place = f"at x = {mesh.x_cell[9]:g} and y = {mesh.y_cell[9]:g} m"
    assert str(problem_with_state(mesh, state)).endswith(place)


def test_a_run_is_resumed_and_its_files_say_that_it_is_on_a_plane(tmp_path: Path) -> None:
    mesh = plane("xy")
    whole, parts = (tmp_path / name for name in ("whole", "parts"))
    Simulation(mesh, Hump(), whole, time_step=40.0, snapshot_interval=1200.0).run(days=1 / 24, progress=False)
    Simulation(mesh, Hump(), parts, time_step=40.0, snapshot_interval=1200.0).run(days=1 / 48, progress=False)
    resumed = Simulation(mesh, Hump(), parts, time_step=40.0, snapshot_interval=1200.0, resume=True)
    resumed.run(until=1 / 24, progress=False)
    assert (whole / "history.nc").read_bytes() == (parts / "history.nc").read_bytes()
    with netCDF4.Dataset(whole / "history.nc") as file:
        assert (file.on_a_sphere, file.is_periodic, file.x_period) == ("NO", "YES", mesh.x_period)
        assert file["normal_velocity"].coordinates == "xEdge yEdge"
        assert "standard_name" not in file["lonCell"].ncattrs()

"""The gyres in a box: their solutions obey the equations and the textbook, and the model stays near them."""

import numpy as np
import pytest

from cases import MunkBox, StommelBox
from cases.plane.gyres import GyreBox
from mesh import VoronoiMesh, build_operators, hexagon_mesh
from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from mesh.parts.culling import culled
from swe import InputError, Simulation
from swe.forcing.wind import SEA_WATER
from tests.cases.plane.slopes import Slopes, component, relative_error

ROW = 0.5 * np.sqrt(3.0)
CASES = [StommelBox(), StommelBox(x_length=2e6, y_length=5e5, drag_rate=1e-5, coriolis_parameter=0.0), MunkBox()]


def box(columns: int) -> VoronoiMesh:
    return hexagon_mesh((1e6, 1e6 * ROW), (columns, columns), "none")


def inside(case: GyreBox) -> Slopes:
    x, y = np.random.default_rng(3).uniform(0.05, 0.95, (2, 300))
    return Slopes(x * case.x_length, y * case.y_length, 0.0, metres=300.0)


def friction(case: GyreBox, slopes: Slopes) -> tuple[Array, Array]:
    """Acceleration by friction along x and y, m/s2."""
    if isinstance(case, StommelBox):
        u, v = case.velocity(slopes.x, slopes.y)
        return -case.drag_rate * u, -case.drag_rate * v
    assert isinstance(case, MunkBox)
    return -case.viscosity * slopes.in_y(case.vorticity), case.viscosity * slopes.in_x(case.vorticity)


@pytest.mark.parametrize("case", CASES, ids=["stommel", "other-stommel", "munk"])
def test_forces_are_in_balance(case: GyreBox) -> None:
    slopes = inside(case)
    x, y = slopes.x, slopes.y
    (u, v), f, (along, across) = case.velocity(x, y), case.coriolis(x, y), friction(case, slopes)
    wind = case.stress(x, y) / (SEA_WATER * case.depth)
    size = np.abs(wind).max()
    left = (
        f * v - case.gravity * slopes.in_x(case.thickness) + wind + along,
        -f * u - case.gravity * slopes.in_y(case.thickness) + across,
    )
    # The corners of Munk's box leave waves in the last polynomials, which derivatives make large.
    assert np.sqrt(np.mean(np.square(left))) < (1e-5 if isinstance(case, StommelBox) else 0.03) * size
    assert np.abs(along).max() > 0.1 * size


@pytest.mark.parametrize("case", CASES, ids=["stommel", "other-stommel", "munk"])
def test_velocity_and_vorticity_are_those_of_the_streamfunction(case: GyreBox) -> None:
    slopes = inside(case)
    u, v = case.velocity(slopes.x, slopes.y)
    speed = np.abs(np.hypot(u, v)).max()
    np.testing.assert_allclose(u, -slopes.in_y(case.streamfunction), atol=1e-6 * speed)
    np.testing.assert_allclose(v, slopes.in_x(case.streamfunction), atol=1e-6 * speed)
    vorticity = slopes.in_x(component(case.velocity, 1)) - slopes.in_y(component(case.velocity, 0))
    found = case.vorticity(slopes.x, slopes.y)
    np.testing.assert_allclose(found, vorticity, atol=1e-5 * np.abs(vorticity).max())


@pytest.mark.parametrize("case", [StommelBox(), MunkBox()])
def test_walls_are_streamlines_and_the_sea_turns_clockwise_along_the_west(case: GyreBox) -> None:
    along = np.linspace(0.0, 1.0, 21)
    x, y, none = along * case.x_length, along * case.y_length, np.zeros(21)
    inner = case.streamfunction(*(0.25 * np.array([[case.x_length], [2.0 * case.y_length]])))[0]
    assert inner > 5.0
    for wall in ((none, y), (none + case.x_length, y), (x, none), (x, none + case.y_length), (none - 1e4, y)):
        np.testing.assert_allclose(case.streamfunction(*wall), 0.0, atol=1e-9 * inner)
    half = np.full(200, 0.5 * case.y_length)
    northward = case.velocity(np.linspace(0.0, case.x_length, 200), half)[1]
    assert northward[:20].max() > 2.5 * -northward.min()
    slip = case.velocity(np.full(1, 1.0), half[:1])[1] / northward.max()
    assert (slip > 0.9) == isinstance(case, StommelBox)
    assert (slip < 0.001) == isinstance(case, MunkBox)


def test_the_middle_of_a_weakly_viscous_box_is_that_of_munks_formula() -> None:
    """psi = pi T / (beta Ly) (Lx - x - boundary layers), with the layer in the west of his paper."""
    case = MunkBox(viscosity=4e3)
    layer = (case.viscosity / case.beta) ** (1.0 / 3.0)
    x = np.linspace(0.0, 0.5 * case.x_length, 101)
    s = 0.5 * np.sqrt(3.0) * x / layer
    west = np.exp(-0.5 * x / layer) * (np.cos(s) + (1.0 - 2.0 * layer / case.x_length) / np.sqrt(3.0) * np.sin(s))
    size = np.pi * case.driving * case.x_length / (case.beta * case.y_length)
    formula = size * (1.0 - layer / case.x_length) * (1.0 - west) - size * x / case.x_length
    found = case.streamfunction(x, np.full(101, 0.5 * case.y_length))
    np.testing.assert_allclose(found, formula, atol=0.06 * size)
    assert found.max() == pytest.approx(formula.max(), rel=0.06)


def errors(case: GyreBox, columns: int, days: float) -> tuple[float, float]:
    """Relative l2 errors of the height of the surface, and of the velocity a tenth of the box away from walls."""
    simulation = Simulation(box(columns), case)
    simulation.run(days=days, progress=False)
    mesh, exact = simulation.mesh, case.state_on(simulation.mesh)
    height = relative_error(simulation.state.thickness - case.depth, exact.thickness - case.depth, mesh.area_cell)
    x, y = mesh.x_edge, mesh.y_edge
    away = np.minimum.reduce([x, y, case.x_length - x, case.y_length - y]) > 0.1 * case.x_length
    weights = (mesh.dc_edge * mesh.dv_edge)[away]
    return height, relative_error(simulation.state.normal_velocity[away], exact.normal_velocity[away], weights)


@pytest.mark.parametrize(("case", "most"), [(StommelBox(), 0.056), (MunkBox(), 0.052)])
def test_the_model_stays_near_the_solution(case: GyreBox, most: float) -> None:
    assert 0.01 < errors(case, 16, 10.0)[0] < most


@pytest.mark.slow
@pytest.mark.parametrize("case", [StommelBox(), MunkBox()])
def test_errors_fall_with_order_one(case: GyreBox) -> None:
    """The walls of hexagons are zigzags, whose place is known to within a part of a cell."""
    coarse, fine = (np.array(errors(case, columns, 20.0)) for columns in (16, 32))
    assert (np.log2(coarse / fine) > 0.9).all()
    assert fine[0] < 0.028


@pytest.mark.parametrize("case", [StommelBox(), MunkBox()])
def test_the_start_neither_diverges_nor_crosses_walls(case: GyreBox) -> None:
    simulation = Simulation(box(16), case)
    mesh, u = simulation.mesh, simulation.state.normal_velocity
    assert not u[wall_edges(mesh)].any()
    divergence = build_operators(mesh).divergence @ u
    assert np.abs(divergence).max() < 1e-12 * np.abs(u).max() / mesh.dc_edge.min()
    assert np.abs(u).max() > 1e-5


@pytest.mark.parametrize("case", [StommelBox(), MunkBox()])
def test_the_wind_is_weak_enough_for_linear_equations(case: GyreBox) -> None:
    """The vorticity that the flow carries is little beside that of the planet."""
    slopes = inside(case)
    u, v = case.velocity(slopes.x, slopes.y)
    advected = u * slopes.in_x(case.vorticity) + v * slopes.in_y(case.vorticity)
    assert np.abs(advected).max() < 5e-3 * case.beta * np.abs(v).max()


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="stommel-box needs a mesh on a plane with --periodic none, and this one has"):
        StommelBox().state_on(hexagon_mesh((1e6, 1e6 * ROW), (8, 8), "x"))
    words = (
        "munk-box is in a box from 0 to x_length = 1000000 m in x, but the mesh has cells from 62500 to "
        "1.9375e.06 m; set x_length, or take another mesh"
    )
    with pytest.raises(InputError, match=words):
        MunkBox().state_on(hexagon_mesh((2e6, 2e6 * ROW), (8, 8), "none"))
    with pytest.raises(InputError, match="beta is 0; it must be positive"):
        StommelBox(beta=0.0)
    with pytest.raises(InputError, match="viscosity is -1; it must be positive"):
        MunkBox(viscosity=-1.0)
    moved = box(8)
    object.__setattr__(moved, "y_cell", moved.y_cell - 1e5)
    with pytest.raises(InputError, match=r"y_length = \d+\.?\d* m in y, but the mesh has cells from -45873\.4 to"):
        StommelBox(y_length=1e6 * ROW).state_on(moved)


@pytest.mark.parametrize("lengths", [{"x_length": 1.03e6}, {"y_length": 9.2e5}, {"x_length": 2e6, "y_length": 2e6}])
def test_a_box_that_is_too_small_is_refused(lengths: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"but the mesh has a wall at x = .*; set these, or take another mesh"):
        StommelBox(**lengths).state_on(box(32))


def test_walls_within_the_box_are_refused() -> None:
    mesh = box(16)
    island = np.hypot(mesh.x_cell - 5e5, mesh.y_cell - 4e5) < 1e5
    with pytest.raises(
        InputError, match=r"munk-box is in a box of x_length = 1000000 by y_length = 866025\.4038 m, but"
    ):
        MunkBox().state_on(culled(mesh, ~island))

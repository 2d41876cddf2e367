"""The gyres of Stommel and Munk: their solutions obey the equations, and the model stays near them; the double gyre."""

import numpy as np
import pytest

from basins_page import basin_of, gyre_error
from cases import Case, DoubleGyre, Munk, Stommel
from cases.differences import gradient
from cases.gyres import Gyre
from mesh import VoronoiMesh, build_operators, scvt_mesh
from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from mesh.geometry.sphere import from_lonlat
from mesh.parts.culling import culled
from mesh.parts.cutting import without_cells
from mesh.parts.mesh_part import cut_part
from swe import InputError, Simulation
from swe.forcing.wind import SEA_WATER


@pytest.fixture(scope="module")
def fine_mesh() -> VoronoiMesh:
    return scvt_mesh(10242)


def inside(case: Gyre) -> tuple[Array, Array]:
    """Positions away from the coast, beyond the reach of differences."""
    random = np.random.default_rng(3)
    longitude = random.uniform(case.west + 0.1, case.east - 0.1, 200)
    return longitude, random.uniform(case.south + 0.1, case.north - 0.1, 200)


def friction(case: Gyre, longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """Acceleration by friction, m/s2, eastward and northward."""
    if isinstance(case, Stommel):
        eastward, northward = case.velocity(longitude, latitude)
        return -case.drag_rate * eastward, -case.drag_rate * northward
    assert isinstance(case, Munk)
    to_east, to_north = gradient(case.vorticity, longitude, latitude)
    return -case.viscosity * to_north / case.radius, case.viscosity * to_east / case.radius


@pytest.mark.parametrize("case", [Stommel(), Stommel(west=-0.5, east=0.7, south=0.0, drag_rate=3e-5), Munk()])
def test_forces_are_in_balance(case: Gyre) -> None:
    """Wind, friction, Coriolis force and the slope of the surface, in the equations without products of unknowns."""
    longitude, latitude = inside(case)
    eastward, northward = case.velocity(longitude, latitude)
    slope = gradient(case.thickness, longitude, latitude)
    drag = friction(case, longitude, latitude)
    f, scale = case.coriolis(longitude, latitude), case.gravity / case.radius
    wind = case.stress(longitude, latitude) / (SEA_WATER * case.depth)
    size = np.abs(wind).max()
    left = f * northward - scale * slope[0] + wind + drag[0], -f * eastward - scale * slope[1] + drag[1]
    # The corners of Munk's sea leave waves in the last polynomials, which derivatives make large.
    close = 1e-6 if isinstance(case, Stommel) else 0.03
    assert np.sqrt(np.mean(np.square(left))) < close * size
    assert np.abs(drag).max() > 0.1 * size


@pytest.mark.parametrize("case", [Stommel(), Munk()])
def test_the_coast_is_a_streamline(case: Gyre) -> None:
    along = np.linspace(0.0, 1.0, 21)
    longitude, latitude = case.west + along * case.width, case.south + along * (case.north - case.south)
    middle = case.streamfunction(np.array([0.5]), np.array([0.5]))
    assert middle[0] > 100.0
    for coast in (
        (np.full(21, case.west), latitude),
        (np.full(21, case.east), latitude),
        (longitude, np.full(21, case.south)),
        (longitude, np.full(21, case.north)),
        (np.full(21, case.west - 0.01), latitude),
    ):
        np.testing.assert_allclose(case.streamfunction(*coast), 0.0, atol=1e-9 * middle[0])
    step = 1e-4
    near = np.abs(case.streamfunction(np.full(21, case.west + step), latitude)).max()
    slips = isinstance(case, Stommel)
    assert (near > 1e-3 * middle[0]) == slips
    assert slips or near < 1e-5 * middle[0]


def test_munk_is_solved_to_what_is_promised() -> None:
    from cases import munk

    case = Munk()
    fine, default = munk.solution(case, munk.TERMS + 8), munk.solution(case)
    x, y = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 500))
    found = np.polynomial.chebyshev.chebval2d(x, y, default.streamfunction)
    better = np.polynomial.chebyshev.chebval2d(x, y, fine.streamfunction)
    np.testing.assert_allclose(found, better, atol=1e-4 * np.abs(better).max())


@pytest.mark.parametrize(("case", "days", "most"), [(Stommel(), 4.0, 0.045), (Munk(), 4.0, 0.042)])
def test_the_model_stays_near_the_solution(fine_mesh: VoronoiMesh, case: Gyre, days: float, most: float) -> None:
    """With two cells across the boundary layer; docs/verification.md has finer meshes."""
    error = gyre_error(basin_of(fine_mesh, case), case, days)
    assert 0.01 < error < most


def test_the_start_neither_diverges_nor_crosses_the_coast(fine_mesh: VoronoiMesh) -> None:
    for case in (Stommel(), Munk()):
        simulation = Simulation(basin_of(fine_mesh, case), case)
        mesh, u = simulation.mesh, simulation.state.normal_velocity
        assert not u[wall_edges(mesh)].any()
        divergence = build_operators(mesh).divergence @ u
        assert np.abs(divergence).max() < 1e-12 * np.abs(u).max() / mesh.dc_edge.min()
        assert np.abs(u).max() > 1e-4


def test_a_mesh_of_more_than_the_basin_is_refused(small_mesh: VoronoiMesh) -> None:
    words = (
        r"^stommel needs a mesh of the box 0,60,10,50 in degrees alone, but \d+ of its 162 cells have their centres "
        "elsewhere; cut them out$"
    )
    with pytest.raises(InputError, match=words):
        Simulation(small_mesh, Stommel())


def test_a_mesh_of_less_than_the_basin_is_refused(fine_mesh: VoronoiMesh) -> None:
    case, outside = Stommel(), Stommel().is_outside(fine_mesh.lon_cell, fine_mesh.lat_cell)
    assert case.state_on(culled(fine_mesh, ~outside).scaled(case.radius)).thickness.size == np.count_nonzero(~outside)
    words = r"^stommel needs a mesh of all of the box 0,60,10,50 in degrees, but this one has a coast at \d"
    island = fine_mesh.cell_points @ from_lonlat(np.array(0.5), np.array(0.5)) > 0.98
    for beyond in (fine_mesh.lon_cell > 0.8, fine_mesh.lat_cell < 0.4, fine_mesh.lat_cell > 0.7, island):
        with pytest.raises(InputError, match=words):
            case.state_on(culled(fine_mesh, ~(outside | beyond)).scaled(case.radius))


@pytest.mark.parametrize("sides", [{"east": -0.1}, {"east": 7.0}, {"south": 1.0}, {"north": 1.55}])
def test_seas_that_are_none_are_refused(sides: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"^the sea from .* is none; give radians, east of west and north of south"):
        Munk(**sides)


def test_a_sea_across_the_date_line(fine_mesh: VoronoiMesh) -> None:
    case, other = Stommel(west=np.radians(150.0), east=np.radians(210.0)), Stommel()
    mesh = basin_of(fine_mesh, case)
    assert mesh.n_cells == pytest.approx(basin_of(fine_mesh, other).n_cells, rel=0.05)
    turned = other.thickness(mesh.lon_cell - np.radians(150.0), mesh.lat_cell)
    np.testing.assert_allclose(case.thickness(mesh.lon_cell, mesh.lat_cell), turned, rtol=1e-12)


def test_the_double_gyre_spins_up_in_any_sea(larger_mesh: VoronoiMesh) -> None:
    """In the north of the westerlies it turns as a cyclone, in the south as an anticyclone, as the wind makes it."""
    case = DoubleGyre()
    missing = (np.abs(larger_mesh.lon_cell - 1.0) > 0.6) | (np.abs(larger_mesh.lat_cell - 0.7) > 0.5)
    sea = without_cells(larger_mesh, missing)
    simulation = Simulation(sea, case)
    assert not simulation.state.normal_velocity.any()
    simulation.run(days=30.0, progress=False)
    mesh, height = simulation.mesh, simulation.state.thickness - case.depth
    south, north = (np.abs(mesh.lat_cell - latitude) < 0.15 for latitude in (0.48, 0.92))
    assert height[south].mean() > 1.0
    assert height[north].mean() < -1.0
    assert simulation.invariants.mass == pytest.approx(simulation.initial_invariants.mass, rel=1e-14)


def test_winds_that_make_no_sense_are_refused() -> None:
    with pytest.raises(InputError, match=r"wind_north is 0\.1; it must be greater than wind_south, 0\.2617"):
        DoubleGyre(wind_north=0.1)


def test_the_stress_of_the_double_gyre() -> None:
    case: DoubleGyre = DoubleGyre(wind_south=0.2, wind_north=1.0)
    latitude = np.array([-0.5, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3])
    expected = [-0.1, -0.1, 0.0, 0.1, 0.0, -0.1, -0.1]
    np.testing.assert_allclose(case.stress(np.zeros(7), latitude), expected, atol=1e-15)
    assert isinstance(case, Case)


@pytest.mark.parametrize("case", [Stommel(), Munk()])
def test_a_process_starts_its_part_as_the_whole(fine_mesh: VoronoiMesh, case: Gyre) -> None:
    """Also at the edges of its rim, beyond which cells are missing that are no coast."""
    mesh = basin_of(fine_mesh, case).scaled(case.radius)
    whole, blocks = case.state_on(mesh), (mesh.lon_cell > 0.5).astype(np.int32)
    for block in (0, 1):
        part = cut_part(mesh, blocks, block, 2)
        assert part.mesh.n_cells < mesh.n_cells
        inner = part.mesh.cells_on_edge.min(axis=1) >= 0
        mine = case.state_on(part.mesh).normal_velocity
        np.testing.assert_array_equal(mine[inner], whole.normal_velocity[part.edges][inner])

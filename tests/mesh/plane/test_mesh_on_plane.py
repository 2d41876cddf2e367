"""Centroidal Voronoi meshes of planes: centroids, walls, seams, densities, and what cannot be asked for."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, MeshRequest, mesh_on_plane, mesh_quality, read_mesh, validate_mesh, write_mesh
from mesh.density.planar import RefinedDisc
from mesh.discrete.quality import quality_and_note
from mesh.discrete.walls import wall_edges
from mesh.generation.optimizer import Limits, Optimizer
from mesh.plane.domain import PERIODIC, Rectangle
from mesh.plane.generation import FIRST_ITERATIONS, converge_on_plane
from mesh.plane.grids import plane_preconditioner
from mesh.plane.moving import PlaneCells
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points

LENGTHS = (3e5, 2e5)
HEXAGON = 5.0 / (18.0 * np.sqrt(3.0))
"""Energy of a regular hexagon whose area is one."""


@pytest.mark.parametrize("periodic", PERIODIC)
@pytest.mark.parametrize("start", ["random", None])
def test_meshes_are_centroidal_and_cover_the_plane(periodic: str, start: str | None) -> None:
    mesh = mesh_on_plane(MeshRequest(cells=200, plane=LENGTHS, periodic=periodic, start=start))
    assert mesh.n_cells == 200
    assert mesh.area_cell.sum() == pytest.approx(6e10, rel=1e-13)
    assert max(validate_mesh(mesh).values()) < 1e-11
    assert mesh_quality(mesh).residual < 1.1e-8
    assert mesh_quality(mesh).q_avg > 0.97
    assert (mesh.x_period, mesh.y_period) == tuple(
        length if axis in periodic else 0.0 for axis, length in zip("xy", LENGTHS, strict=True)
    )


@pytest.mark.parametrize("periodic", ["x", "none"])
def test_walls_are_straight_and_square_to_their_edges(periodic: str) -> None:
    mesh = mesh_on_plane(MeshRequest(cells=150, plane=LENGTHS, periodic=periodic))
    walls = wall_edges(mesh)
    lengths = {"x": 2.0 * LENGTHS[0], "none": 2.0 * sum(LENGTHS)}
    assert mesh.dv_edge[walls].sum() == pytest.approx(lengths[periodic], rel=1e-12)
    cells = mesh.cells_on_edge[walls, 0]
    assert (mesh.cells_on_edge[walls, 1] == -1).all()
    # A wall in x is at x = 0 or LX and has the y of its generator, one in y the other way round.
    in_x = np.isclose(np.abs(np.cos(mesh.angle_edge[walls])), 1.0)
    np.testing.assert_allclose(mesh.y_edge[walls][in_x], mesh.y_cell[cells][in_x], atol=1e-6)
    np.testing.assert_allclose(mesh.x_edge[walls][~in_x], mesh.x_cell[cells][~in_x], atol=1e-6)
    np.testing.assert_allclose(mesh.x_edge[walls][in_x] % LENGTHS[0], 0.0, atol=1e-6)
    np.testing.assert_allclose(mesh.y_edge[walls][~in_x] % LENGTHS[1], 0.0, atol=1e-6)
    distance = np.hypot(mesh.x_edge[walls] - mesh.x_cell[cells], mesh.y_edge[walls] - mesh.y_cell[cells])
    np.testing.assert_allclose(mesh.dc_edge[walls], 2.0 * distance, rtol=1e-12)
    outward = np.column_stack([np.cos(mesh.angle_edge[walls]), np.sin(mesh.angle_edge[walls])])
    way = np.column_stack([mesh.x_edge[walls] - mesh.x_cell[cells], mesh.y_edge[walls] - mesh.y_cell[cells]])
    np.testing.assert_allclose((outward * way).sum(axis=1), distance, rtol=1e-12)
    corners = {"x": 0, "none": 4}
    assert np.count_nonzero((mesh.cells_on_vertex >= 0).sum(axis=1) == 1) == corners[periodic]


@pytest.mark.parametrize("periodic", PERIODIC)
def test_a_generator_beyond_the_border_is_its_image_within(periodic: str) -> None:
    plane = Rectangle(*LENGTHS, periodic)
    points = starting_points(plane, 100, start="random")
    beyond = points.copy()
    beyond[:20, 0] += 2.0 * LENGTHS[0]
    beyond[20:30, 1] -= 2.0 * LENGTHS[1]
    beyond[30:40, 1] *= 1.0 if plane.repeats[1] else -1.0
    expected, found = plane_mesh(points, plane), plane_mesh(beyond, plane)
    np.testing.assert_array_equal(found.cells_on_vertex, expected.cells_on_vertex)
    np.testing.assert_allclose(found.area_cell, expected.area_cell, rtol=1e-9)


def test_seams_of_convergence_cannot_be_seen() -> None:
    """The translated start converges to the translated mesh, to the tolerance of the residual."""
    plane = Rectangle(3.0, 2.0)
    start = converge_on_plane(starting_points(plane, 300, start="random"), plane, "lloyd", limits=Limits(0.02)).points
    shift = np.array([1.234, 0.777, 0.0])
    expected = converge_on_plane(start, plane, limits=Limits(1e-12)).points
    found = converge_on_plane(start + shift, plane, limits=Limits(1e-12)).points
    # No cell is held, and translations of all cost no energy.
    way = plane.surface.shortest(found - expected - shift)
    assert np.ptp(way, axis=0).max() < 1e-10
    assert np.abs(way).max() < 1e-7


@pytest.mark.parametrize("periodic", PERIODIC)
def test_lloyd_never_raises_the_energy_and_agrees(periodic: str) -> None:
    plane = Rectangle(1.0, 1.0, periodic)
    points = starting_points(plane, 40, start="random", seed=5)
    slow = converge_on_plane(points, plane, "lloyd", limits=Limits(1e-6))
    assert slow.reason == "tolerance"
    assert (np.diff(slow.history.energy) < 0.0).all()
    fast = converge_on_plane(slow.points, plane, limits=Limits(1e-10))
    assert fast.history.energy[-1] == pytest.approx(slow.history.energy[-1], rel=1e-9)


def test_the_gradient_is_that_of_the_energy() -> None:
    """Under a density; differences of energies show the sign and the factor of the moments."""
    plane = Rectangle(1.0, 1.0, "x")
    points = starting_points(plane, 30, start="random", seed=1)

    def density(places: np.ndarray) -> np.ndarray:
        return np.asarray(1.0 + 0.5 * np.sin(2.0 * np.pi * places[:, 0]) * places[:, 1])

    def optimizer(points: np.ndarray) -> Optimizer:
        cells = PlaneCells(points, plane)
        return Optimizer(points, density=density, cells=cells, spacing=1.0, surface=plane.surface, method="lloyd")

    def energy(points: np.ndarray) -> float:
        return optimizer(points).run(Limits(1e-9, iterations=0)).history.energy[0]

    here = optimizer(points)
    here.run(Limits(1e-9, iterations=0))
    gradient = here._current.gradient / here._current.scales[:, None]
    step = 1e-5
    for cell, axis in ((0, 0), (11, 1), (29, 0)):
        moved = [points.copy() for _ in range(2)]
        moved[0][cell, axis] += step
        moved[1][cell, axis] -= step
        slope = (energy(moved[0]) - energy(moved[1])) / (2.0 * step)
        assert slope == pytest.approx(gradient[cell, axis], rel=2e-3, abs=1e-6)


def test_large_meshes_come_near_the_energy_of_hexagons() -> None:
    """Gersho: from above, and on hexagons to round-off."""
    plane = Rectangle(1.0, 1.0)
    result = converge_on_plane(starting_points(plane, 1000), plane, limits=Limits(1e-6))
    ratio = result.history.energy[-1] * 1000 / HEXAGON
    assert 1.0 < ratio < 1.01
    regular = Rectangle(16.0, 14.0 * 0.5 * np.sqrt(3.0))
    energy = converge_on_plane(starting_points(regular, 16 * 14), regular).history.energy[0]
    assert energy == pytest.approx(HEXAGON * (0.5 * np.sqrt(3.0)) ** 2 * 16 * 14, rel=1e-13)


def test_iterations_are_counted_through_and_seen_once() -> None:
    plane, seen = Rectangle(1.0, 1.0), []
    points = starting_points(plane, 100, start="random")
    result = converge_on_plane(
        points, plane, limits=Limits(1e-9), callback=lambda at: seen.append((at.number, at.energy))
    )
    assert result.history.iterations > FIRST_ITERATIONS
    assert [number for number, _ in seen] == list(range(result.history.iterations + 1))
    assert [energy for _, energy in seen] == result.history.energy
    assert (np.diff(result.history.seconds) >= 0.0).all()
    assert converge_on_plane(points, plane, limits=Limits(1e-9, iterations=40)).history.iterations == 40


@pytest.mark.parametrize("periodic", PERIODIC)
def test_spacings_follow_the_density(periodic: str) -> None:
    request = MeshRequest(cells=800, plane=LENGTHS, periodic=periodic, density="refined-circle", tolerance=1e-3)
    mesh = mesh_on_plane(request)
    assert mesh.density_name == "refined-circle"
    distance = np.hypot(mesh.x_cell - 1.5e5, mesh.y_cell - 1e5)
    inside, outside = distance < 3e4, distance > 7.5e4
    ratio = np.sqrt(mesh.area_cell[outside].mean() / mesh.area_cell[inside].mean())
    assert ratio == pytest.approx(3.0, rel=0.05)
    assert mesh_quality(mesh).residual == pytest.approx(1e-3, abs=1e-3)
    assert mesh_quality(mesh).residual < 1.1e-3


def test_a_density_may_be_a_function_of_places() -> None:
    density = RefinedDisc(5e4, 5e4, 2e4, 1e4, 2.0)
    mesh = mesh_on_plane(MeshRequest(cells=300, plane=LENGTHS, density=density, tolerance=1e-3))
    near = np.hypot(mesh.x_cell - 5e4, mesh.y_cell - 5e4) < 1.5e4
    assert np.sqrt(mesh.area_cell.max() / mesh.area_cell[near].mean()) > 1.6
    np.testing.assert_allclose(mesh.mesh_density, density(mesh.cell_points))


@pytest.mark.parametrize("periodic", PERIODIC)
def test_a_density_is_asked_within_the_plane_alone(periodic: str) -> None:
    """Cells reach beyond it, where they are those of images."""
    asked: list[np.ndarray] = []

    def density(places: np.ndarray) -> np.ndarray:
        asked.append(places)
        return 1.0 + places[:, 0] / LENGTHS[0]

    plane = Rectangle(*LENGTHS, periodic)
    converge_on_plane(starting_points(plane, 100, start="random"), plane, density=density, limits=Limits(1e-3, 40))
    places = np.concatenate(asked)[:, :2]
    assert len(places) > 1000
    assert (places >= 0.0).all()
    assert (places <= LENGTHS).all()


def write_grid(path: Path, turned: bool) -> Path:
    """Cell widths that fall along x from 3 to 1, on a grid."""
    axes = {"x": np.linspace(0.0, 3e5, 31), "y": np.linspace(0.0, 2e5, 5)[::-1]}
    widths = np.broadcast_to(3.0 - 2.0 * axes["x"] / 3e5, (5, 31))
    with netCDF4.Dataset(path, "w") as file:
        for name, places in axes.items():
            file.createDimension(name, len(places))
            file.createVariable(name, "f8", (name,))[:] = places
        dimensions = ("x", "y") if turned else ("y", "x")
        file.createVariable("width", "f8", dimensions)[:] = widths.T if turned else widths
    return path


@pytest.mark.parametrize("turned", [False, True])
def test_a_density_may_come_from_a_file(tmp_path: Path, turned: bool) -> None:
    path = write_grid(tmp_path / "widths.nc", turned)
    shaping = {"density_variable": "width", "density_power": -4.0}
    request = MeshRequest(
        cells=600,
        plane=LENGTHS,
        periodic="none",
        density=str(path),
        tolerance=1e-3,
        **shaping,  # type: ignore[arg-type]
    )
    mesh = mesh_on_plane(request)
    west, east = mesh.x_cell < 5e4, mesh.x_cell > 2.5e5
    widths = 3.0 - 2.0 * mesh.x_cell / 3e5
    expected = np.sqrt((widths[west] ** 2).mean() / (widths[east] ** 2).mean())
    assert np.sqrt(mesh.area_cell[west].mean() / mesh.area_cell[east].mean()) == pytest.approx(expected, rel=0.05)
    np.testing.assert_allclose(mesh.mesh_density, widths**-4.0, rtol=0.02)
    assert mesh_quality(mesh).residual < 1.1e-3
    write_mesh(mesh, tmp_path / "mesh.nc")
    assert mesh_quality(read_mesh(tmp_path / "mesh.nc")).residual < 1.1e-3
    path.unlink()
    assert "which is missing" in quality_and_note(read_mesh(tmp_path / "mesh.nc"))[1]


def test_files_without_places_are_told(tmp_path: Path) -> None:
    path = tmp_path / "field.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("x", 3)
        file.createVariable("density", "f8", ("x",))[:] = 1.0
    with pytest.raises(MeshError, match="a density on a plane has x and y, with variables of these names"):
        mesh_on_plane(MeshRequest(cells=100, plane=LENGTHS, density=str(path)))
    with pytest.raises(MeshError, match="there is no such file"):
        mesh_on_plane(MeshRequest(cells=100, plane=LENGTHS, density="missing.nc"))
    with pytest.raises(MeshError, match="only densities from files are shaped"):
        mesh_on_plane(MeshRequest(cells=100, plane=LENGTHS, density="refined-circle", density_power=2.0))


def test_places_of_a_density_file_in_kilometres_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "field.nc"
    with netCDF4.Dataset(path, "w") as file:
        for name in ("x", "y"):
            file.createDimension(name, 2)
            places = file.createVariable(name, "f8", (name,))
            places[:], places.units = [0.0, 300.0], "km"
        file.createVariable("density", "f8", ("y", "x"))[:] = 1.0
    with pytest.raises(MeshError, match="has the unit 'km'; give the places on a plane in metres"):
        mesh_on_plane(MeshRequest(cells=100, plane=LENGTHS, density=str(path)))


def test_coarse_grids_carry_constants_and_save_iterations() -> None:
    plane = Rectangle(2.0, 1.0, "x")
    points = starting_points(plane, 1000, start="random")
    preconditioner = plane_preconditioner(points, plane)
    assert len(preconditioner._transfers) > 3
    for transfer in preconditioner._transfers:
        fine = np.zeros((len(transfer._targets), 3))
        transfer.prolong_add(np.ones((int(transfer._targets.max()) + 1, 3)), fine, 1.0, fine)
        np.testing.assert_allclose(fine, 1.0, rtol=1e-6)
        coarse = transfer.restrict(np.ones((len(transfer._targets), 3)))
        assert np.count_nonzero(coarse[:, 0]) == len(coarse) > np.count_nonzero(coarse[:, 1])
    random, one, other = np.random.default_rng(0), np.zeros((1000, 3)), np.zeros((1000, 3))
    first, second = (random.normal(size=(1000, 3)) for _ in range(2))
    preconditioner.apply(first, one)
    preconditioner.apply(second, other)
    assert (first * other).sum() == pytest.approx((one * second).sum(), rel=1e-6)
    assert (first * one).sum() > (first**2).sum()
    cells = PlaneCells(points, plane)
    plain = Optimizer(points, cells=cells, spacing=plane.spacing(1000), surface=plane.surface)
    with_grids = converge_on_plane(points, plane, limits=Limits(1e-4))
    assert with_grids.history.iterations < 0.9 * plain.run(Limits(1e-4)).history.iterations


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (MeshRequest(cells=100), "needs its lengths; give --plane LX,LY"),
        (MeshRequest(plane=LENGTHS), "needs cells; give --cells N, or --hexagons NX,NY"),
        (MeshRequest(cells=100, plane=(1.0, -2.0)), "a length of the plane is -2 m"),
        (MeshRequest(cells=100, plane=LENGTHS, periodic="y"), "cannot be periodic in 'y'; choose one of xy, x, none"),
        (
            MeshRequest(cells=20, plane=(1e6, 1.0), periodic="none"),
            "240 times as wide as the shorter side .* at least 11548",
        ),
        (MeshRequest(cells=5, plane=LENGTHS), "a mesh of 5 cells is too small; ask for at least 12"),
        (MeshRequest(cells=2, plane=LENGTHS, periodic="none"), "ask for at least 3"),
        (MeshRequest(cells=100, plane=LENGTHS, method="macqueen"), "cannot use the method macqueen; choose lbfgs or"),
        (MeshRequest(cells=100, plane=LENGTHS, start="icosahedral"), "cannot start from 'icosahedral'; choose one of"),
        (MeshRequest(cells=100, plane=LENGTHS, density="refined-box"), "no density named 'refined-box' on planes"),
        (MeshRequest(cells=100, plane=LENGTHS, density=lambda at: 0.0 * at[:, 0]), "zero everywhere it was tried"),
        (MeshRequest(cells=100, plane=LENGTHS, density=lambda at: -at[:, 0]), "at x = .* m; it must be finite and not"),
        (MeshRequest(cells=100, plane=(1e300, 1e300)), "m; it must be 1e-06 m at least and 1e.15 m at most"),
        (
            MeshRequest(cells=100, plane=LENGTHS, start="rows", density=lambda at: 1.0 * (at[:, 0] > 2e5)),
            "zero on the whole cell at x = .* m; give it a floor",
        ),
        (MeshRequest(cells=100, plane=LENGTHS, well_centered=True), "neither nested nor made well-centred"),
        (MeshRequest(cells=200, plane=LENGTHS, start="random", max_iterations=2), "allow more iterations"),
    ],
)
def test_what_cannot_be_made_is_told(request_: MeshRequest, words: str) -> None:
    with pytest.raises(MeshError, match=words):
        mesh_on_plane(request_)


def test_a_cell_without_density_is_told_by_its_place() -> None:
    plane = Rectangle(*LENGTHS, "none")
    points = starting_points(plane, 50, start="random")
    cell = int(np.argmax(points[:, 0]))
    with pytest.raises(MeshError, match=r"on the whole cell at x = 29\d+(\.\d+)?, y = \d+(\.\d+)? m; give it a floor"):
        converge_on_plane(points, plane, density=lambda at: 1.0 * (at[:, 0] < points[cell, 0] - 4e4))


def test_generators_on_walls_are_told() -> None:
    points = starting_points(Rectangle(*LENGTHS, "x"), 50)
    points[7, 1] = 0.0
    with pytest.raises(MeshError, match="generator 7 stands on a wall; move it away"):
        plane_mesh(points, Rectangle(*LENGTHS, "x"))

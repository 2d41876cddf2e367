"""Meshes of polygons in the plane: areas, identities, centroids, corners, files, densities, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from mesh import MeshError, MeshWarning, VoronoiMesh, mesh_quality, polygon_mesh, read_mesh, validate_mesh, write_mesh
from mesh.arrays import Array
from mesh.coast.sea_mesh import sea_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.density.planar import density_on_plane
from mesh.discrete.quality import bent_cells, quality_and_note
from mesh.discrete.walls import boundary_vertices
from mesh.generation.optimizer import Iterate
from mesh.plane.generation import converge_on_plane
from mesh.plane.plane_mesh import plane_mesh
from mesh.polygon.generation import cells_in_polygon
from mesh.polygon.rings import checked_rings
from mesh.polygon.starts import starting_points
from mesh.polygon.walls import Walls
from tests.mesh.polygon.rooms import ANGLED, CORNERS, OUTER_CORNERS, PLANE, ROOMS, SIDE, asked_for, circle
from tests.retyped_files import in_types

shapely = pytest.importorskip("shapely")


def walls_of(name: str, cells: int) -> Walls:
    return Walls(checked_rings(ROOMS[name], PLANE), cells)


def drawn(cells: int, seed: int = 3) -> Array:
    points = np.random.default_rng(seed).uniform(0.0, SIDE, (cells, 2))
    return np.column_stack([points, np.zeros(cells)])


@pytest.fixture(scope="module")
def angled() -> VoronoiMesh:
    return polygon_mesh(ROOMS["angled"], asked_for(150))


@pytest.mark.parametrize("name", ROOMS)
def test_cells_fill_the_polygon_and_generators_are_centroids(name: str) -> None:
    seen: list[Iterate] = []
    mesh, walls = polygon_mesh(ROOMS[name], asked_for(120), seen.append), walls_of(name, 120)
    shape = shapely.Polygon(ROOMS[name][0], ROOMS[name][1:])
    assert seen[-1].residual <= 1e-8
    assert mesh.n_cells == 120
    assert mesh.area_cell.sum() == pytest.approx(shape.area, rel=1e-13)
    assert walls.area == pytest.approx(shape.area, rel=1e-14)
    assert max(validate_mesh(mesh).values()) < 1e-14
    # Cells with an inner corner of the polygon, and what a mesh has of them, a straight wall.
    straight = [shapely.Polygon(mesh.vertex_points[ring[ring >= 0], :2]).area for ring in mesh.vertices_on_cell]
    bent = np.abs(np.array(straight) - mesh.area_cell) > 1e-9 * mesh.area_cell
    np.testing.assert_array_equal(bent_cells(mesh), bent)
    assert bent.any() == (name in ("angled", "with a round hole"))
    measured, note = quality_and_note(mesh)
    assert measured.residual <= 1.01e-8
    assert note == (
        f"cells in which a wall bends are not counted ({bent.sum()}), as the mesh does not tell where"
        if bent.any()
        else ""
    )
    alone = (mesh.cells_on_vertex >= 0).sum(axis=1) == 1
    assert alone.sum() == OUTER_CORNERS[name]
    cells = shapely_cells(mesh.cell_points, shape)
    np.testing.assert_allclose([cell.area for cell in cells], mesh.area_cell, rtol=1e-10)
    centroids = np.array([(cell.centroid.x, cell.centroid.y) for cell in cells])
    assert np.abs(centroids - mesh.cell_points[:, :2]).max() < 2e-8 * walls.spacing
    on_walls = shapely.points(mesh.vertex_points[boundary_vertices(mesh), :2])
    assert shapely.distance(shape.boundary, on_walls).max() < 1e-9 * SIDE


def shapely_cells(points: Array, shape: object) -> list[object]:
    """The Voronoi cells of points (n, 3) within a shape, by another program."""
    around = shapely.MultiPoint(points[:, :2])
    cells = shapely.get_parts(shapely.voronoi_polygons(around, extend_to=shapely.box(-SIDE, -SIDE, 2 * SIDE, 2 * SIDE)))
    owner = shapely.STRtree(cells).query(shapely.points(points[:, :2]), "within")
    return [shapely.intersection(cells[cell], shape) for cell in owner[1][np.argsort(owner[0])]]


def test_a_square_has_the_cells_that_mirror_images_make() -> None:
    points = PLANE.folded(converge_on_plane(drawn(200), PLANE).points)
    mesh, box = sea_mesh(cells_in_polygon(points, walls_of("square", 200)), points), plane_mesh(points, PLANE)
    np.testing.assert_array_equal(mesh.cells_on_edge, box.cells_on_edge)
    np.testing.assert_allclose(mesh.area_cell, box.area_cell, rtol=1e-12)
    for name in ("dc_edge", "dv_edge", "x_edge", "y_edge"):
        np.testing.assert_allclose(getattr(mesh, name), getattr(box, name), rtol=0, atol=1e-9)
    for name in ("weights_on_edge", "angle_edge"):
        np.testing.assert_allclose(getattr(mesh, name), getattr(box, name), rtol=0, atol=1e-12)


def test_only_corners_that_stick_out_between_long_walls_are_vertices() -> None:
    def count(ring: object, cells: int) -> int:
        return int(Walls(checked_rings([ring], PLANE), cells).corners.sum())  # type: ignore[list-item]

    assert count(ANGLED, 100) == count(ANGLED[::-1], 100) == 5
    assert count(circle(13, 4e5), 100) == 0
    saw = [(x, 1e4 * (x % 2e4 > 0)) for x in np.arange(0.0, SIDE + 1, 1e4)]
    assert count([*saw, (SIDE, SIDE), (0.0, SIDE)], 100) == 2
    assert count([*saw, (SIDE, SIDE), (0.0, SIDE)], 100_000) == 53


def test_straight_walls_are_straight_in_single_precision_too(angled: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(angled, tmp_path / "double.nc")
    in_types(tmp_path / "double.nc", tmp_path / "single.nc", f="f4")
    with pytest.warns(MeshWarning, match="coordinates are in single precision"):
        single = read_mesh(tmp_path / "single.nc")
    assert np.count_nonzero(bent_cells(angled)) == 1
    np.testing.assert_array_equal(bent_cells(single), bent_cells(angled))


def test_a_wall_bends_where_the_polygon_turns_inwards(angled: VoronoiMesh) -> None:
    """Its point is the nearest to the generator; the corner itself is no vertex."""
    corner = np.array([4e5, 4e5, 0.0])
    assert np.linalg.norm(angled.vertex_points - corner, axis=1).min() > 1e3
    (edge,) = np.flatnonzero(np.linalg.norm(angled.edge_points - corner, axis=1) < 1e-6)
    cell, none = angled.cells_on_edge[edge]
    assert none == -1
    assert angled.dc_edge[edge] == pytest.approx(2.0 * np.linalg.norm(angled.cell_points[cell] - corner))
    ends = angled.vertex_points[angled.vertices_on_edge[edge]]
    assert angled.dv_edge[edge] == pytest.approx(np.linalg.norm(ends[1] - ends[0]))


def test_a_file_gives_it_back(angled: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(angled, tmp_path / "mesh.nc")
    for recompute in (False, True):
        found = read_mesh(tmp_path / "mesh.nc", recompute_metrics=recompute)
        for variable in MESH_VARIABLES:
            given = getattr(angled, variable.name)
            atol = 1e-13 * np.abs(given).max() if recompute else 0.0
            np.testing.assert_allclose(getattr(found, variable.name), given, rtol=0, atol=atol)


@pytest.mark.parametrize("start", [None, "random"])
def test_cells_are_as_large_as_the_density_asks(start: str | None) -> None:
    seen: list[Iterate] = []
    request = asked_for(400, density="refined-circle", start=start)
    mesh = polygon_mesh(ROOMS["hexagon"], request, seen.append)
    away = np.hypot(*(mesh.cell_points[:, :2] - 0.5 * SIDE).T)
    ratio = mesh.area_cell[(away > 3.5e5) & (away < 4e5)].mean() / mesh.area_cell[away < 1.5e5].mean()
    assert ratio == pytest.approx(9.0, rel=0.1)
    assert seen[-1].residual <= 1e-3
    assert mesh_quality(mesh).sigma_avg > 0.8
    np.testing.assert_array_equal(mesh.mesh_density, density_on_plane(request, PLANE.lengths)(mesh.cell_points))


def test_lloyds_method_lowers_the_energy() -> None:
    seen: list[float] = []
    request = asked_for(60, method="lloyd", tolerance=1e-3, start="random")
    mesh = polygon_mesh(ROOMS["with a round hole"], request, lambda iterate: seen.append(iterate.energy))
    assert (np.diff(seen) < 0.0).all()
    assert mesh.n_cells == 60


@pytest.mark.parametrize("start", ["rows", "random", "random-root"])
def test_starts_lie_in_the_polygon(start: str) -> None:
    walls = walls_of("with a round hole", 500)
    points = starting_points(walls, 500, start=start, seed=4)
    shape = shapely.Polygon(*ROOMS["with a round hole"][:1], ROOMS["with a round hole"][1:])
    assert points.shape == (500, 3)
    assert shapely.contains_xy(shape, points[:, 0], points[:, 1]).all()
    np.testing.assert_array_equal(walls.contains(points), True)


def test_distances_are_those_of_another_program() -> None:
    points = 1.2 * drawn(1000) - 1e5
    points[:, 2] = 0.0
    for name, rings in ROOMS.items():
        shape, places = shapely.Polygon(rings[0], rings[1:]), shapely.points(points[:, :2])
        sign = np.where(shapely.contains(shape, places), 1.0, -1.0)
        expected = sign * shapely.distance(shape.boundary, places)
        np.testing.assert_allclose(walls_of(name, 10).distance(points), expected, rtol=1e-12, atol=1e-9)


def test_rings_may_run_either_way_and_be_closed() -> None:
    hole = circle(48, 2e5)
    one = polygon_mesh([CORNERS, hole], asked_for(40))
    other = polygon_mesh([[*CORNERS[::-1], CORNERS[-1]], hole[::-1]], asked_for(40))
    np.testing.assert_allclose(other.area_cell, one.area_cell, rtol=1e-6)


CROSSING = [(0.0, 0.0), (SIDE, SIDE), (SIDE, 0.0), (0.0, SIDE)]


@pytest.mark.parametrize(
    ("rings", "words"),
    [
        ([], "the polygon has no ring; give the points round it"),
        ([CROSSING], r"the polygon is not simple \(Self-intersection\[5"),
        ([CORNERS, 0.5 * circle(8, 2e5), 0.5 * circle(8, 1e5)], r"the polygon is not simple \(Holes are nested"),
        ([CORNERS, circle(8, 6e5) * [1.0, 0.4]], "is not simple|outside of the plane"),
        ([CORNERS[:2]], "ring 0 of the polygon has 2 points; give at least 3"),
        ([[*CORNERS[:3], (np.nan, 0.0)]], "its point 3 at x = nan, y = 0; give finite numbers"),
        ([CORNERS, [(1.0, 2.0), (3.0, 4.0), (3.0, 4.0), (5.0, 1.0)]], "ring 1 of the polygon has its point 1 twice"),
        ([CORNERS, [(1.0, 2.0), (3.0,)]], r"ring 1 of the polygon is no list of points"),
        ([CORNERS, ["ab", "cd"]], r"ring 1 of the polygon is no list of points"),
        ([CORNERS, [1.0, 2.0, 3.0]], r"ring 1 of the polygon is no list of points"),
        ([[*CORNERS[:3], (-1.0, 5e5)]], r"a point at x = -1, y = 500000 m, outside of the plane of 1e\+06 by 1e\+06 m"),
    ],
)
def test_what_is_no_polygon_is_told(rings: list[list[tuple[float, float]]], words: str) -> None:
    with pytest.raises(MeshError, match=words):
        polygon_mesh(rings, asked_for(30))


def test_what_cannot_be_asked_for_is_told() -> None:
    from mesh import MeshRequest

    for request, words in (
        (MeshRequest(cells=30), "a mesh on a plane needs its lengths"),
        (MeshRequest(cells=30, plane=(SIDE, SIDE), periodic="x"), "cannot be periodic, which it is in x"),
        (MeshRequest(plane=(SIDE, SIDE), periodic="none", hexagons=(3, 3)), "hexagons do not follow the walls"),
        (asked_for(2), "a mesh of 2 cells is too small; ask for at least 3"),
        (asked_for(30, start="fibonacci"), "cannot start from 'fibonacci'; choose one of rows"),
        (asked_for(30, density=lambda points: 0.0 * points[:, 0]), "the density is zero"),
        (asked_for(30, max_iterations=1), "iterations"),
    ):
        with pytest.raises(MeshError, match=words):
            polygon_mesh(ROOMS["angled"], request)


def test_walls_too_thin_for_the_cells_are_told() -> None:
    thin = [(4.99e5, 1e5), (5.01e5, 1e5), (5.01e5, 9e5), (4.99e5, 9e5)]
    with pytest.raises(MeshError, match="ask for more cells, or for a polygon without such narrow parts"):
        polygon_mesh([CORNERS, thin], asked_for(20, start="random", seed=1))

"""Maps show every cell, at its place and size, without holes."""

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.path import Path as Outline

from mesh import VoronoiMesh, mesh_from_points
from mesh.generation.generators import icosahedral_points
from mesh.geometry.sphere import from_lonlat
from postprocess.figures.patches import Patches, cell_patches, edge_patches, triangle_patches
from postprocess.figures.projections import (
    CYLINDRICAL,
    MOLLWEIDE,
    GlobeMap,
    Polygons,
    globe_polygons,
    mollweide,
    mollweide_raster,
    orthographic_polygons,
)


def polygon_area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def test_mollweide_maps_the_sphere_to_its_ellipse_keeping_areas() -> None:
    np.testing.assert_allclose(mollweide(np.array(np.pi), np.array(0.0)), [2 * np.sqrt(2), 0.0], atol=1e-15)
    np.testing.assert_allclose(mollweide(np.array(1.0), np.array(np.pi / 2)), [0.0, np.sqrt(2)], atol=1e-6)
    lat = np.linspace(-1.5, 1.5, 50)
    y = mollweide(np.zeros(50), lat)[:, 1]
    angle = np.arcsin(y / np.sqrt(2))
    np.testing.assert_allclose(2 * angle + np.sin(2 * angle), np.pi * np.sin(lat), atol=1e-12)


@pytest.fixture(
    scope="module", params=["edge at the pole", "vertex at the pole", "cell at the pole", "large cells", "random"]
)
def turned_mesh(request: pytest.FixtureRequest) -> VoronoiMesh:
    if request.param == "random":
        return mesh_from_points(np.random.default_rng(1).normal(size=(500, 3)))
    if request.param == "large cells":
        grid = np.stack(np.meshgrid(*3 * [[-1.0, 0.0, 1.0]]), axis=-1).reshape(-1, 3)
        return mesh_from_points(grid[np.abs(grid).any(axis=1)])
    points = icosahedral_points(3)
    unturned = mesh_from_points(points)
    target = {
        "edge at the pole": unturned.edge_points[0],
        "vertex at the pole": unturned.vertex_points[40],
        "cell at the pole": points[30],
    }[request.param]
    east = np.cross([0.3, 0.5, -0.2], target)
    east /= np.linalg.norm(east)
    rotation = np.stack([east, np.cross(target, east), target])
    return mesh_from_points(points @ rotation.T)


def test_raster_is_the_inverse_of_the_map_and_ends_at_its_rim() -> None:
    longitude, latitude = (each.reshape(40, 80) for each in mollweide_raster(40, 80))
    x, y = np.moveaxis(mollweide(longitude, latitude), -1, 0)
    columns = 2 * np.sqrt(2) * (np.arange(80) - 39.5) / 40
    rows = np.sqrt(2) * (np.arange(40) - 19.5) / 20
    inside = np.abs(longitude) < np.pi
    assert np.mean(inside) == pytest.approx(np.pi / 4, rel=0.01)
    np.testing.assert_allclose(y, np.broadcast_to(rows[:, None], (40, 80)), atol=1e-10)
    np.testing.assert_allclose(x[inside], np.broadcast_to(columns, (40, 80))[inside], atol=1e-10)
    at_rim = columns**2 / 8 + rows[:, None] ** 2 / 2 > 1
    np.testing.assert_array_equal(at_rim, ~inside)


def patches_covering(polygons: Polygons, place: np.ndarray) -> set[int]:
    return {
        int(patch)
        for outline, patch in zip(polygons.outlines, polygons.shown, strict=True)
        if Outline(outline).contains_point(place, radius=1e-9)
    }


@pytest.mark.slow
@pytest.mark.parametrize("globe_map", [MOLLWEIDE, CYLINDRICAL], ids=["mollweide", "cylindrical"])
def test_every_place_on_the_map_shows_the_nearest_cell(turned_mesh: VoronoiMesh, globe_map: GlobeMap) -> None:
    """Random places, and places near the poles and the map's rim, lie in the polygon of the nearest generator."""
    random = np.random.default_rng(0)
    longitude = np.concatenate([random.uniform(-np.pi, np.pi, 60), [-3.1415, 3.1415] * 10, random.uniform(-3, 3, 20)])
    latitude = np.concatenate([np.arcsin(random.uniform(-1, 1, 80)), [1.56, -1.56, 1.5, -1.5] * 5])
    central = 4.0
    polygons = globe_polygons(globe_map, cell_patches(turned_mesh), central)
    points = from_lonlat(longitude + central, latitude)
    distances = points @ turned_mesh.cell_points.T
    nearest = distances.argmax(axis=1)
    gap = np.sort(distances, axis=1)
    clear = gap[:, -1] - gap[:, -2] > 0.02 * (1 - gap[:, -1])  # not on the side of two cells
    wrong = 0
    for place, cell, decided in zip(globe_map.project(longitude, latitude), nearest, clear, strict=True):
        shown = patches_covering(polygons, place)
        assert shown, "a hole in the map"
        wrong += bool(decided and cell not in shown)
    assert wrong <= (30 if turned_mesh.n_cells < 50 else 6)  # sides are drawn straight


def test_polygons_cover_the_ellipse_once(turned_mesh: VoronoiMesh) -> None:
    polygons = globe_polygons(MOLLWEIDE, cell_patches(turned_mesh), 0.0)
    assert set(polygons.shown) == set(range(turned_mesh.n_cells))
    single = [k for k, cell in enumerate(polygons.shown) if np.count_nonzero(polygons.shown == cell) == 1]
    areas = np.array([polygon_area(polygons.outlines[k]) for k in single])
    expected = turned_mesh.area_cell[polygons.shown[single]]
    if turned_mesh.n_cells > 50:  # sides are drawn straight
        assert areas.sum() == pytest.approx(expected.sum(), rel=0.03)


def test_orthographic_view_shows_the_near_side_up_to_the_limb(icosahedral_mesh: VoronoiMesh) -> None:
    polygons = orthographic_polygons(cell_patches(icosahedral_mesh), 1.0, 0.4)
    area = sum(polygon_area(outline) for outline in polygons.outlines)
    assert area == pytest.approx(np.pi, rel=0.01)
    assert np.max([np.linalg.norm(outline, axis=1).max() for outline in polygons.outlines]) <= 1 + 1e-12
    towards = from_lonlat(np.array(1.0), np.array(0.4))
    front = set(np.flatnonzero(icosahedral_mesh.cell_points @ towards > 0))
    assert front <= set(polygons.shown.tolist())
    opposite = set(np.flatnonzero(icosahedral_mesh.cell_points @ towards < -0.2))
    assert not opposite & set(polygons.shown.tolist())


@pytest.mark.parametrize("globe_map", [MOLLWEIDE, CYLINDRICAL], ids=["mollweide", "cylindrical"])
@pytest.mark.parametrize("patches_of", [cell_patches, edge_patches, triangle_patches])
@pytest.mark.parametrize("central", [0.0, np.pi, 4.0])
def test_a_map_has_neither_holes_nor_smears(
    turned_mesh: VoronoiMesh, patches_of: Callable[[VoronoiMesh], Patches], globe_map: GlobeMap, central: float
) -> None:
    """A grid of places is covered, and hardly any of them twice: a polygon across a seam would cover many again."""
    polygons = globe_polygons(globe_map, patches_of(turned_mesh), central)
    longitude, latitude = (
        angles.ravel() for angles in np.meshgrid(np.linspace(-3.14, 3.14, 45), np.linspace(-1.56, 1.56, 31))
    )
    places = globe_map.project(longitude, latitude)
    times = sum(Outline(outline).contains_points(places).astype(int) for outline in polygons.outlines)
    assert np.mean(times == 0) < 0.01
    assert np.mean(times > 1) < 0.03  # sides of coarse meshes are drawn straight

"""Figures of meshes on planes: polygons are whole and cover the paper, seams are not seen, axes are lengths."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline

from mesh import VoronoiMesh, hexagon_mesh
from mesh.arrays import Array
from mesh.geometry.surface import surface_of
from mesh.partition.cell_graph import cell_graph
from mesh.partition.partition import partition_graph
from postprocess.figures.block_map import block_figure
from postprocess.figures.field_map import plot_field
from postprocess.figures.maps import LAND
from postprocess.figures.paper import PlanePaper, paper_of
from postprocess.figures.patches import Patches, cell_patches, edge_patches, triangle_patches
from postprocess.figures.plots import field_figure, mesh_figure
from postprocess.figures.projections import plane_polygons
from swe.errors import InputError
from tests.postprocess.conftest import LENGTHS


def areas_of(patches: Patches) -> Array:
    """Areas (n,) of flat polygons."""
    x, y, _ = np.moveaxis(patches.corners, -1, 0)
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)


def nearest_by_hand(mesh: VoronoiMesh, points: Array) -> Array:
    """The cell whose generator, or an image of it, is nearest to each of the points (n, 2)."""
    ways = surface_of(mesh).shortest(mesh.cell_points[None, :, :] - np.pad(points, ((0, 0), (0, 1)))[:, None, :])
    return np.argmin(np.linalg.norm(ways, axis=-1), axis=1)


def inside(box: tuple[float, float, float, float], count: int) -> Array:
    left, right, bottom, top = box
    return np.random.default_rng(5).uniform((left, bottom), (right, top), (count, 2))


def test_polygons_are_whole(any_plane: VoronoiMesh) -> None:
    """Those at the seams have the areas that they have elsewhere."""
    mesh = any_plane
    np.testing.assert_allclose(areas_of(cell_patches(mesh)), mesh.area_cell, rtol=1e-9)
    np.testing.assert_allclose(areas_of(triangle_patches(mesh)), mesh.area_triangle, rtol=1e-9)
    assert areas_of(edge_patches(mesh)).sum() == pytest.approx(mesh.area_cell.sum(), rel=1e-9)


@pytest.mark.parametrize("box", [None, (9e5, 11e5, -1e5, 2e5)], ids=["whole", "over a corner"])
def test_each_place_is_covered_by_the_image_of_its_cell(
    any_plane: VoronoiMesh, box: tuple[float, float, float, float] | None
) -> None:
    mesh, paper = any_plane, PlanePaper(any_plane)
    box = box or paper.box
    polygons = plane_polygons(cell_patches(mesh), surface_of(mesh).periods, box)
    points = inside(box, 100)
    covered = np.array([Outline(outline).contains_points(points) for outline in polygons.outlines])
    there = covered.any(axis=0)
    assert covered.sum(axis=0).max() == 1
    assert there.all() == (mesh.y_period > 0.0)
    np.testing.assert_array_equal(
        polygons.shown[np.argmax(covered, axis=0)][there], nearest_by_hand(mesh, points)[there]
    )


def test_a_field_is_drawn_from_border_to_border_with_lengths_as_axes(periodic_plane: VoronoiMesh) -> None:
    axes = plot_field(periodic_plane, "x_cell", ax=Figure().subplots())
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.0, LENGTHS[0]), (0.0, pytest.approx(LENGTHS[1])))
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_aspect()) == ("x (km)", "y (km)", 1.0)
    axes.get_figure().draw_without_rendering()
    assert [label.get_text() for label in axes.get_xticklabels()][1] == "200"


def test_small_planes_are_in_metres() -> None:
    small = hexagon_mesh((8.0, 4.0 * np.sqrt(3.0)), (8, 8))
    assert plot_field(small, "x_cell", ax=Figure().subplots()).get_xlabel() == "x (m)"
    figure = mesh_figure(small)
    assert [axes.get_xlabel() for axes in figure.get_axes()].count("area of cells (m²)") == 1


def test_land_is_beyond_walls(channel: VoronoiMesh, periodic_plane: VoronoiMesh) -> None:
    beyond = plot_field(channel, "area_cell", ax=Figure().subplots())
    assert beyond.get_facecolor() == to_rgba(LAND)
    assert beyond.get_ylim()[0] < channel.y_vertex.min()
    assert plot_field(periodic_plane, "area_cell", ax=Figure().subplots()).get_facecolor() != to_rgba(LAND)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"projection": "mollweide"}, "a plane is drawn as it is, without projection, centre and extent"),
        ({"centre": (270.0, 0.0)}, "a plane is drawn as it is"),
        ({"extent": 30.0}, "a plane is drawn as it is"),
        ({"region": (0.0, 2e6, 0.0, 1e5)}, "is 2e\\+06 m long where the plane repeats itself after 1e\\+06 m"),
        ({"region": (1e5, 0.0, 0.0, 1e5)}, "left below right"),
        ({"region": (0.0, 1.0)}, "give four numbers, left, right, bottom and top in metres"),
    ],
    ids=str,
)
def test_what_planes_do_not_have_is_refused(periodic_plane: VoronoiMesh, options: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        plot_field(periodic_plane, "x_cell", ax=Figure().subplots(), **options)


def test_figures_of_a_plane_have_one_map(any_plane: VoronoiMesh) -> None:
    figure = field_figure(any_plane, any_plane.x_cell, "Title", "label (m)")
    drawn, bar = figure.get_axes()
    assert len(drawn.collections[-1].get_paths()) >= any_plane.n_cells
    assert bar.get_xlabel() == "label (m)"


def test_measures_of_regular_hexagons_do_not_show_round_off(periodic_plane: VoronoiMesh) -> None:
    figure = mesh_figure(periodic_plane)
    drawn = next(axes for axes in figure.get_axes() if axes.collections)
    assert np.ptp(drawn.collections[-1].get_array()) == 0.0
    widths = [axes.get_xlim() for axes in figure.get_axes() if axes.get_ylabel().startswith("number of")]
    assert all(high - low > 0.005 for low, high in widths)


def test_pixels_cover_what_cells_do(any_plane: VoronoiMesh) -> None:
    raster, (left, right, bottom, top) = paper_of(any_plane).raster, PlanePaper(any_plane).box
    share = any_plane.area_cell.sum() / ((right - left) * (top - bottom))
    assert raster.covered.mean() == pytest.approx(share, abs=2e-3)
    assert raster.covered.shape == raster.places[0].shape == (raster.shape[0] * raster.shape[1],)


def test_cells_round_one_at_a_seam_belong_together(periodic_plane: VoronoiMesh) -> None:
    paper, spacing = paper_of(periodic_plane), LENGTHS[0] / 12
    closeup = paper.around(0, 1.2 * spacing)
    assert set(closeup.cells) == {0, *periodic_plane.cells_on_cell[0]}
    for outline, center in zip(closeup.polygons.outlines, closeup.centers, strict=True):
        assert np.abs(outline - center).max() < 0.6 * spacing
    assert paper.place_in_words(0) == "x = 20.83 km, y = 36.08 km"


def test_blocks_are_drawn_on_the_plane(any_plane: VoronoiMesh) -> None:
    pytest.importorskip("pymetis")
    graph = cell_graph(any_plane)
    figure = block_figure(any_plane, graph, partition_graph(graph, 4))
    (axes,) = figure.get_axes()
    assert axes.get_xlabel() == "x (km)"
    assert len(np.unique(axes.collections[-1].get_array())) > 1

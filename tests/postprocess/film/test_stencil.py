"""Stencils: every pixel shows the right cell, and pictures have what a map has."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from mesh import VoronoiMesh, cull_mesh, find_region, scvt_mesh
from mesh.geometry.sphere import from_lonlat
from mesh.geometry.surface import surface_of
from postprocess.figures.field_map import plot_field
from postprocess.figures.projections import orthographic
from postprocess.film.stencil import Stencil, stencil_of

SIZE = 300
WITHIN = np.cos(np.radians(70.0))


def stencil_from_above(mesh: VoronoiMesh, count: int) -> tuple[Stencil, np.ndarray, np.ndarray]:
    """The stencil from above (0, 0), pixels (n_cells, 2) of the cells' centres, row and column, and which face us."""
    axes = Figure(figsize=(SIZE / 100.0, SIZE / 100.0), dpi=100.0).add_axes((0.0, 0.0, 1.0, 1.0))
    plot_field(mesh, np.arange(float(count)), axes, projection="orthographic", colour_bar=False)
    place = orthographic(mesh.cell_points / np.linalg.norm(mesh.cell_points, axis=1)[:, None], 0.0, 0.0)
    axes.get_figure().draw_without_rendering()
    across, up = np.floor(axes.transData.transform(place[:, :2])).astype(int).T
    return stencil_of(axes), np.stack([SIZE - 1 - up, across], axis=1), place[:, 2] > WITHIN


@pytest.fixture(scope="module")
def coarse_mesh() -> VoronoiMesh:
    return scvt_mesh(642)


def test_pixels_show_their_cells(coarse_mesh: VoronoiMesh) -> None:
    stencil, pixels, near = stencil_from_above(coarse_mesh, 642)
    assert stencil.shown.shape == (SIZE, SIZE)
    np.testing.assert_array_equal(stencil.shown[tuple(pixels[near].T)], np.flatnonzero(near))


def test_edges_and_vertices_have_pixels(coarse_mesh: VoronoiMesh) -> None:
    for around in (coarse_mesh.cells_on_vertex, coarse_mesh.cells_on_edge):
        stencil, pixels, near = stencil_from_above(coarse_mesh, len(around))
        cells = np.flatnonzero(near)
        # At its centre a cell touches the triangles, or quadrilaterals, of its own vertices, or edges.
        for cell, number in zip(cells, stencil.shown[tuple(pixels[cells].T)], strict=True):
            assert cell in around[number]


def test_cells_have_their_colours_and_all_else_keeps_its_own(coarse_mesh: VoronoiMesh) -> None:
    stencil, _, _ = stencil_from_above(coarse_mesh, 642)
    red, blue = (np.tile(np.array(colour, dtype=np.uint8), (642, 1)) for colour in ([250, 40, 0], [0, 40, 250]))
    first, second = stencil.picture(red), stencil.picture(blue)
    same = (first == second).all(axis=-1)
    assert same[0, 0]
    assert (first[0, 0] == 255).all()
    assert (first[SIZE // 2, SIZE // 2 - 20] == [250, 40, 0]).all()
    # Round and over the values: the rim and the meridians, whose share of the pixel is theirs.
    assert 0.6 < np.mean((first == [250, 40, 0]).all(axis=-1)) / np.mean(~same) < 1.0


def test_land_stays_grey(coarse_mesh: VoronoiMesh) -> None:
    sea = cull_mesh(coarse_mesh, find_region("0,60,-30,30"))
    stencil, _, _ = stencil_from_above(sea, sea.n_cells)
    picture = stencil.picture(np.zeros((sea.n_cells, 3), dtype=np.uint8))
    _, y, z = from_lonlat(np.radians(np.array([-40.0, 30.0])), np.radians(np.array([12.0, 12.0]))).T
    columns = (SIZE * (0.5 + 0.5 * y / 1.05)).astype(int)
    row = int(SIZE * (1.05 - z[0]) / 2.2)
    assert (picture[row, columns[0]] == 204).all()
    assert (picture[row, columns[1]] == 0).all()


def test_pixels_of_a_plane_show_the_cell_with_the_nearest_image(any_plane: VoronoiMesh) -> None:
    mesh = any_plane
    axes = Figure(figsize=(SIZE / 100.0, SIZE / 100.0), dpi=100.0).add_axes((0.0, 0.0, 1.0, 1.0))
    plot_field(mesh, np.arange(float(mesh.n_cells)), axes, colour_bar=False)
    axes.get_figure().draw_without_rendering()
    rows, columns = np.random.default_rng(2).integers(0, SIZE, (2, 400))
    points = axes.transData.inverted().transform(np.stack([columns + 0.5, SIZE - rows - 0.5], axis=1))
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    if mesh.y_period == 0.0:  # beyond walls nothing is shown
        bottom, top = mesh.y_cell.min(), mesh.y_cell.max()
    if mesh.x_period == 0.0:
        left, right = mesh.x_cell.min(), mesh.x_cell.max()
    there = np.all((points > (left, bottom)) & (points < (right, top)), axis=1)
    ways = surface_of(mesh).shortest(mesh.cell_points[None] - np.pad(points, ((0, 0), (0, 1)))[:, None])
    distances = np.linalg.norm(ways, axis=-1)
    shown = stencil_of(axes).shown[rows, columns]
    pixel = np.hypot(right - left, top - bottom) / SIZE
    assert there.sum() > 150
    assert np.all((distances[np.arange(400), shown] < distances.min(axis=1) + pixel)[there])

"""Where a plane is on paper: its pixels, the images of its cells, its lengths as words and ticks, and its border."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.spatial import cKDTree

from mesh import VoronoiMesh, hexagon_mesh
from mesh.discrete.walls import wall_edges
from mesh.geometry.surface import surface_of
from mesh.parts.cutting import without_cells
from postprocess.figures.paper import PlanePaper, paper_of
from tests.postprocess.conftest import LENGTHS

ROW = 0.5 * np.sqrt(3.0)


def moved(mesh: VoronoiMesh, x: float, y: float) -> VoronoiMesh:
    """The mesh with all its places farther by x and y, metres, beyond its periods if need be."""
    shifts = {"x": x, "y": y}
    places = ("cell", "edge", "vertex")
    names = {f"{axis}_{place}": shift for axis, shift in shifts.items() for place in places}
    return replace(mesh, **{name: getattr(mesh, name) + shift for name, shift in names.items()})


def test_pixels_are_drawn_where_they_are(any_plane: VoronoiMesh) -> None:
    """The image that is drawn has at each pixel the value of its place, row by row from the south."""
    raster = paper_of(any_plane).raster
    rows, columns = raster.shape
    x, y = raster.places
    values = (x + 3.0 * y).reshape(raster.shape)
    axes = raster.draw(Figure().subplots(), values, {})
    (image,) = axes.images
    left, right, bottom, top = image.get_extent()
    assert (left, right, bottom, top) == PlanePaper(any_plane).box
    assert image.origin == "lower"
    width, height = (right - left) / columns, (top - bottom) / rows
    assert width == pytest.approx(height, rel=0.01)
    for row, column in ((0, 0), (5, 17), (rows - 1, 3)):
        place = left + (column + 0.5) * width, bottom + (row + 0.5) * height
        assert image.get_array()[row, column] == pytest.approx(place[0] + 3.0 * place[1], rel=1e-12)


def test_pixels_without_cells_are_not_covered() -> None:
    """Also where the first cell of an edge is the one that is missing."""
    whole = hexagon_mesh((1e6, 1e6 * ROW), (16, 16), "none")
    kept = np.hypot(whole.x_cell - 5e5, whole.y_cell - 4e5) > 2e5
    part = without_cells(whole, ~kept)
    assert len(np.unique(np.argmin(part.cells_on_edge[wall_edges(part)], axis=1))) == 2
    raster = paper_of(part).raster
    x, y = raster.places
    nearest = cKDTree(np.column_stack([whole.x_cell, whole.y_cell])).query(np.column_stack([x, y]))[1]
    within = np.hypot(x - 5e5, y - 4e5) < 3e5
    np.testing.assert_array_equal(raster.covered[within], kept[nearest][within])
    assert 0.05 < np.mean(~raster.covered) < 0.25


def test_spots_are_the_images_that_are_drawn(periodic_plane: VoronoiMesh) -> None:
    away = moved(periodic_plane, 0.4 * LENGTHS[0], -0.7 * LENGTHS[1])
    scattered = np.arange(away.n_cells) % 3 * np.array(LENGTHS)[:, None]
    away = replace(away, x_cell=away.x_cell + scattered[0], y_cell=away.y_cell - scattered[1])
    paper = PlanePaper(away)
    left, right, bottom, top = paper.box
    x, y = paper.spots(np.arange(away.n_cells))
    assert ((x >= left) & (x <= right) & (y >= bottom) & (y <= top)).all()
    ways = surface_of(away).shortest(np.column_stack([x - away.x_cell, y - away.y_cell, 0.0 * x]))
    np.testing.assert_allclose(ways, 0.0, atol=1e-6)


def test_the_border_is_where_cells_are(periodic_plane: VoronoiMesh, channel: VoronoiMesh) -> None:
    width, height = LENGTHS
    assert PlanePaper(periodic_plane).box == pytest.approx((0.0, width, 0.0, height), abs=1e-3)
    # Whole periods farther, the box goes with the cells; with parts of periods, it begins at the first cell.
    far = PlanePaper(moved(periodic_plane, -2.0 * width, 3.0 * height)).box
    assert far == pytest.approx((-2.0 * width, -width, 3.0 * height, 4.0 * height), abs=1e-3)
    between = moved(periodic_plane, 0.4 * width, 0.0)
    assert PlanePaper(between).box[0] == between.x_cell.min()
    # Beyond walls there is a margin of a fiftieth of the longer side.
    low, high = channel.y_vertex.min(), channel.y_vertex.max()
    margin = 0.02 * max(width, high - low)
    assert PlanePaper(channel).box == pytest.approx((0.0, width, low - margin, high + margin), abs=1e-3)


@pytest.mark.parametrize(("length", "symbol"), [(1.01e4, "km"), (9.9e3, "m")])
def test_lengths_are_in_kilometres_from_ten_on(length: float, symbol: str) -> None:
    mesh = hexagon_mesh((length, length * ROW), (8, 8))
    paper = paper_of(mesh)
    assert paper.unit == ({"km": 1e3, "m": 1.0}[symbol], symbol)
    x, y = paper.place_in_words(0).split(", ")
    assert x == f"x = {length / 32.0 / paper.unit[0]:.4g} {symbol}"
    assert y == f"y = {length * ROW / 16.0 / paper.unit[0]:.4g} {symbol}"
    axes = paper.draw(Figure().subplots(), mesh.x_cell, {})
    assert (axes.get_xlabel(), axes.get_ylabel()) == (f"x ({symbol})", f"y ({symbol})")


def test_ticks_below_zero_have_a_minus_sign(periodic_plane: VoronoiMesh) -> None:
    mesh = moved(periodic_plane, 0.0, -LENGTHS[1])
    axes = paper_of(mesh).draw(Figure().subplots(), mesh.x_cell, {})
    axes.get_figure().draw_without_rendering()
    assert {"\N{MINUS SIGN}600", "\N{MINUS SIGN}200", "0"} <= {label.get_text() for label in axes.get_yticklabels()}


def test_the_width_of_a_cell_is_that_on_paper() -> None:
    """On wide planes and on high ones."""
    for columns, rows in ((24, 8), (8, 24)):
        mesh = hexagon_mesh((columns * 1e4, rows * ROW * 1e4), (columns, rows))
        paper = PlanePaper(mesh)
        figure = Figure(figsize=paper.sides.size)
        longer = max(columns, rows * ROW)
        assert paper.width_of_cell == pytest.approx(7.2 / longer, rel=1e-9)
        assert min(figure.get_size_inches()) > paper.width_of_cell * min(columns, rows * ROW)

"""Pages of planes in headless Chromium: what is drawn and read is what the file holds, at the seams too."""

from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, hexagon_mesh
from mesh.geometry.surface import surface_of
from postprocess import open_run
from postprocess.view import view_page
from tests.postprocess.view.conftest import OpenPage
from tests.postprocess.view.test_in_browser import choose_field, colour_at, colour_of, middle, reading_at, settle

pytestmark = pytest.mark.slow

OF_THE_SEAMS = [(0.0, 0.0), (4e5, 3e5), (2e5, 0.0)]
"""Metres: where seams of the file cross in the middle of the picture, where the rim is on them, and one of both."""


@pytest.fixture(scope="module")
def plane_page(plane_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return view_page(open_run(plane_run), tmp_path_factory.mktemp("pages") / "plane.html")


def in_metres(tab: Any, place: dict[str, float]) -> np.ndarray:
    return np.array([*tab.evaluate("(place) => window.trisk.surface.inMetres(place)", place), 0.0])


def look_at(tab: Any, x: float, y: float, zoom: float = 1.0) -> float:
    """Point the camera to a place in metres; return the pixels of a metre."""
    tab.evaluate(
        "([x, y, zoom]) => {const {unit} = trisk.surface;"
        "Object.assign(trisk.state.camera, {x: x / unit, y: y / unit, zoom}); trisk.move()}",
        [x, y, zoom],
    )
    settle(tab)
    return float(tab.evaluate("trisk.picture.framing(trisk.state).scale / trisk.surface.unit"))


def nearest_cell(mesh: VoronoiMesh, point: np.ndarray) -> int:
    return int(np.argmin(surface_of(mesh).distance(mesh.cell_points, point)))


@pytest.mark.parametrize("camera", OF_THE_SEAMS)
def test_the_value_under_the_pointer_is_that_of_the_file(
    open_page: OpenPage, plane_page: Path, plane_run: Path, irregular_plane: VoronoiMesh, camera: tuple[float, float]
) -> None:
    tab = open_page(plane_page)
    tab.locator("#slider").fill("2")
    choose_field(tab, "velocity zonal")
    pixels = look_at(tab, *camera)
    x, y = middle(tab)
    with netCDF4.Dataset(plane_run / "history.nc") as file:
        values = np.asarray(file["velocity_zonal"][2])
        step = np.ptp(np.asarray(file["velocity_zonal"][:])) / (2**16 - 2)
    seen = set()
    for east, north in [(5e3, 2e3), (1.5e5, 2e5), (-1.2e5, -2e5), (-3.9e5, 1e4), (3.9e5, -2.9e5), (1e4, 2.9e5)]:
        reading = reading_at(tab, x + east * pixels, y - north * pixels)
        point = in_metres(tab, reading["place"])
        expected = np.array([camera[0] + east, camera[1] + north, 0.0])
        assert np.abs(surface_of(irregular_plane).shortest(point - expected)).max() < 1.0 / pixels
        assert ((point[:2] >= 0.0) & (point[:2] < [8e5, 6e5])).all()
        assert reading["number"] == nearest_cell(irregular_plane, point)
        assert abs(reading["values"][0] - values[reading["number"]]) <= 0.5 * step * (1 + 1e-6)
        words = f"cell {reading['number']} at x {point[0] / 1e3:.1f} km, y {point[1] / 1e3:.1f} km: "
        assert tab.locator("#reading").inner_text().startswith(words)
        seen.add(reading["number"])
    assert len(seen) == 6


def test_cells_have_their_own_colours_and_leave_no_gaps(open_page: OpenPage, plane_page: Path) -> None:
    """All over one period round the camera, wherever the seams of the file are, and a whole cell beyond."""
    tab = open_page(plane_page)
    choose_field(tab, "thickness")
    x, y = middle(tab)
    for camera in OF_THE_SEAMS:
        pixels = look_at(tab, *camera)
        plain = 0
        for east in np.linspace(-3.97e5, 3.97e5, 5):
            for north in np.linspace(-2.97e5, 2.97e5, 3):
                right, down = round(x + east * pixels), round(y - north * pixels)
                reading = reading_at(tab, right + 0.5, down + 0.5)
                tab.mouse.move(x, y + 0.25)  # the cell under the pointer has a rim of its own
                settle(tab)
                plain += np.abs(colour_at(tab, right, down) - colour_of(tab, reading["values"][0])).max() <= 24
        assert plain >= 13, camera  # but for pixels on lines
    look_at(tab, 4e5, 3e5)
    for east in (-4.9e5, 4.9e5):
        np.testing.assert_array_equal(colour_at(tab, x + east * pixels, y), [0xFF] * 3)


def test_images_at_the_rim_are_whole_cells(open_page: OpenPage, plane_page: Path, irregular_plane: VoronoiMesh) -> None:
    """A cell that the border of the period cuts is drawn and read on both sides, and nothing where none is drawn."""
    tab = open_page(plane_page)
    mesh = irregular_plane
    pixels = look_at(tab, 4e5, 3e5)
    x, y = middle(tab)
    rings = mesh.vertex_points[mesh.vertices_on_cell] - mesh.cell_points[:, None]
    rings = np.where(mesh.on_ring[:, :, None], surface_of(mesh).shortest(rings), 0.0)
    ways = rings[:, :, 0]
    west = surface_of(mesh).shortest(mesh.cell_points)[:, 0] + ways.min(axis=1)  # of the border, if negative
    inside = (mesh.y_cell > 1e5) & (mesh.y_cell < 5e5)
    cut = np.flatnonzero(inside & (west < -2e3) & (west + np.ptp(ways, axis=1) > 2e3))
    # Just within the western corner of each cell, and which of these are as near the border as cells reach.
    corners = mesh.cell_points + 0.8 * rings[np.arange(mesh.n_cells), ways.argmin(axis=1)]
    beside = np.flatnonzero(inside & (west > 2e3) & (corners[:, 0] < 0.9 * np.ptp(ways, axis=1).max() / 2.0))
    assert min(len(cut), len(beside)) >= 3
    for cell in cut:
        from_border = surface_of(mesh).shortest(mesh.cell_points[cell])[0]
        for border in (-4e5, 4e5):
            right, down = x + (border + from_border) * pixels, y - (mesh.y_cell[cell] - 3e5) * pixels
            assert reading_at(tab, right, down)["number"] == cell
            tab.mouse.move(x, y)
            settle(tab)
            assert colour_at(tab, right, down).min() < 0xF0  # not the paper
    for cell in beside:  # whose images beyond the other border are not drawn
        right, down = x + (4e5 + corners[cell, 0]) * pixels, y - (corners[cell, 1] - 3e5) * pixels
        tab.mouse.move(right, down)
        settle(tab)
        assert tab.evaluate("window.trisk.reading") is None
        np.testing.assert_array_equal(colour_at(tab, right, down), [0xFF] * 3)
    tab.mouse.move(x - 4.9e5 * pixels, y)
    settle(tab)
    assert tab.locator("#reading").inner_text().startswith("Point at a cell")


def test_drag_wheel_and_whole_view(open_page: OpenPage, plane_page: Path) -> None:
    tab = open_page(plane_page)
    assert not tab.locator("#projection").is_visible()
    x, y = (round(each) for each in middle(tab))  # wheels tell whole pixels
    before = reading_at(tab, x + 100, y + 50)
    tab.mouse.wheel(0, -1500)
    settle(tab)
    zoom = tab.evaluate("window.trisk.state.camera.zoom")
    assert zoom == pytest.approx(np.exp(2.25))
    held = reading_at(tab, x + 100, y + 50)
    pixels = tab.evaluate("trisk.picture.framing(trisk.state).scale")
    assert [held["place"][axis] for axis in "xy"] == pytest.approx(
        [before["place"][axis] for axis in "xy"], abs=1 / pixels
    )
    tab.mouse.down()
    tab.mouse.move(x + 160, y + 20, steps=4)
    tab.mouse.up()
    dragged = reading_at(tab, x + 160, y + 20)
    assert [dragged["place"][axis] for axis in "xy"] == pytest.approx([held["place"][axis] for axis in "xy"], abs=1e-9)
    tab.locator("#whole").click()
    assert tab.evaluate("window.trisk.state.camera") == {"x": 0.5, "y": 0.375, "zoom": 1}


def test_vertices_and_edges_have_polygons_of_their_own(
    open_page: OpenPage, plane_run: Path, irregular_plane: VoronoiMesh, tmp_path: Path
) -> None:
    page = view_page(open_run(plane_run), tmp_path / "page.html", fields=["potential_vorticity", "normal_velocity"])
    tab = open_page(page)
    look_at(tab, 0.0, 0.0, 4.0)
    x, y = middle(tab)
    surface = surface_of(irregular_plane)
    with netCDF4.Dataset(plane_run / "history.nc") as file:
        vorticity, velocity = (np.asarray(file[name][0]) for name in ("potential_vorticity", "normal_velocity"))
    reading = reading_at(tab, x + 33, y + 21)
    point = in_metres(tab, reading["place"])
    corners = surface.shortest(irregular_plane.cell_points[irregular_plane.cells_on_vertex[reading["number"]]] - point)
    assert (np.cross(corners, np.roll(corners, -1, axis=0))[:, 2] > 0).all()
    assert reading["values"][0] == pytest.approx(vorticity[reading["number"]], rel=1e-4)
    choose_field(tab, "normal velocity")
    reading = reading_at(tab, x + 33, y + 21)
    nearest = nearest_cell(irregular_plane, in_metres(tab, reading["place"]))
    assert reading["number"] in irregular_plane.edges_on_cell[nearest]
    assert reading["values"][0] == pytest.approx(velocity[reading["number"]], abs=np.ptp(velocity) / 2**15)


def test_a_channel_alone_has_walls_and_no_days(open_page: OpenPage, tmp_path: Path) -> None:
    mesh = hexagon_mesh((8e5, 2e5 * np.sqrt(3.0)), (16, 8), "x")
    tab = open_page(view_page(mesh, tmp_path / "channel.html"))
    assert not tab.locator("#slider").is_visible()
    assert tab.locator("#field option").all_inner_texts() == ["cell area", "sigma", "distance to centroid"]
    pixels = look_at(tab, 0.0, float(mesh.y_cell.mean()) - float(mesh.y_vertex.min()))
    x, y = middle(tab)
    for east, north in [(1e3, 2e3), (-1e5, 1.2e5), (3.6e5, -1.2e5)]:
        reading = reading_at(tab, x + east * pixels, y - north * pixels)
        assert reading["number"] == nearest_cell(mesh, in_metres(tab, reading["place"]))
        assert reading["values"][0] == pytest.approx(mesh.area_cell[reading["number"]] / 1e6)
    notch = mesh.vertex_points[np.argmin(mesh.y_vertex)]  # beside it the wall goes up
    down = y - (notch[1] - mesh.y_cell.mean()) * pixels
    east = surface_of(mesh).shortest(notch)[0] + 2.4e4
    tab.mouse.move(x + east * pixels, down - 2)
    settle(tab)
    assert tab.locator("#reading").inner_text().startswith("no cell at x ")
    wall = colour_at(tab, x + east * pixels, down - 0.5 * mesh.dv_edge.min() * pixels)
    assert wall.max() < 0x60

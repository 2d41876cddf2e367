"""Pages in headless Chromium: what is drawn and read is what the file holds."""

import io
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
from PIL import Image

from mesh import VoronoiMesh
from mesh.geometry.sphere import from_lonlat, normalize
from postprocess import open_run
from postprocess.view import view_page
from tests.postprocess.view.conftest import OpenPage

pytestmark = pytest.mark.slow

PIXELS_OF_THE_RIM = 4
STEADY = "() => window.trisk.shown && window.trisk.waiting === undefined"


@pytest.fixture(scope="module")
def mountain_page(mountain_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return view_page(open_run(mountain_run), tmp_path_factory.mktemp("pages") / "mountain.html")


def settle(tab: Any) -> None:
    """Wait until a picture has been drawn after what was done."""
    tab.wait_for_function(STEADY)
    tab.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def choose_field(tab: Any, name: str) -> None:
    tab.locator("#field").select_option(label=name)
    tab.wait_for_function(f"() => window.trisk.shown.field.name.replaceAll('_', ' ') === '{name}'")
    settle(tab)


def middle(tab: Any) -> tuple[float, float]:
    box = tab.locator("#stage").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def reading_at(tab: Any, x: float, y: float) -> dict[str, Any]:
    tab.mouse.move(x, y)
    settle(tab)
    reading = tab.evaluate("window.trisk.reading")
    assert reading is not None
    return reading


def colour_at(tab: Any, x: float, y: float) -> np.ndarray:
    """Red, green and blue of a pixel on the screen."""
    shot = tab.screenshot(clip={"x": round(x), "y": round(y), "width": 1, "height": 1})
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=int)[0, 0]


def colour_of(tab: Any, value: float) -> np.ndarray:
    """The colour in the palette for a value of the first pane."""
    palette, (low, high) = tab.evaluate("[[...window.trisk.colours[0].palette.colours], window.trisk.colours[0].range]")
    table = np.array(palette).reshape(-1, 3)
    return table[round((value - low) / (high - low) * 255)]


def nearest(points: np.ndarray, place: dict[str, float]) -> np.ndarray:
    """Numbers of the generators nearest to a place: more than one on an edge, where round-off decides."""
    along = normalize(points) @ from_lonlat(np.array(place["lon"]), np.array(place["lat"]))
    return np.flatnonzero(along > along.max() - 1e-12)


@pytest.mark.parametrize("view", ["globe", "map"])
def test_the_value_under_the_pointer_is_that_of_the_file(
    open_page: OpenPage, mountain_page: Path, mountain_run: Path, small_mesh: VoronoiMesh, view: str
) -> None:
    tab = open_page(mountain_page)
    tab.locator("#projection").select_option(view)
    tab.locator("#slider").fill("2")
    choose_field(tab, "velocity zonal")
    assert tab.locator("#day").inner_text() == "day 0.5"
    x, y = middle(tab)
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        values = np.asarray(file["velocity_zonal"][2])
        all_values = np.asarray(file["velocity_zonal"][:])
    step = (all_values.max() - all_values.min()) / (2**16 - 2)
    seen = set()
    for right, up in [(0, 0), (90, 60), (-120, -40), (30, -150), (10, 170)]:
        reading = reading_at(tab, x + right, y - up)
        assert reading["number"] in nearest(small_mesh.cell_points, reading["place"])
        assert abs(reading["values"][0] - values[reading["number"]]) <= 0.5 * step * (1 + 1e-6)
        assert f"cell {reading['number']} at" in tab.locator("#reading").inner_text()
        assert "m s⁻¹" in tab.locator("#reading").inner_text()
        seen.add(reading["number"])
    assert len(seen) == 5


@pytest.mark.parametrize("view", ["globe", "map"])
def test_cells_have_their_own_colours(open_page: OpenPage, mountain_page: Path, view: str) -> None:
    """The one that the palette has for its value, but for pixels on lines."""
    tab = open_page(mountain_page)
    tab.locator("#projection").select_option(view)
    x, y = middle(tab)
    tab.mouse.move(x, y)
    tab.mouse.wheel(0, -1200)
    settle(tab)
    assert tab.evaluate("window.trisk.state.camera.zoom") >= 4
    choose_field(tab, "velocity meridional")  # none at the start, so that days look different
    tab.locator("#slider").fill("2")
    plain, seen = 0, set()
    for right, up in [(20, 30), (260, 150), (-260, -120), (-130, 190), (300, -150)]:
        reading = reading_at(tab, x + right, y - up)
        colour, wanted = colour_at(tab, x + right, y - up), colour_of(tab, reading["values"][0])
        on_a_line = colour.sum() < wanted.sum() and np.ptp(wanted - colour) < 0.2 * wanted.max()
        assert np.abs(colour - wanted).max() <= 4 or on_a_line, (right, up)
        plain += not on_a_line
        seen.add(reading["number"])
    assert plain >= 3
    assert len(seen) >= 4


@pytest.mark.parametrize("view", ["globe", "map"])
def test_cells_leave_no_gaps(open_page: OpenPage, mountain_page: Path, view: str) -> None:
    """Nothing of the ground behind shows through, at poles neither."""
    tab = open_page(mountain_page)
    tab.locator("#projection").select_option(view)
    for latitude, zoom in ((0.0, 1), (np.pi / 2, 1), (-np.pi / 2, 4)):
        tab.evaluate(
            f"Object.assign(window.trisk.state.camera, {{lat: {latitude}, zoom: {zoom}}}); window.trisk.move()"
        )
        settle(tab)
        inside, colours = inside_of(tab, view)
        assert np.count_nonzero(inside) > 100_000
        assert np.count_nonzero(inside & (np.abs(colours - 0xCC).max(axis=2) <= 3)) == 0, (latitude, zoom)


def inside_of(tab: Any, view: str) -> tuple[np.ndarray, np.ndarray]:
    """Which pixels of the stage are inside the rim of the globe or the map, and the colours of all of them."""
    shot = np.asarray(Image.open(io.BytesIO(tab.locator("#stage").screenshot())).convert("RGB"), dtype=int)
    scale, (_, centre) = tab.evaluate(
        "(({scale, middle}) => [scale, middle])(window.trisk.picture.framing(window.trisk.state))"
    )
    down, right = np.indices(shot.shape[:2]) - 0.5 * np.array(shot.shape[:2])[:, None, None]
    # The outermost pixels are mixed with what is beyond.
    x, y = (np.abs(right) + PIXELS_OF_THE_RIM) / scale, np.abs(centre - down / scale) + PIXELS_OF_THE_RIM / scale
    return (x**2 + y**2 < 1.0 if view == "globe" else x**2 / 8.0 + y**2 / 2.0 < 1.0), shot


def test_the_map_has_no_gap_at_its_rim(open_page: OpenPage, mountain_page: Path) -> None:
    """Cells that the rim cuts are drawn on both sides of the map."""
    tab = open_page(mountain_page)
    tab.locator("#projection").select_option("map")
    choose_field(tab, "cell area")
    x, y = middle(tab)
    numbers = {}
    half = tab.evaluate("window.trisk.picture.framing(window.trisk.state).scale") * 2 * np.sqrt(2)
    for side in (-1, 1):
        reading = reading_at(tab, x + side * (half - 6), y)
        colour = colour_at(tab, x + side * (half - 6), y)
        assert np.abs(colour - colour_of(tab, reading["values"][0])).max() <= 30
        numbers[side] = reading["number"]
    assert numbers[-1] == numbers[1]


def test_vertices_and_edges_have_polygons_of_their_own(
    open_page: OpenPage, mountain_run: Path, small_mesh: VoronoiMesh, tmp_path: Path
) -> None:
    page = view_page(open_run(mountain_run), tmp_path / "page.html", fields=["potential_vorticity", "normal_velocity"])
    tab = open_page(page)
    x, y = middle(tab)
    with netCDF4.Dataset(mountain_run / "history.nc") as file:
        vorticity, velocity = (np.asarray(file[name][:]) for name in ("potential_vorticity", "normal_velocity"))
    reading = reading_at(tab, x + 33, y + 21)
    corners = normalize(small_mesh.cell_points)[small_mesh.cells_on_vertex[reading["number"]]]
    place = from_lonlat(np.array(reading["place"]["lon"]), np.array(reading["place"]["lat"]))
    assert (np.cross(corners, np.roll(corners, -1, axis=0)) @ place > 0).all()
    assert reading["values"][0] == pytest.approx(vorticity[0, reading["number"]], abs=np.ptp(vorticity) / 2**16)
    choose_field(tab, "normal velocity")
    reading = reading_at(tab, x + 33, y + 21)
    assert reading["number"] in small_mesh.edges_on_cell[nearest(small_mesh.cell_points, reading["place"])]
    assert reading["values"][0] == pytest.approx(velocity[0, reading["number"]], abs=np.ptp(velocity) / 2**16)


def test_land_is_empty(open_page: OpenPage, sea_run: Path, tmp_path: Path) -> None:
    tab = open_page(view_page(open_run(sea_run), tmp_path / "sea.html"))
    tab.evaluate("Object.assign(window.trisk.state.camera, {lon: 0.3, lat: 0, zoom: 1}); window.trisk.move()")
    x, y = middle(tab)
    tab.mouse.move(x, y)
    settle(tab)
    assert tab.evaluate("window.trisk.reading") is None
    assert tab.locator("#reading").inner_text().startswith("land at 0.0")
    np.testing.assert_array_equal(colour_at(tab, x, y - 12), [0xCC] * 3)  # the equator has a line
    tab.evaluate("Object.assign(window.trisk.state.camera, {lon: Math.PI, zoom: 2}); window.trisk.move()")
    settle(tab)
    inside, colours = inside_of(tab, "globe")
    assert np.count_nonzero(inside & (np.abs(colours - 0xCC).max(axis=2) <= 3)) == 0
    tab.locator("#projection").select_option("map")
    reading = reading_at(tab, x + 300, y)
    assert reading["number"] in nearest(open_run(sea_run).mesh.cell_points, reading["place"])


def test_two_runs_have_one_camera_and_one_slider(
    open_page: OpenPage, mountain_run: Path, damped_run: Path, tmp_path: Path
) -> None:
    tab = open_page(view_page(open_run(mountain_run), tmp_path / "two.html", open_run(damped_run)))
    tab.locator("#slider").fill("2")
    box = tab.locator("#stage").bounding_box()
    first = reading_at(tab, box["x"] + box["width"] / 6 + 20, box["y"] + box["height"] / 2)
    last = reading_at(tab, box["x"] + 5 * box["width"] / 6 + 20, box["y"] + box["height"] / 2)
    assert (first["pane"], last["pane"]) == (0, 2)
    assert first["number"] == last["number"]
    with netCDF4.Dataset(mountain_run / "history.nc") as one, netCDF4.Dataset(damped_run / "history.nc") as two:
        values = [float(file["thickness"][2, first["number"]]) for file in (one, two)]
    ours = first["values"]
    assert ours[:2] == pytest.approx(values, abs=0.1)
    assert ours[2] == pytest.approx(values[0] - values[1], abs=1e-3)
    assert "difference" in tab.locator("#reading").inner_text()


def test_keys_and_the_play_button(open_page: OpenPage, mountain_page: Path) -> None:
    tab = open_page(mountain_page)
    tab.keyboard.press("ArrowRight")
    assert tab.locator("#day").inner_text() == "day 0.25"
    tab.keyboard.press("ArrowLeft")
    assert tab.locator("#day").inner_text() == "day 0"
    tab.keyboard.press(" ")
    assert tab.locator("#play").inner_text() == "Pause"
    tab.wait_for_function("() => window.trisk.state.row > 0")
    tab.locator("#play").click()
    assert tab.locator("#play").inner_text() == "Play"
    zoom = tab.evaluate("window.trisk.state.camera.zoom")
    tab.locator("#stage").focus()
    tab.keyboard.press("+")
    assert tab.evaluate("window.trisk.state.camera.zoom") > zoom
    turned = tab.evaluate("window.trisk.state.camera.lon")
    tab.keyboard.press("Shift+ArrowRight")
    assert tab.evaluate("window.trisk.state.camera.lon") != turned

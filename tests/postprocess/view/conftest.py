"""A headless Chromium, and runs that pages show."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cases import LakeAtRest
from cases.plane.waves import InertiaGravityWave
from mesh import VoronoiMesh, periodic_mesh
from mesh.parts.culling import culled
from swe import Simulation

WITHOUT_A_GRAPHICS_CARD = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")

OpenPage = Callable[[Path], Any]


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed; pip install 'trisk[dev]' brings it"
    )
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("there is no chromium on the path; apt-get install chromium brings it")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=program, args=WITHOUT_A_GRAPHICS_CARD)
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[OpenPage]:
    """Open a page in a new tab and wait for its first picture; at the end there must be nothing on its console."""
    messages: list[str] = []
    tabs = []

    def opened(path: Path) -> Any:
        tab = browser.new_page(viewport={"width": 1000, "height": 700})
        tabs.append(tab)
        tab.on("console", lambda message: messages.append(message.text))
        tab.on("pageerror", lambda error: messages.append(str(error)))
        tab.on(
            "request", lambda request: messages.extend([] if request.url.startswith("file:") else [request.url[:80]])
        )
        tab.goto(path.absolute().as_uri())
        tab.wait_for_function("window.trisk && window.trisk.frames > 0")
        return tab

    yield opened
    for tab in tabs:
        tab.close()
    assert messages == []


@pytest.fixture(scope="session")
def sea_run(icosahedral_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a lake at rest, on all of the globe but for a continent round 0 E, 0 N; do not write to."""
    mesh = icosahedral_mesh
    sea = culled(mesh, mesh.cell_points[:, 0] < 0.6 * mesh.sphere_radius)
    directory = tmp_path_factory.mktemp("view") / "sea"
    Simulation(sea, LakeAtRest(), directory, time_step=600.0, snapshot_interval=1200.0).run(
        days=1200.0 / 86400.0, progress=False
    )
    return directory


@pytest.fixture(scope="session")
def irregular_plane() -> VoronoiMesh:
    """Cells of different shapes on a plane of 800 by 600 km that is periodic in both directions."""
    column, row = np.meshgrid(np.arange(16), np.arange(14))
    shaken = np.random.default_rng(17).uniform(-0.3, 0.3, size=(column.size, 2))
    places = np.column_stack([(column + 0.5 * (row % 2)).ravel(), row.ravel()]) + shaken
    return periodic_mesh(places * np.array([8e5 / 16, 6e5 / 14]), (8e5, 6e5))


@pytest.fixture(scope="session")
def plane_run(irregular_plane: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a wave on that plane, three snapshots; do not write to."""
    directory = tmp_path_factory.mktemp("view") / "plane"
    wave = InertiaGravityWave(x_length=8e5, y_length=6e5)
    Simulation(irregular_plane, wave, directory, time_step=200.0, snapshot_interval=3600.0).run(
        days=7200.0 / 86400.0, progress=False
    )
    return directory

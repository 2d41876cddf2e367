"""`plot_field`: what is on the map, where, in which colours, and how it refuses."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline

import trisk
from mesh import VoronoiMesh
from mesh.geometry.sphere import from_lonlat
from postprocess.figures.field_map import Projection
from postprocess.figures.projections import orthographic
from swe.errors import InputError


@pytest.fixture
def ax() -> Axes:
    return Figure().subplots()


@pytest.fixture(autouse=True)
def closed_figures() -> Iterator[None]:
    yield
    plt.close("all")


def drawn_on(ax: Axes) -> PolyCollection:
    (drawn,) = ax.collections
    assert isinstance(drawn, PolyCollection)
    return drawn


def shown_at(ax: Axes, place: np.ndarray) -> list[float]:
    """Values of the polygons over a place of the map."""
    drawn = drawn_on(ax)
    values = np.asarray(drawn.get_array())
    paths = zip(drawn.get_paths(), values, strict=True)
    return [float(value) for path, value in paths if Outline(path.vertices).contains_point(place)]


@pytest.mark.parametrize(
    ("centre", "extent", "projection"),
    [
        ((180.0, 0.0), 20.0, "orthographic"),
        ((30.0, 90.0), 20.0, "orthographic"),
        ((-70.0, -88.0), (30.0, 12.0), "orthographic"),
        ((180.0, 40.0), 20.0, "cylindrical"),
        ((100.0, 85.0), (60.0, 20.0), "cylindrical"),
        ((200.0, 0.0), None, "cylindrical"),
        ((10.0, 50.0), None, "orthographic"),
    ],
)
def test_every_place_in_the_window_shows_its_cell_once(
    ax: Axes,
    larger_mesh: VoronoiMesh,
    centre: tuple[float, float],
    extent: float | tuple[float, float] | None,
    projection: Projection,
) -> None:
    cells = np.arange(larger_mesh.n_cells, dtype=float)
    returned = trisk.plot_field(larger_mesh, cells, ax, centre=centre, extent=extent, projection=projection)
    assert returned is ax
    random = np.random.default_rng(1)
    xlim, ylim = ax.get_xlim(), ax.get_ylim()
    places = np.stack([random.uniform(*xlim, 200), random.uniform(*ylim, 200)], axis=1)
    longitude, latitude = np.radians(centre)
    if projection == "cylindrical":
        points = from_lonlat(*np.radians(places).T)
        assert xlim[0] < centre[0] < xlim[1]
    else:
        places = places[np.hypot(*places.T) < 0.99]
        axes_of_view = orthographic(np.eye(3), longitude, latitude)
        points = np.c_[places, np.sqrt(1.0 - np.sum(places**2, axis=1))] @ axes_of_view.T
    nearest = (points @ larger_mesh.cell_points.T).argmax(axis=1)
    found = [shown_at(ax, place) for place in places]
    assert sum(len(values) != 1 for values in found) <= 1
    right = [nearest[number] in values for number, values in enumerate(found)]
    assert np.mean(right) > 0.97  # sides are drawn straight


def test_only_what_may_be_in_the_window_is_drawn(ax: Axes, larger_mesh: VoronoiMesh) -> None:
    trisk.plot_field(larger_mesh, "area_cell", ax, centre=(0.0, 90.0), extent=20.0)
    assert len(drawn_on(ax).get_paths()) < 60


def test_fields_of_runs_have_names_units_and_the_day(ax: Axes, mountain_run: Path) -> None:
    run = trisk.open_run(mountain_run)
    trisk.plot_field(run, "kinetic_energy", ax)
    assert ax.get_title() == "williamson5, 162 cells, day 0.5"
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_ylabel() == "kinetic energy per unit mass (m² s⁻²)"
    assert set(np.asarray(drawn_on(ax).get_array())) == set(run.last_snapshot().fields["kinetic_energy"])


@pytest.mark.parametrize("time", [0, 1, -2])
def test_time_numbers_the_snapshots(ax: Axes, mountain_run: Path, time: int) -> None:
    run = trisk.open_run(mountain_run)
    trisk.plot_field(str(mountain_run), "thickness", ax, time=time)
    day = float(run.days[time])
    assert ax.get_title().endswith(f"day {day:g}")
    assert set(np.asarray(drawn_on(ax).get_array())) == set(run.snapshot(day).fields["thickness"])


@pytest.mark.parametrize(
    ("name", "label", "corners"),
    [
        ("relative_vorticity", "relative vorticity (s⁻¹)", 3),
        ("normal_velocity", "velocity along the normal (m s⁻¹)", 4),
        ("topography", "height of the bottom (m)", 6),
        ("area_cell", "area of a cell (m²)", 6),
    ],
)
def test_each_place_has_its_polygons(ax: Axes, mountain_run: Path, name: str, label: str, corners: int) -> None:
    trisk.plot_field(mountain_run, name, ax, centre=(20.0, 10.0), extent=40.0)
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_ylabel() == label
    assert {len(path.vertices) for path in drawn_on(ax).get_paths()} == {corners + 1}


def test_values_of_xarray_keep_their_label(ax: Axes, mountain_run: Path) -> None:
    pytest.importorskip("xarray")
    with trisk.open_run(mountain_run) as run:
        trisk.plot_field(run, run.data["thickness"].sel(Time="2000-01-01T06"), ax)
        expected = run.snapshot(0.25).fields["thickness"]
    assert set(np.asarray(drawn_on(ax).get_array())) == set(expected)
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_ylabel() == "thickness of the fluid (m)"


def test_colours_are_symmetric_where_values_have_both_signs(ax: Axes, small_mesh: VoronoiMesh) -> None:
    values = np.linspace(-1.0, 3.0, 162)
    trisk.plot_field(small_mesh, values, ax)
    assert drawn_on(ax).get_clim() == (-3.0, 3.0)
    assert drawn_on(ax).get_cmap().name == "cmo.balance"
    other = Figure().subplots()
    trisk.plot_field(small_mesh, np.where(values > 2.9, np.nan, values + 2.0), other)
    assert drawn_on(other).get_clim() == pytest.approx((1.0, 4.88), abs=0.03)
    assert drawn_on(other).get_cmap().name == "cmo.haline"


@pytest.mark.parametrize(
    ("name", "palette"), [("thickness", "deep"), ("kinetic_energy", "speed"), ("potential_vorticity", "curl")]
)
def test_fields_have_their_palette(ax: Axes, mountain_run: Path, name: str, palette: str) -> None:
    trisk.plot_field(mountain_run, name, ax)
    assert drawn_on(ax).get_cmap().name == f"cmo.{palette}"


@pytest.mark.parametrize("place", ["n_cells", "n_edges", "n_vertices"])
def test_a_region_shows_what_lies_between_its_sides(ax: Axes, larger_mesh: VoronoiMesh, place: str) -> None:
    """Across the date line; colours are those of the polygons that are seen."""
    latitude = {"n_cells": larger_mesh.lat_cell, "n_edges": larger_mesh.lat_edge, "n_vertices": larger_mesh.lat_vertex}
    values = np.degrees(latitude[place]) + 100.0
    trisk.plot_field(larger_mesh, values, ax, region=(150.0, -150.0, 20.0, 40.0))
    assert (ax.get_xlim(), ax.get_ylim()) == ((150.0, 210.0), (20.0, 40.0))
    low, high = drawn_on(ax).get_clim()
    assert 107.0 < low < 120.0 < 140.0 < high < 153.0
    assert np.asarray(drawn_on(ax).get_array()).min() < 100.0


def test_a_region_all_round_and_one_to_360(ax: Axes, small_mesh: VoronoiMesh) -> None:
    trisk.plot_field(small_mesh, "area_cell", ax, region=(-180.0, 180.0, -90.0, 90.0))
    assert (ax.get_xlim(), ax.get_ylim()) == ((-180.0, 180.0), (-90.0, 90.0))


def test_a_row_for_each_snapshot_shows_that_of_the_time(ax: Axes, mountain_run: Path) -> None:
    run = trisk.open_run(mountain_run)
    rows = np.outer([1.0, 2.0, 3.0], np.ones(162))
    trisk.plot_field(run, rows, ax, time=1)
    assert set(np.asarray(drawn_on(ax).get_array())) == {2.0}
    with pytest.raises(InputError, match="none of number 3"):
        trisk.plot_field(run, rows, ax, time=3)


def test_powers_of_ten_are_printed_as_such(ax: Axes, mountain_run: Path) -> None:
    trisk.plot_field(mountain_run, "potential_vorticity", ax)
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    figure.draw_without_rendering()
    assert "10^{" in figure.axes[1].yaxis.get_offset_text().get_text()


def test_colours_and_labels_of_the_caller(ax: Axes, small_mesh: VoronoiMesh) -> None:
    trisk.plot_field(small_mesh, "area_cell", ax, cmap="magma", norm=Normalize(0.0, 2.0), label="mine")
    assert drawn_on(ax).get_clim() == (0.0, 2.0)
    assert drawn_on(ax).get_cmap().name == "magma"
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_ylabel() == "mine"
    bare = Figure().subplots()
    trisk.plot_field(small_mesh, "area_cell", bare, colour_bar=False)
    assert bare.get_figure().axes == [bare]


def test_ticks_of_cylindrical_maps_go_on_across_the_date_line(ax: Axes, small_mesh: VoronoiMesh) -> None:
    trisk.plot_field(small_mesh, "area_cell", ax, centre=(180.0, 40.0), extent=20.0, projection="cylindrical")
    ax.get_figure().draw_without_rendering()
    labels = [label.get_text() for label in ax.get_xticklabels()]
    assert [label for label in labels if label in ("175°E", "180°", "175°W")] == ["175°E", "180°", "175°W"]
    assert "45°N" in [label.get_text() for label in ax.get_yticklabels()]


def test_meridians_and_parallels_of_windows_are_named(ax: Axes, small_mesh: VoronoiMesh) -> None:
    trisk.plot_field(small_mesh, "area_cell", ax, centre=(0.0, -90.0), extent=20.0)
    names = {text.get_text() for text in ax.texts}
    assert {"0°", "90°E", "180°", "90°W", "85°S"} <= names
    assert "90°S" not in names


@pytest.mark.parametrize(("latitude", "side"), [(40.0, -1.0), (89.0, -1.0), (-40.0, -1.0), (-79.0, 1.0), (-90.0, 1.0)])
def test_meridians_are_named_to_the_south_but_near_the_south_pole(
    ax: Axes, small_mesh: VoronoiMesh, latitude: float, side: float
) -> None:
    """At four tenths of the way from the middle to a corner of the window, so that no two names meet at a pole."""
    trisk.plot_field(small_mesh, "area_cell", ax, centre=(0.0, latitude), extent=20.0)
    (place,) = (text.get_position() for text in ax.texts if text.get_text() == "0°")
    corner = np.arcsin(np.sqrt(2.0) * np.sin(np.radians(10.0)))
    assert place == pytest.approx((0.0, side * np.sin(0.4 * corner)), abs=1e-12)


@pytest.mark.parametrize("centre", [(0.0, 0.0), (200.0, 0.0), (30.0, 40.0)])
def test_cylindrical_maps_without_extent_show_the_globe(
    ax: Axes, small_mesh: VoronoiMesh, centre: tuple[float, float]
) -> None:
    trisk.plot_field(small_mesh, "area_cell", ax, centre=centre, projection="cylindrical")
    assert ax.get_xlim() == (centre[0] - 180.0, centre[0] + 180.0)
    assert ax.get_ylim() == (-90.0, 90.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"field": "depth"}, r"there is no field named 'depth'; choose among thickness, .*, topography, .*, area_cell"),
        ({"time": 3}, r"history\.nc has 3 snapshots, and none of number 3; count from 0"),
        ({"time": -4}, "none of number -4"),
        ({"field": np.zeros(5)}, r"values of shape \(5,\) are on no part of a mesh of 162 cells, 480 edges and 320"),
        ({"field": np.zeros((2, 162))}, r"values of shape \(2, 162\) are on no part"),
        ({"projection": "mercator"}, "there is no projection named 'mercator'; choose one of mollweide, orthographic,"),
        ({"centre": (0.0, 91.0)}, r"a map has no centre \(0, 91\)"),
        ({"centre": (np.nan, 0.0)}, r"a map has no centre \(nan, 0\)"),
        (
            {"extent": 181.0},
            "a window of 181 x 181 degrees does not fit on the orthographic map; it may have up to 180",
        ),
        ({"extent": (10.0, 0.0)}, "a window of 10 x 0 degrees does not fit"),
        ({"region": (0.0, 0.0, -10.0, 10.0)}, r"a map has no region \(0.0, 0.0, -10.0, 10.0\); give west, east, south"),
        ({"region": (0.0, 20.0, 10.0, -10.0)}, "south below north"),
        ({"region": (0.0, 20.0, 10.0, 91.0)}, "a map has no region"),
        ({"region": (0.0, 20.0, 10.0)}, "give four numbers, west, east, south and north"),
        ({"region": (0.0, np.nan, 10.0, 20.0)}, "a map has no region"),
        ({"region": (0.0, 20.0, 0.0, 20.0), "extent": 20.0}, "give it without centre and extent"),
        ({"region": (0.0, 20.0, 0.0, 20.0), "projection": "orthographic"}, "on the cylindrical projection"),
        ({"extent": 20.0, "projection": "mollweide"}, "a Mollweide map shows the whole globe"),
        ({"centre": (0.0, 5.0), "projection": "mollweide"}, "a Mollweide map shows the whole globe"),
    ],
)
def test_bad_requests_are_refused_before_a_figure_is_made(
    mountain_run: Path, options: dict[str, object], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        trisk.plot_field(mountain_run, **{"field": "thickness", **options})
    assert not plt.get_fignums()


def test_a_field_of_a_mesh_that_is_none(small_mesh: VoronoiMesh) -> None:
    with pytest.raises(InputError, match="no field named 'thickness'; choose among lat_cell, "):
        trisk.plot_field(small_mesh, "thickness")


def test_backend_and_settings_stay(mountain_run: Path) -> None:
    program = (
        "import sys, matplotlib; matplotlib.use('svg'); before = dict(matplotlib.rcParams)\n"
        "import trisk; from matplotlib.figure import Figure\n"
        f"ax = trisk.plot_field({str(mountain_run)!r}, 'thickness', Figure().subplots())\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
        f"ax = trisk.plot_field({str(mountain_run)!r}, 'thickness', extent=20)\n"
        "import matplotlib.pyplot as plt; assert plt.gcf() is ax.figure\n"
        "print(matplotlib.get_backend(), dict(matplotlib.rcParams) == before)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["svg", "True"]

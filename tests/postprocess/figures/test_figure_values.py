"""What figures of runs show, read back from their axes, against plain numpy on the fields that the run wrote."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from cases import Williamson5
from mesh import scvt_mesh
from postprocess.figures.compare_maps import map_figure
from postprocess.figures.palettes import Colours, colours_for, deviation_colours
from postprocess.figures.paper import COLUMNS, ROWS
from postprocess.figures.plots import plot_run
from postprocess.runs.reading import read_run
from swe import Simulation

Arrays = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("figures") / "run"
    Simulation(scvt_mesh(162), Williamson5(), folder, time_step=1800.0).run(1.0, progress=False)
    return folder


@pytest.fixture(scope="module")
def figures(directory: Path) -> dict[str, Figure]:
    found: dict[str, Figure] = {}

    def take(figure: Figure, path: Path, **_: object) -> None:
        found[path.stem] = figure

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", take)
        plot_run(read_run(directory), directory / "figures")
    return found


@pytest.fixture(scope="module")
def fields(directory: Path) -> Arrays:
    with netCDF4.Dataset(directory / "history.nc") as history, netCDF4.Dataset(directory / "mesh.nc") as mesh:
        names = ("potential_vorticity", "kinetic_energy", "surface_height")
        found = {name: np.asarray(history[name][-1]) for name in names}
        for name in ("kiteAreasOnVertex", "cellsOnVertex", "areaCell", "dcEdge", "edgesOnCell", "nEdgesOnCell"):
            found[name] = np.asarray(mesh[name][:])
    return found


def drawn(figure: Figure) -> list[np.ndarray]:
    """Values of the polygons of each map, one for each cell or part of one."""
    return [
        np.asarray(collection.get_array())
        for axes in figure.axes
        for collection in axes.collections
        if isinstance(collection, PolyCollection)
    ]


def bar_label(figure: Figure) -> str:
    return next(axes.get_xlabel() for axes in figure.axes if axes.get_xlabel())


@pytest.mark.parametrize(
    ("name", "unit", "label", "title"),
    [
        ("kinetic_energy", 1.0, "kinetic energy (m² s⁻²)", "Kinetic energy: williamson5, 162 cells, day 1"),
        ("surface_height", 1.0, "height of the surface (m)", "Surface height: williamson5, 162 cells, day 1"),
        (
            "potential_vorticity",
            1e-8,
            "potential vorticity (10⁻⁸ m⁻¹ s⁻¹)",
            "Potential vorticity: williamson5, 162 cells, day 1",
        ),
    ],
)
def test_maps_show_fields_in_the_units_of_their_bars(
    figures: dict[str, Figure], fields: Arrays, name: str, unit: float, label: str, title: str
) -> None:
    values = fields[name]
    if name == "potential_vorticity":  # kite-weighted means of the vertices
        cells, kites = fields["cellsOnVertex"] - 1, fields["kiteAreasOnVertex"]
        sums = np.zeros(162)
        np.add.at(sums, cells, kites * values[:, None])
        values = sums / fields["areaCell"]
    figure = figures[name]
    assert figure.get_suptitle() == title
    assert bar_label(figure) == label
    wide, round_ = drawn(figure)
    np.testing.assert_allclose(np.unique(wide), np.unique(values / unit), rtol=1e-12)
    assert len(wide) >= 162 > len(round_) > 70
    assert np.isin(round_.round(12), (values / unit).round(12)).all()
    for axes in figure.axes[:2]:
        low, high = axes.collections[0].get_clim()
        if name == "potential_vorticity":
            assert (low, high) == pytest.approx((-np.abs(values).max() / unit, np.abs(values).max() / unit))
            assert axes.collections[0].get_cmap().name == "cmo.curl"
        else:
            energy = name == "kinetic_energy"
            assert (low, high) == pytest.approx((0.0 if energy else values.min(), values.max()))
            assert axes.collections[0].get_cmap().name == ("cmo.speed" if energy else "cmo.haline")


def test_mesh_figure_shows_areas_and_qualities(figures: dict[str, Figure], fields: Arrays) -> None:
    figure = figures["mesh"]
    (areas,) = drawn(figure)
    np.testing.assert_allclose(np.unique(areas), np.unique(fields["areaCell"] / 1e6), rtol=1e-12)
    assert "area of cells (km²)" in [axes.get_xlabel() for axes in figure.axes]
    chords = np.sin(0.5 * fields["dcEdge"] / 6371220.0)
    distances = [chords[fields["edgesOnCell"][cell, :count] - 1] for cell, count in enumerate(fields["nEdgesOnCell"])]
    sigma = np.array([each.min() / each.max() for each in distances])
    histogram = next(axes for axes in figure.axes if axes.get_xlabel().startswith("σ"))
    assert sum(patch.get_height() for patch in histogram.patches) == 162
    assert histogram.get_title() == f"mean {sigma.mean():.4f}, smallest {sigma.min():.4f}"
    assert histogram.get_ylabel() == "number of cells"
    ratio = fields["areaCell"].max() / fields["areaCell"].min()
    assert "Mesh of 162 cells: μ = 1.164" in figure.get_suptitle()
    assert f"area ratio {ratio:.3f}" in figure.get_suptitle()


def test_conservation_shows_the_series(figures: dict[str, Figure], directory: Path) -> None:
    axes = figures["conservation"].axes[0]
    with netCDF4.Dataset(directory / "diagnostics.nc") as file:
        days = file["time"][1:] / 86400.0
        expected = {
            "potential enstrophy": "potential_enstrophy_change",
            "total energy, of the available energy": "total_energy_change",
            "total energy, of the total energy": "total_energy_change_of_total",
            "mass": "mass_change",
            "absolute vorticity, of the integral of |f|": "absolute_vorticity_change",
        }
        assert {line.get_label() for line in axes.get_lines()} == set(expected)
        for line in axes.get_lines():
            np.testing.assert_allclose(line.get_xdata(), days)
            change = np.abs(file[expected[line.get_label()]][1:])
            np.testing.assert_allclose(line.get_ydata(), np.where(change < 1e-20, 1e-20, change))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (days)", "|relative change since the start|")
    assert axes.get_xlim() == (0.0, 1.0)


def test_compared_maps_have_one_scale_for_all() -> None:
    panels = [np.linspace(-1.0, 2.0, ROWS * COLUMNS), np.linspace(0.0, 5.0, ROWS * COLUMNS)]
    for colours, limits in (
        (Colours("deep", -1.0, 5.0, centred=False), (-1.0, 5.0)),
        (colours_for("speed", [panel + 1.0 for panel in panels]), (0.0, 6.0)),
        (deviation_colours(panels), (-5.0, 5.0)),
    ):
        figure = map_figure(panels, ["one", "other"], "Heading", "depth (m)", colours)
        images = [image for axes in figure.axes for image in axes.images]
        assert [image.get_clim() for image in images[:2]] == [limits, limits]
        for image, panel in zip(images, panels, strict=False):
            np.testing.assert_array_equal(np.asarray(image.get_array()).ravel(), panel)
        x, y = 2.0 * np.sqrt(2.0), np.sqrt(2.0)
        np.testing.assert_allclose([image.get_extent() for image in images[:2]], 2 * [[-x, x, -y, y]], atol=1e-12)
        assert bar_label(figure) == "depth (m)"
        assert [axes.get_title() for axes in figure.axes[:2]] == ["one", "other"]
        assert figure.get_suptitle() == "Heading"


def test_grid_of_the_maps_stands_every_30_degrees(figures: dict[str, Figure]) -> None:
    wide, round_ = figures["surface_height"].axes[:2]
    parallels = [line for line in wide.get_lines() if np.ptp(line.get_ydata()) < 1e-12]
    angles = np.arcsin([line.get_ydata()[0] / np.sqrt(2) for line in parallels])
    latitudes = np.degrees(np.arcsin((2 * angles + np.sin(2 * angles)) / np.pi))
    np.testing.assert_allclose(latitudes, [-60, -30, 0, 30, 60], atol=1e-9)
    assert len(wide.get_lines()) == len(round_.get_lines()) == 12 + 5
    written = {text.get_text(): text.get_position() for text in wide.texts}
    assert list(written)[:5] == ["60°S", "30°S", "0°", "30°N", "60°N"]
    for label, line in zip(["60°S", "30°S", "0°", "30°N", "60°N"], parallels, strict=True):
        assert written[label][1] == pytest.approx(line.get_ydata()[0], abs=1e-12)


def test_rims_of_maps_hide_nothing(figures: dict[str, Figure]) -> None:
    """The ellipse of the Mollweide map has half axes of 2 and 1 times the root of 2, the view from above radius 1."""
    half_axes = [(2.0 * np.sqrt(2.0), np.sqrt(2.0)), (1.0, 1.0)]
    for axes, (x, y) in zip(figures["surface_height"].axes[:2], half_axes, strict=True):
        (rim,) = axes.patches
        box = rim.get_path().get_extents(rim.get_patch_transform())
        np.testing.assert_allclose(box.extents, [-x, -y, x, y], atol=1e-12)
        assert rim.get_facecolor()[3] == 0.0
        assert rim.get_edgecolor() == (0.0, 0.0, 0.0, 1.0)
        assert axes.collections[0].get_clip_path() is not None

"""Labels of the Mollweide map are legible: beside the map or with a halo on it."""

import numpy as np
from matplotlib.figure import Figure

from postprocess.figures.compare_maps import map_figure
from postprocess.figures.maps import draw_mollweide_raster
from postprocess.figures.palettes import colours_for
from postprocess.figures.paper import COLUMNS, ROWS


def test_latitudes_stand_beside_the_rim_and_longitudes_have_a_halo() -> None:
    figure = Figure((4.8, 2.6), dpi=100, layout="constrained")
    axes = draw_mollweide_raster(figure.subplots(), np.zeros((ROWS, COLUMNS)), {})
    figure.draw_without_rendering()
    latitudes = [text for text in axes.texts if not text.get_text().endswith("E")]
    assert len(latitudes) == 5
    for text in latitudes:
        (_, bottom), (right, top) = axes.transData.inverted().transform(text.get_window_extent())
        for y in (bottom, top):
            assert right < -2.0 * np.sqrt(max(0.0, 2.0 - y**2)), text.get_text()
    assert all(text.get_path_effects() for text in axes.texts if text.get_text().endswith("E"))


def test_compared_maps_are_as_wide_as_a_page() -> None:
    panels = [np.zeros(ROWS * COLUMNS) + 1.0] * 3
    widths = [
        map_figure(
            panels[:count], ["name"] * count, "Heading", "label", colours_for("thickness", panels)
        ).get_figwidth()
        for count in (1, 2, 3)
    ]
    assert widths == [6.6, 9.6, 9.6]

"""Figures as data: all that a reader sees of one, with numbers to compare to some digits."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.figure import FigureBase
from matplotlib.legend import Legend
from matplotlib.lines import Line2D


def described(figure: FigureBase) -> dict[str, Any]:
    """Titles, labels, scales, limits, lines, collections, images, texts and legends of a figure."""
    figure_size = getattr(figure, "get_size_inches", lambda: np.zeros(2))()
    return {
        "title": figure.get_suptitle(),
        "inches": figure_size.tolist(),
        "legends": [_of_legend(legend) for legend in figure.legends],
        "axes": [_of_axes(axes) for axes in figure.axes],
    }


def _of_axes(axes: Axes) -> dict[str, Any]:
    legend = axes.get_legend()
    return {
        "title": axes.get_title(),
        "labels": [axes.get_xlabel(), axes.get_ylabel()],
        "scales": [axes.get_xscale(), axes.get_yscale()],
        "limits": [*axes.get_xlim(), *_y_limits(axes)],
        "shown": axes.axison,
        "aspect": str(axes.get_aspect()),
        "lines": [_of_line(line) for line in axes.get_lines()],
        "collections": [_of_collection(each) for each in axes.collections],
        "images": [[*_summary(image.get_array()), image.get_cmap().name, *image.get_clim()] for image in axes.images],
        "texts": [[text.get_text(), *text.get_position(), text.get_ha(), text.get_va()] for text in axes.texts],
        "rims": [[*patch.get_facecolor(), *patch.get_edgecolor()] for patch in axes.patches[:1]],
        "bars": _summary([patch.get_height() for patch in axes.patches if hasattr(patch, "get_height")]),
        "legend": None if legend is None else _of_legend(legend),
        "sizes": [axes.title.get_size(), axes.xaxis.label.get_size(), *_tick_sizes(axes)],
        "grid": [line.get_alpha() for line in axes.get_xgridlines()[:1] if line.get_visible()],
        "ticks": [label.get_text() for label in axes.get_xticklabels()] if axes.get_xscale() == "linear" else [],
    }


def _y_limits(axes: Axes) -> tuple[float, float]:
    """Those of `axes`, without the margin where it follows round-off, which another processor leaves elsewhere."""
    lowest, highest = axes.get_ylim()
    follows_round_off = axes.get_yscale() == "log" and axes.get_autoscaley_on() and lowest < SMALLEST
    return (lowest, float(axes.dataLim.ymax)) if follows_round_off else (lowest, highest)


def _tick_sizes(axes: Axes) -> list[float]:
    return [labels[0].get_size() for labels in (axes.get_xticklabels(), axes.get_yticklabels()) if labels]


def _of_legend(legend: Legend) -> list[str]:
    return [text.get_text() for text in legend.get_texts()]


def _of_line(line: Line2D) -> list[Any]:
    style = [
        line.get_label(),
        str(line.get_color()),
        line.get_linestyle(),
        str(line.get_marker()),
        line.get_linewidth(),
    ]
    return style + _summary(line.get_xdata()) + _summary(line.get_ydata())


def _of_collection(collection: Collection) -> list[Any]:
    values = collection.get_array()
    corners = [path.vertices for path in collection.get_paths()]
    return [
        len(corners),
        *_summary(np.concatenate(corners) if corners else []),
        *_summary([] if values is None else values),
        collection.get_cmap().name,
        *([] if values is None else collection.get_clim()),
        *_summary(collection.get_offsets()),
        *_summary(collection.get_sizes() if hasattr(collection, "get_sizes") else []),
        str(collection.get_label()),
    ]


def _summary(values: Any) -> list[float]:
    """Number, mean, extremes, first, last and a weighted mean of numbers, which tells their order."""
    numbers = np.ma.filled(np.ma.asarray(values, dtype=float), np.nan).ravel()
    numbers = numbers[np.isfinite(numbers)]
    if len(numbers) == 0:
        return [0.0]
    weights = np.linspace(0.0, 1.0, len(numbers))
    return [
        float(value)
        for value in (
            *(len(numbers), numbers.mean(), numbers.min(), numbers.max(), numbers[0], numbers[-1]),
            np.dot(weights, numbers) / len(numbers),
        )
    ]


def differences(found: Any, stored: Any, where: str = "") -> list[str]:
    """Where two descriptions differ; numbers by more than `TOLERANCE` of the larger, or of one."""
    if isinstance(found, dict) and isinstance(stored, dict):
        keys = list(dict.fromkeys([*found, *stored]))
        return [
            line for key in keys for line in differences(found.get(key), stored.get(key), f"{where}.{key}".lstrip("."))
        ]
    if _is_list(found) and _is_list(stored) and len(found) == len(stored):
        return [
            line
            for number, (one, other) in enumerate(zip(found, stored, strict=True))
            for line in differences(one, other, f"{where}[{number}]")
        ]
    if _is_number(found) and _is_number(stored):
        size = max(abs(found), abs(stored))
        close = size < SMALLEST or abs(found - stored) <= TOLERANCE * size
        return [] if close else [f"{where}: {found!r} instead of {stored!r}"]
    return [] if found == stored else [f"{where}: {found!r} instead of {stored!r}"]


TOLERANCE = 1e-5
SMALLEST = 2e-8
"""Numbers below this are round-off or what convergence leaves; that they are small is all that is compared."""


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

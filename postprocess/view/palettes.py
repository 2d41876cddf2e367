"""Colour tables of a page: those of the figures, and some of matplotlib's."""

import base64

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap

from postprocess.figures.palettes import palette

COLOURS = 256

OF_CMOCEAN = ("thermal", "haline", "speed", "deep", "balance", "curl")
OF_MATPLOTLIB = ("viridis", "cividis", "magma", "RdBu_r", "PuOr_r")
DIVERGING = frozenset({"balance", "curl", "RdBu_r", "PuOr_r"})
"""With a pale middle, for fields of both signs; the first of a list is the usual one of its kind."""


def packed_palettes() -> list[dict[str, object]]:
    """Name, kind and colours of each palette, three bytes a colour from the lowest to the highest value."""
    maps: dict[str, Colormap] = {name: palette(name) for name in OF_CMOCEAN}
    maps |= {name: colormaps[name] for name in OF_MATPLOTLIB}
    return [
        {"name": name, "diverging": name in DIVERGING, "colours": _packed(colours)} for name, colours in maps.items()
    ]


def _packed(colours: Colormap) -> str:
    table = colours(np.linspace(0.0, 1.0, COLOURS), bytes=True)[:, :3]
    return base64.b64encode(np.ascontiguousarray(table, dtype=np.uint8).tobytes()).decode()

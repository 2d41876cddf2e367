"""Colour tables of a page: those of cmocean where it is installed, and some of matplotlib's."""

import base64

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap

COLOURS = 256

OF_CMOCEAN = ("thermal", "haline", "speed", "deep", "balance", "curl")
OF_MATPLOTLIB = ("viridis", "cividis", "magma", "RdBu_r", "PuOr_r")
DIVERGING = frozenset({"balance", "curl", "RdBu_r", "PuOr_r"})
"""With a pale middle, for fields of both signs; the first of a list is the usual one of its kind."""


def packed_palettes() -> list[dict[str, object]]:
    """Name, kind and colours of each palette, three bytes a colour from the lowest to the highest value."""
    return [
        {"name": name, "diverging": name in DIVERGING, "colours": _packed(palette)}
        for name, palette in _palettes().items()
    ]


def _palettes() -> dict[str, Colormap]:
    palettes = {name: colormaps[name] for name in OF_MATPLOTLIB}
    try:
        import cmocean
    except ImportError:
        return palettes
    return {**{name: getattr(cmocean.cm, name) for name in OF_CMOCEAN}, **palettes}


def _packed(palette: Colormap) -> str:
    colours = palette(np.linspace(0.0, 1.0, COLOURS), bytes=True)[:, :3]
    return base64.b64encode(np.ascontiguousarray(colours, dtype=np.uint8).tobytes()).decode()

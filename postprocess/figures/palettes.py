"""Which colours a field gets on maps, and over which values: the one place that plots, pages and films ask.

Palettes are those of cmocean, which are perceptually even. Their numbers are read from the files of the package: its
import would load pyplot and register some hundred colour maps.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import CenteredNorm, ListedColormap, Normalize

from mesh.arrays import Array
from swe.errors import InputError


@dataclass(frozen=True)
class FieldColours:
    """Palettes of a field: `one_sign` where all its values have one, else `both_signs`, with zero in the middle.

    With `from_zero`, for magnitudes, values of one sign are coloured from zero on.
    """

    one_sign: str = "haline"
    both_signs: str = "balance"
    from_zero: bool = False


FIELD_COLOURS = {
    "thickness": FieldColours("deep"),
    "topography": FieldColours("turbid"),
    "kinetic_energy": FieldColours("speed", from_zero=True),
    "speed": FieldColours("speed", from_zero=True),
    "velocity_error": FieldColours("amp", from_zero=True),
    "relative_vorticity": FieldColours("tempo", "curl"),
    "potential_vorticity": FieldColours("tempo", "curl"),
}
"""Fields, by the names that they have in `history.nc`, whose colours are not those of all others."""


@dataclass(frozen=True)
class Colours:
    """The palette of a map, by its name, and the values at its two ends."""

    palette: str
    lowest: float
    highest: float
    centred: bool

    @property
    def options(self) -> dict[str, Any]:
        """The same as options of matplotlib: `cmap` and `norm`."""
        norm = CenteredNorm(halfrange=self.highest) if self.centred else Normalize(self.lowest, self.highest)
        return {"cmap": palette(self.palette), "norm": norm}


def colours_for(name: str, values: Array | Iterable[Array], half_range: float | None = None) -> Colours:
    """Colours of the field called `name`, over the finite ones of its `values`, of one map or of several.

    Names without an entry in `FIELD_COLOURS`, also "", have the colours of all others. With a `half_range`, or values
    of both signs, zero is in the middle.
    """
    chosen = FIELD_COLOURS.get(name, FieldColours())
    lowest, highest = _extremes([values] if isinstance(values, np.ndarray) else values)
    if half_range is not None or lowest < 0.0 < highest:
        reach = (max(-lowest, highest) if half_range is None else half_range) or 1.0
        return Colours(chosen.both_signs, -reach, reach, centred=True)
    if chosen.from_zero:
        lowest, highest = min(lowest, 0.0), max(highest, 0.0)
    return Colours(chosen.one_sign, lowest, highest, centred=False)


def deviation_colours(values: Array | Iterable[Array], half_range: float | None = None) -> Colours:
    """Colours of deviations and errors of any field: zero is in the middle, whichever signs there are."""
    lowest, highest = _extremes([values] if isinstance(values, np.ndarray) else values)
    return colours_for("", np.zeros(0), max(-lowest, highest) if half_range is None else half_range)


def _extremes(panels: Iterable[Array]) -> tuple[float, float]:
    """The least and the largest finite value; 0 and 1 where there is none."""
    finite = [values[np.isfinite(values)] for values in panels]
    finite = [values for values in finite if values.size]
    if not finite:
        return 0.0, 1.0
    return float(min(values.min() for values in finite)), float(max(values.max() for values in finite))


@cache
def palette(name: str) -> ListedColormap:
    """The palette of this name, called cmo.NAME as cmocean itself registers it; see `palette_colours`."""
    return ListedColormap(palette_colours(name), name=f"cmo.{name}")


def palette_colours(name: str) -> Array:
    """Red, green and blue (n, 3), from 0 to 1, of a palette of cmocean.

    Raises `InputError` where cmocean is missing, or has no palette of this name.
    """
    found = find_spec("cmocean")
    if found is None or not found.submodule_search_locations:
        raise InputError(
            "palettes come from the package cmocean, which is missing; install it with pip install cmocean"
        )
    folder = Path(found.submodule_search_locations[0]) / "rgb"
    path = folder / f"{name}-rgb.txt"
    if not path.is_file():
        known = ", ".join(sorted(each.name.removesuffix("-rgb.txt") for each in folder.glob("*-rgb.txt")))
        raise InputError(f"cmocean has no palette named '{name}'; choose one of {known}")
    return np.loadtxt(path)

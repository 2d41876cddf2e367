"""Maps of a window of any size round any place: seen from above it, or with longitude and latitude as axes."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, MultipleLocator

from mesh.arrays import Array
from mesh.geometry.angles import about_zero
from mesh.geometry.sphere import from_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.maps import add_land, add_polygons, latitude_label
from postprocess.figures.patches import patches_for
from postprocess.figures.projections import (
    CYLINDRICAL,
    Polygons,
    globe_polygons,
    orthographic,
    orthographic_polygons,
)

STEPS = (60.0, 30.0, 15.0, *(digit * 10.0**power for power in range(0, -7, -1) for digit in (10.0, 5.0, 2.0)))
"""Degrees between meridians, or parallels, of which the largest is taken that gives a window `LEAST_LINES`."""

LEAST_LINES = 4.0
WIDEST_STEP = 30.0
"""Degrees between meridians round a pole."""

NARROWEST_PARALLEL = 0.5
"""Cylindrical maps are stretched no more than where parallels are as short as this, relative to the equator."""


@dataclass(frozen=True)
class Window:
    """A window of a map round `longitude` and `latitude`, `width` across and `height` from south to north, degrees."""

    longitude: float
    latitude: float
    width: float
    height: float

    @property
    def centre(self) -> tuple[float, float]:
        """Longitude and latitude of the middle, rad."""
        return float(np.radians(self.longitude)), float(np.radians(self.latitude))


def draw_orthographic_window(axes: Axes, mesh: VoronoiMesh, values: Array, options: dict, window: Window) -> Axes:
    """Draw values at cells, edges or vertices as seen from above the middle of `window`, at most 180 degrees wide.

    `options` are those of colours, see `matplotlib.collections.Collection`.
    """
    half_width, half_height = (np.sin(np.radians(0.5 * size)) for size in (window.width, window.height))
    distance = float(np.arcsin(min(1.0, np.hypot(half_width, half_height))))
    patches = patches_for(mesh, values)
    near = np.flatnonzero(patches.near(*window.centre, distance))
    polygons = orthographic_polygons(patches.taken(near), *window.centre)
    add_polygons(axes, Polygons(polygons.outlines, near[polygons.shown]), values, options)
    axes.add_patch(Circle((0.0, 0.0), 1.0, facecolor="none", edgecolor="black", linewidth=0.8))
    add_land(axes, mesh, Circle((0.0, 0.0), 1.0))
    _draw_graticule(axes, window, distance)
    axes.set(xlim=(-half_width, half_width), ylim=(-half_height, half_height), aspect="equal", xticks=[], yticks=[])
    return axes


def draw_cylindrical(axes: Axes, mesh: VoronoiMesh, values: Array, options: dict, window: Window) -> Axes:
    """Draw values at cells, edges or vertices with degrees of longitude and latitude as axes, cut off at the poles.

    Longitudes on the axis are those within 180 degrees of the middle of `window`. `options` are those of colours, see
    `matplotlib.collections.Collection`.
    """
    patches = patches_for(mesh, values)
    distance = np.radians(0.5 * np.hypot(window.width, window.height))
    near = np.flatnonzero(patches.near(*window.centre, distance))
    polygons = globe_polygons(CYLINDRICAL, patches.taken(near), window.centre[0])
    shift = np.array([window.longitude, 0.0])
    outlines = [outline + shift for outline in polygons.outlines]
    add_polygons(axes, Polygons(outlines, near[polygons.shown]), values, options)
    add_land(axes, mesh, Rectangle((window.longitude - 180.0, -90.0), 360.0, 180.0))
    axes.set(
        xlim=(window.longitude - 0.5 * window.width, window.longitude + 0.5 * window.width),
        ylim=(max(-90.0, window.latitude - 0.5 * window.height), min(90.0, window.latitude + 0.5 * window.height)),
        aspect=1.0 / max(np.cos(window.centre[1]), NARROWEST_PARALLEL),
    )
    # Names of meridians stand beside each other, so that a narrow window has room for few.
    across, up = _step(max(window.width, window.height)), _step(window.height)
    for axis, step, label in ((axes.xaxis, across, longitude_label), (axes.yaxis, up, latitude_label)):
        axis.set_major_locator(MultipleLocator(step))
        axis.set_major_formatter(FuncFormatter(lambda value, _, label=label: label(round(value, 6))))
    axes.grid(color="black", linewidth=0.3, alpha=0.4)
    return axes


def longitude_label(degrees: float) -> str:
    """A longitude, degrees, in print: to the east or to the west of Greenwich."""
    east = round(float(np.degrees(about_zero(np.array(np.radians(degrees))))), 9)
    return f"{abs(east):g}°" if east in (0.0, -180.0) else f"{abs(east):g}°{'E' if east > 0.0 else 'W'}"


def _step(size: float) -> float:
    """Degrees between lines in a window of this size."""
    return next((step for step in STEPS if LEAST_LINES * step <= size), STEPS[-1])


def _draw_graticule(axes: Axes, window: Window, distance: float) -> None:
    """Draw meridians and parallels within `distance`, rad, of the middle of a view from above, and name them."""
    longitude, latitude = window.centre
    south, north = max(-0.5 * np.pi, latitude - distance), min(0.5 * np.pi, latitude + distance)
    over_pole = abs(latitude) + distance >= 0.5 * np.pi
    reach = np.pi if over_pole else np.arcsin(np.sin(distance) / np.cos(latitude))
    along = np.linspace(-1.0, 1.0, 361)
    of_names = _latitude_of_names(latitude, distance)
    step = min(WIDEST_STEP, _step(2.0 * np.degrees(reach)))
    for degrees in _multiples(step, window.longitude, np.degrees(reach)):
        meridian = np.radians(degrees)
        _draw_line(axes, window, np.full(361, meridian), 0.5 * (south + north + (north - south) * along))
        _name(axes, window, meridian, of_names, longitude_label(degrees))
    for degrees in _multiples(_step(window.height), window.latitude, np.degrees(distance)):
        if abs(degrees) < 90.0:
            parallel = np.radians(degrees)
            _draw_line(axes, window, longitude + reach * along, np.full(361, parallel))
            _name(axes, window, longitude, parallel, latitude_label(degrees))


def _latitude_of_names(latitude: float, distance: float) -> float:
    """Latitude, rad, at which meridians are named: south of the middle, or nearer to the equator than a pole."""
    aside = 0.4 * distance
    return latitude - aside if latitude > -0.5 * np.pi + distance else latitude + aside


def _multiples(step: float, middle: float, reach: float) -> list[float]:
    """Multiples of `step` in the half-open range of `reach` round `middle`, each rounded to what it is in print."""
    first, last = np.ceil((middle - reach) / step - 1e-9), np.ceil((middle + reach) / step - 1e-9)
    return [round(float(number * step), 6) for number in np.arange(first, last)]


def _draw_line(axes: Axes, window: Window, longitude: Array, latitude: Array) -> None:
    line = orthographic(from_lonlat(longitude, latitude), *window.centre)
    axes.plot(*np.where(line[:, 2:] > 0.0, line[:, :2], np.nan).T, color="black", linewidth=0.3, alpha=0.4)


def _name(axes: Axes, window: Window, longitude: float, latitude: float, text: str) -> None:
    """Write the name of a line at a place, unless that is beyond the limb or the window."""
    x, y, towards = orthographic(from_lonlat(np.array(longitude), np.array(latitude)), *window.centre)
    if towards > 0.0:
        readable = [withStroke(linewidth=1.5, foreground="white", alpha=0.7)]
        axes.text(x, y, text, fontsize=6, clip_on=True, path_effects=readable)

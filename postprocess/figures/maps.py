"""Maps of values at cells, edges or vertices: the globe on an equal-area map, views of a hemisphere, and windows.

All functions draw on Axes that are given to them, and return these. What was drawn last is there as
`axes.collections[-1]`, or `axes.images[-1]` for pixels, for a colour bar.
"""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle, Ellipse, Patch
from matplotlib.patheffects import withStroke

from mesh.arrays import Array
from mesh.discrete.walls import has_walls
from mesh.geometry.angles import whole_degrees_east
from mesh.geometry.sphere import from_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.patches import patches_for
from postprocess.figures.projections import (
    MOLLWEIDE,
    Polygons,
    globe_polygons,
    mollweide,
    orthographic,
    orthographic_polygons,
)

CENTRAL_LONGITUDE = np.radians(270.0)
"""Longitude at the middle of maps, unless another is asked for: that of the mountain of test case 5."""

LAND = "0.8"
"""Colour of land, the grey that no usual colour map has."""

HALO = (withStroke(linewidth=2.0, foreground="white", alpha=0.85),)
"""Round labels that stand on a map, whose colours may be dark."""

VIEW_LATITUDE = np.radians(40.0)
"""Latitude under the viewer of orthographic maps, unless another is asked for."""


def draw_mollweide(
    axes: Axes, mesh: VoronoiMesh, values: Array, options: dict, longitude: float = CENTRAL_LONGITUDE
) -> Axes:
    """Draw values at cells, edges or vertices on the Mollweide map with meridians and parallels every 30 degrees.

    `options` are those of colours, see `matplotlib.collections.Collection`; `longitude`, rad, is in the middle.
    """
    polygons = globe_polygons(MOLLWEIDE, patches_for(mesh, values), longitude)
    add_polygons(axes, polygons, values, options)
    _clip_to(axes, _mollweide_rim(), axes.collections[-1])
    add_land(axes, mesh, _mollweide_rim())
    _draw_mollweide_graticule(axes, longitude)
    return axes


def draw_mollweide_raster(axes: Axes, values: Array, options: dict) -> Axes:
    """Draw values (rows, columns) at the pixels of `projections.mollweide_raster` on the map round 270 degrees east."""
    x, y = 2.0 * np.sqrt(2.0), np.sqrt(2.0)
    drawn = axes.imshow(values, extent=(-x, x, -y, y), origin="lower", **options)
    _clip_to(axes, _mollweide_rim(), drawn)
    _draw_mollweide_graticule(axes, CENTRAL_LONGITUDE)
    return axes


def _mollweide_rim() -> Ellipse:
    return Ellipse((0.0, 0.0), 4.0 * np.sqrt(2.0), 2.0 * np.sqrt(2.0))


def _draw_mollweide_graticule(axes: Axes, central_longitude: float) -> None:
    for longitude, latitude in _graticule():
        line = mollweide(longitude, latitude)
        axes.plot(*line.T, color="black", linewidth=0.3, alpha=0.4)
    for degrees in (-60, -30, 0, 30, 60):
        x, y = mollweide(np.array(-np.pi), np.array(np.radians(degrees)))
        away = 0.05 + 0.03 * (degrees / 30.0) ** 2  # the rim leans over labels that are far from the equator
        axes.text(x - away, y, latitude_label(degrees), ha="right", va="center", fontsize=7)
    for degrees in (-120, -60, 0, 60, 120):
        x, _ = mollweide(np.array(np.radians(degrees)), np.array(0.0))
        east = whole_degrees_east(float(np.radians(degrees)) + central_longitude)
        axes.text(x, 0.03, f"{east}°E", ha="center", va="bottom", fontsize=6, path_effects=HALO)
    axes.set_xlim(-3.2, 2.9)
    axes.set_ylim(-1.48, 1.48)


def draw_orthographic(
    axes: Axes,
    mesh: VoronoiMesh,
    values: Array,
    options: dict,
    longitude: float = CENTRAL_LONGITUDE,
    latitude: float = VIEW_LATITUDE,
) -> Axes:
    """Draw values at cells, edges or vertices on the hemisphere round `longitude`, `latitude` (rad).

    `options` are those of colours, see `matplotlib.collections.Collection`.
    """
    polygons = orthographic_polygons(patches_for(mesh, values), longitude, latitude)
    add_polygons(axes, polygons, values, options)
    _clip_to(axes, Circle((0.0, 0.0), 1.0), axes.collections[-1])
    add_land(axes, mesh, Circle((0.0, 0.0), 1.0))
    for from_centre, of_line in _graticule():
        line = orthographic(from_lonlat(from_centre + longitude, of_line), longitude, latitude)
        line = np.where(line[:, 2:] > 0.0, line[:, :2], np.nan)
        axes.plot(*line.T, color="black", linewidth=0.3, alpha=0.4)
    below = f"seen from above {whole_degrees_east(longitude)}°E {latitude_label(round(np.degrees(latitude)))}"
    axes.text(0.0, -1.08, below, ha="center", va="top", fontsize=7)
    axes.set_xlim(-1.05, 1.05)
    axes.set_ylim(-1.15, 1.05)
    return axes


def add_polygons(axes: Axes, polygons: Polygons, values: Array, options: dict) -> None:
    """Add polygons to `axes`, each in the colour of the value (n_patches,) that it shows."""
    # Sides of the polygons' own colour close the hairlines that anti-aliasing leaves between neighbours.
    collection = PolyCollection(
        polygons.outlines, array=values[polygons.shown], **{"edgecolors": "face", "linewidths": 0.3, **options}
    )
    axes.add_collection(collection, autolim=False)


def add_land(axes: Axes, mesh: VoronoiMesh, globe: Patch) -> None:
    """Fill the `globe`, behind all else, with what shows where a mesh with walls has no cells."""
    if has_walls(mesh):
        globe.set(facecolor=LAND, edgecolor="none", zorder=0.0)
        axes.add_patch(globe)


def _clip_to(axes: Axes, rim: Patch, drawn: Artist) -> None:
    """Draw the rim of a map and cut off what passes it."""
    rim.set(facecolor="none", edgecolor="black", linewidth=0.8)
    axes.add_patch(rim)
    drawn.set_clip_path(rim)
    axes.set_aspect("equal")
    axes.axis("off")


def _graticule() -> list[tuple[Array, Array]]:
    """Meridians, from the central one, and parallels every 30 degrees as (longitude, latitude)."""
    along = np.linspace(-1.0, 1.0, 181)
    lines = [(np.full(181, np.radians(lon)), 0.5 * np.pi * along) for lon in range(-150, 181, 30)]
    return lines + [(np.pi * along, np.full(181, np.radians(lat))) for lat in range(-60, 61, 30)]


def latitude_label(degrees: float) -> str:
    """A latitude, degrees, in print."""
    return "0°" if degrees == 0 else f"{abs(degrees):g}°{'N' if degrees > 0 else 'S'}"

"""Figures of a run: fields on maps, the mesh and its quality, and what was conserved."""

from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import CenteredNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Circle, Ellipse, Patch

from mesh.arrays import Array
from mesh.discrete.operators import vertex_to_cell
from mesh.discrete.quality import mesh_quality, neighbour_distance_ratio, triangle_quality
from mesh.geometry.angles import whole_degrees_east
from mesh.geometry.sphere import from_lonlat
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.projections import (
    Polygons,
    mollweide,
    mollweide_polygons,
    orthographic,
    orthographic_polygons,
)
from postprocess.runs.folders import prepared_folder
from postprocess.runs.reading import Run

CENTRAL_LONGITUDE = np.radians(270.0)
"""Longitude at the middle of maps: that of the mountain of test case 5."""

VIEW_LATITUDE = np.radians(40.0)
SQUARE_METRES_PER_SQUARE_KILOMETRE = 1e6
DOTS_PER_INCH = 150
ROUND_OFF_FLOOR = 1e-20
"""Changes smaller than this are drawn here, for want of a logarithm of zero."""


def plot_run(run: Run, folder: AnyPath) -> list[Path]:
    """Write all figures of `run` to `folder`; return their paths."""
    folder = prepared_folder(folder)
    last = run.last_snapshot()
    heading = f"{run.case}, {run.mesh.n_cells} cells, day {last.day:g}"
    figures = {
        "potential_vorticity": field_figure(
            run.mesh,
            1e8 * vertex_to_cell(run.mesh, last.fields["potential_vorticity"]),
            f"Potential vorticity: {heading}",
            "potential vorticity (10⁻⁸ m⁻¹ s⁻¹)",
            symmetric=True,
        ),
        "kinetic_energy": field_figure(
            run.mesh, last.fields["kinetic_energy"], f"Kinetic energy: {heading}", "kinetic energy (m² s⁻²)"
        ),
        "surface_height": field_figure(
            run.mesh, last.fields["surface_height"], f"Surface height: {heading}", "height of the surface (m)"
        ),
        "mesh": mesh_figure(run.mesh),
        "conservation": conservation_figure(run.series, f"{run.case}, {run.mesh.n_cells} cells"),
    }
    paths = []
    for name, figure in figures.items():
        paths.append(folder / f"{name}.png")
        figure.savefig(paths[-1], dpi=DOTS_PER_INCH)
    return paths


def field_figure(mesh: VoronoiMesh, values: Array, title: str, label: str, symmetric: bool = False) -> Figure:
    """Cell values on the equal-area global view and on an orthographic one, with one colour bar.

    A `symmetric` field is coloured from blue to red with white at zero.
    """
    figure = Figure(figsize=(12.0, 4.8), layout="constrained")
    wide, round_ = figure.subplots(1, 2, width_ratios=[2.0, 1.0])
    norm = CenteredNorm(halfrange=float(np.abs(values).max())) if symmetric else Normalize(values.min(), values.max())
    options = {"cmap": "RdBu_r" if symmetric else "viridis", "norm": norm}
    draw_mollweide(wide, mesh, values, options)
    drawn = draw_orthographic(round_, mesh, values, options)
    figure.colorbar(drawn, ax=[wide, round_], location="bottom", shrink=0.6, aspect=40, label=label)
    figure.suptitle(title)
    return figure


def draw_mollweide(axes: Axes, mesh: VoronoiMesh, values: Array, options: dict) -> PolyCollection:
    """Draw values (n_cells,) on the Mollweide map, with meridians and parallels every 30 degrees."""
    drawn = _draw(axes, mollweide_polygons(mesh, CENTRAL_LONGITUDE), values, _mollweide_rim(), options)
    _draw_mollweide_graticule(axes)
    return drawn


def draw_mollweide_raster(axes: Axes, values: Array, options: dict) -> AxesImage:
    """Draw values (rows, columns) at the pixels of `projections.mollweide_raster` on the same map."""
    x, y = 2.0 * np.sqrt(2.0), np.sqrt(2.0)
    drawn = axes.imshow(values, extent=(-x, x, -y, y), origin="lower", **options)
    _clip_to(axes, _mollweide_rim(), drawn)
    _draw_mollweide_graticule(axes)
    return drawn


def _mollweide_rim() -> Ellipse:
    return Ellipse((0.0, 0.0), 4.0 * np.sqrt(2.0), 2.0 * np.sqrt(2.0))


def _draw_mollweide_graticule(axes: Axes) -> None:
    for longitude, latitude in _graticule():
        line = mollweide(longitude, latitude)
        axes.plot(*line.T, color="black", linewidth=0.3, alpha=0.4)
    for degrees in (-60, -30, 0, 30, 60):
        x, y = mollweide(np.array(-np.pi), np.array(np.radians(degrees)))
        axes.text(x - 0.05, y, _latitude_label(degrees), ha="right", va="center", fontsize=7)
    for degrees in (-120, -60, 0, 60, 120):
        x, _ = mollweide(np.array(np.radians(degrees)), np.array(0.0))
        east = whole_degrees_east(float(np.radians(degrees)) + CENTRAL_LONGITUDE)
        axes.text(x, 0.03, f"{east}°E", ha="center", va="bottom", fontsize=6, alpha=0.7)
    axes.set_xlim(-3.2, 2.9)
    axes.set_ylim(-1.48, 1.48)


def draw_orthographic(axes: Axes, mesh: VoronoiMesh, values: Array, options: dict) -> PolyCollection:
    """Draw values (n_cells,) on the hemisphere round `CENTRAL_LONGITUDE`, `VIEW_LATITUDE`."""
    rim = Circle((0.0, 0.0), 1.0)
    polygons = orthographic_polygons(mesh, CENTRAL_LONGITUDE, VIEW_LATITUDE)
    drawn = _draw(axes, polygons, values, rim, options)
    for longitude, latitude in _graticule():
        line = orthographic(from_lonlat(longitude + CENTRAL_LONGITUDE, latitude), CENTRAL_LONGITUDE, VIEW_LATITUDE)
        line = np.where(line[:, 2:] > 0.0, line[:, :2], np.nan)
        axes.plot(*line.T, color="black", linewidth=0.3, alpha=0.4)
    latitude, longitude = (round(np.degrees(angle)) for angle in (VIEW_LATITUDE, CENTRAL_LONGITUDE))
    axes.text(0.0, -1.08, f"seen from above {longitude}°E {latitude}°N", ha="center", va="top", fontsize=7)
    axes.set_xlim(-1.05, 1.05)
    axes.set_ylim(-1.15, 1.05)
    return drawn


def _draw(axes: Axes, polygons: Polygons, values: Array, rim: Patch, options: dict) -> PolyCollection:
    # Sides of the polygons' own colour close the hairlines that anti-aliasing leaves between neighbours.
    collection = PolyCollection(
        polygons.outlines, array=values[polygons.cells], edgecolors="face", linewidths=0.3, **options
    )
    axes.add_collection(collection, autolim=False)
    _clip_to(axes, rim, collection)
    return collection


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


def _latitude_label(degrees: int) -> str:
    return "0°" if degrees == 0 else f"{abs(degrees)}°{'N' if degrees > 0 else 'S'}"


def mesh_figure(mesh: VoronoiMesh) -> Figure:
    """The mesh coloured by cell area, and the distributions of sigma over cells and of q over triangles."""
    quality = mesh_quality(mesh)
    figure = Figure(figsize=(12.0, 4.6), layout="constrained")
    left, right = np.asarray(figure.subfigures(1, 2, width_ratios=[1.6, 1.0]))
    map_axes = left.subplots()
    area = mesh.area_cell / SQUARE_METRES_PER_SQUARE_KILOMETRE
    drawn = draw_mollweide(map_axes, mesh, area, {"cmap": "viridis"})
    left.colorbar(drawn, ax=map_axes, location="bottom", shrink=0.8, label="area of cells (km²)")
    distributions = (
        (neighbour_distance_ratio(mesh), "σ, shortest over longest neighbour distance", "cells"),
        (triangle_quality(mesh), "q of Delaunay triangles, 1 if equilateral", "triangles"),
    )
    for axes, (values, label, count) in zip(right.subplots(2, 1), distributions, strict=True):
        axes.hist(values, bins=60, color="tab:blue")
        axes.set_yscale("log")
        axes.set_xlabel(label)
        axes.set_ylabel(f"number of {count}")
        axes.set_title(f"mean {values.mean():.4f}, smallest {values.min():.4f}", fontsize=9)
    figure.suptitle(f"Mesh of {mesh.n_cells} cells: μ = {quality.mu:.4f}, area ratio {quality.area_ratio:.3f}")
    return figure


def conservation_figure(series: dict[str, Array], title: str) -> Figure:
    """Magnitudes of all relative changes since the start against time, on a logarithmic axis."""
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    axes = figure.subplots()
    days = series["time"] / 86400.0
    for name, label, style in (
        ("potential_enstrophy_change", "potential enstrophy", "-"),
        ("total_energy_change", "total energy, of the available energy", "-"),
        ("total_energy_change_of_total", "total energy, of the total energy", "--"),
        ("mass_change", "mass", "-"),
        ("absolute_vorticity_change", "absolute vorticity, of the integral of |f|", ":"),
    ):
        axes.semilogy(days[1:], np.maximum(np.abs(series[name][1:]), ROUND_OFF_FLOOR), style, label=label)
    axes.set_xlabel("time (days)")
    axes.set_ylabel("|relative change since the start|")
    axes.set_title(f"Conservation: {title} (values below {ROUND_OFF_FLOOR:g} drawn there)")
    axes.grid(alpha=0.3)
    axes.set_xlim(0.0, days[-1])
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    return figure

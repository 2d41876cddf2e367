"""How meshes come on paper: the globe on maps, a plane as it is, with x and y as axes.

Figures ask `paper_of` a mesh, so that they need not know what it lies on.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.discrete.walls import has_walls, wall_edges
from mesh.geometry.angles import about_zero
from mesh.geometry.sphere import mean_spacing, normalize
from mesh.geometry.surface import surface_of
from mesh.shown import KILOMETRE
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.places import nearest_sites
from postprocess.figures.maps import (
    CENTRAL_LONGITUDE,
    LAND,
    add_polygons,
    draw_mollweide,
    draw_mollweide_raster,
    draw_orthographic,
)
from postprocess.figures.patches import cell_patches, patches_for
from postprocess.figures.projections import (
    Box,
    Polygons,
    mollweide,
    mollweide_raster,
    orthographic,
    orthographic_polygons,
    plane_polygons,
)

HEMISPHERE = 8.0
"""Width of the view of a hemisphere, inches."""

HEMISPHERES = ((CENTRAL_LONGITUDE, np.radians(25.0)), (CENTRAL_LONGITUDE - np.pi, np.radians(-25.0)))
"""Longitude and latitude under the viewer: two sides of the globe that together show all of it."""

ROWS, COLUMNS = 360, 720
"""Pixels of maps of the globe, and the most of a plane."""

ASPECT = 0.53
"""Height of a Mollweide map with its title, over its width."""

LONGEST, SHORTEST = 7.2, 1.8
"""Inches: how long the sides of a plane are drawn at most, and at least."""

WITH_AXES, TITLE = 0.84, 0.17
"""Of the width of a map by pixels of a plane: its own beside its axis, and the height of axis and title."""

MARGIN = 0.02
"""Beyond walls so much of the plane is shown, of its longer side."""

LEAST_KILOMETRES = 10.0 * KILOMETRE
"""Planes from this length on have axes in kilometres, smaller ones in metres."""

MOST_TICKS = 7

Draw = Callable[[Axes, Array, dict], Axes]
"""Draws values at cells, edges or vertices with options of colours, see `matplotlib.collections.Collection`."""


@dataclass(frozen=True, eq=False)
class Views:
    """Drawings side by side that share a figure.

    How each is drawn, their relative widths, width and height of the figure in inches, and how much of the width a
    colour bar below takes.
    """

    draw: tuple[Draw, ...]
    widths: tuple[float, ...]
    size: tuple[float, float]
    bar: float = 0.6


@dataclass(frozen=True, eq=False)
class Raster:
    """A map by pixels: where they are, for functions of the place (rows * columns,), from the south; how it is drawn.

    `aspect` is the height of a map with its title over its width. Where there are no cells, `covered` is not true.
    """

    shape: tuple[int, int]
    places: tuple[Array, Array]
    aspect: float
    covered: NDArray[np.bool_]
    draw: Draw


@dataclass(frozen=True, eq=False)
class Closeup:
    """Cells round one of them on flat paper, on which that is the origin: numbers, polygons and centres (n, 2).

    What `polygons` show are indices of `cells`.
    """

    cells: Index
    polygons: Polygons
    centers: Array


class Paper(Protocol):
    """How a mesh is drawn."""

    @property
    def views(self) -> Views:
        """The whole of it, and what else a figure of a field shows; room for a colour bar below."""

    @property
    def sides(self) -> Views:
        """Views that together show each cell large."""

    @property
    def width_of_cell(self) -> float:
        """That of a cell in these views, inches."""

    @property
    def raster(self) -> Raster:
        """The whole of it by pixels."""

    @property
    def aspect(self) -> float:
        """Height of a drawing of the whole over its width."""

    @property
    def unit(self) -> tuple[float, str]:
        """The unit of lengths, m, and its symbol."""

    def draw(self, axes: Axes, values: Array, options: dict) -> Axes:
        """Draw the whole of it."""

    def spots(self, cells: Index) -> tuple[Array, Array]:
        """Where the centres of cells are on the drawing of the whole."""

    def around(self, cell: int, reach: float) -> Closeup:
        """The cells within `reach`, in lengths of the surface, to either side of a cell."""

    def place_in_words(self, cell: int) -> str:
        """Where a cell is."""


def paper_of(mesh: VoronoiMesh) -> Paper:
    """How a mesh is drawn."""
    return GlobePaper(mesh) if mesh.on_a_sphere else PlanePaper(mesh)


@dataclass(frozen=True, eq=False)
class GlobePaper:
    """The globe on the Mollweide map, and as seen from above."""

    mesh: VoronoiMesh
    unit = (KILOMETRE, "km")
    aspect = ASPECT

    @property
    def views(self) -> Views:
        """The whole, and a hemisphere."""
        return Views((self.draw, partial(_from_above, self.mesh)), (2.0, 1.0), (12.0, 4.8))

    @property
    def sides(self) -> Views:
        """Both hemispheres."""
        both = tuple(partial(_from_above, self.mesh, view=view) for view in HEMISPHERES)
        return Views(both, (1.0, 1.0), (2.0 * HEMISPHERE, HEMISPHERE + 0.6))

    @property
    def width_of_cell(self) -> float:
        """In the middle of a hemisphere, if cells are alike."""
        return mean_spacing(self.mesh.n_cells) * 0.5 * HEMISPHERE

    @property
    def raster(self) -> Raster:
        """That of all globes."""
        return globe_raster()

    def draw(self, axes: Axes, values: Array, options: dict) -> Axes:
        """On the Mollweide map."""
        return draw_mollweide(axes, self.mesh, values, options)

    def spots(self, cells: Index) -> tuple[Array, Array]:
        """On the Mollweide map."""
        longitude = about_zero(self.mesh.lon_cell[cells] - CENTRAL_LONGITUDE)
        x, y = mollweide(longitude, self.mesh.lat_cell[cells]).T
        return x, y

    def around(self, cell: int, reach: float) -> Closeup:
        """As seen from above, `reach` and lengths on paper in radii."""
        mesh = self.mesh
        view = float(mesh.lon_cell[cell]), float(mesh.lat_cell[cell])
        flat = orthographic(normalize(mesh.cell_points), *view)
        cells = np.flatnonzero((np.abs(flat[:, :2]).max(axis=1) < reach) & (flat[:, 2] > 0.0))
        polygons = orthographic_polygons(cell_patches(mesh).taken(cells), *view)
        return Closeup(cells, polygons, flat[cells, :2])

    def place_in_words(self, cell: int) -> str:
        """Longitude and latitude, degrees, to a tenth."""
        longitude, latitude = np.degrees((self.mesh.lon_cell[cell], self.mesh.lat_cell[cell]))
        return f"{longitude:.1f}°E {abs(latitude):.1f}°{'N' if latitude >= 0.0 else 'S'}"


def _from_above(
    mesh: VoronoiMesh, axes: Axes, values: Array, options: dict, view: tuple[float, float] | None = None
) -> Axes:
    return draw_orthographic(axes, mesh, values, options, *(view or ()))


def globe_raster() -> Raster:
    """The Mollweide map round the usual longitude by pixels."""
    longitude, latitude = mollweide_raster(ROWS, COLUMNS)
    places = longitude + CENTRAL_LONGITUDE, latitude
    covered = np.ones(len(longitude), dtype=bool)
    return Raster((ROWS, COLUMNS), places, ASPECT, covered, draw_mollweide_raster)


@dataclass(frozen=True, eq=False)
class PlanePaper:
    """A plane as it is, metres to scale; from border to border where it repeats itself, so that there are no seams."""

    mesh: VoronoiMesh

    @cached_property
    def box(self) -> Box:
        """What is drawn of it: one period from the lowest multiple that holds cells, or all cells and a margin."""
        mesh = self.mesh
        sides = [
            _side(mesh.x_cell, mesh.x_vertex, mesh.x_period),
            _side(mesh.y_cell, mesh.y_vertex, mesh.y_period),
        ]
        margin = MARGIN * max(high - low for low, high in sides)
        (left, right), (bottom, top) = (
            (low, high) if period > 0.0 else (low - margin, high + margin)
            for (low, high), period in zip(sides, (mesh.x_period, mesh.y_period), strict=True)
        )
        return left, right, bottom, top

    @property
    def aspect(self) -> float:
        """Height over width."""
        left, right, bottom, top = self.box
        return (top - bottom) / (right - left)

    @property
    def unit(self) -> tuple[float, str]:
        """Kilometres, or metres where the plane is small."""
        left, right, bottom, top = self.box
        return (KILOMETRE, "km") if max(right - left, top - bottom) >= LEAST_KILOMETRES else (1.0, "m")

    @property
    def _sides(self) -> tuple[float, float]:
        """Width and height of its drawing, inches."""
        longer = LONGEST / max(1.0, self.aspect)
        return max(longer, SHORTEST), max(longer * self.aspect, SHORTEST)

    @property
    def views(self) -> Views:
        """The whole."""
        width, height = self._sides
        return Views((self.draw,), (1.0,), (width + 1.6, height + 1.9), bar=0.9)

    @property
    def sides(self) -> Views:
        """The whole, in the same size."""
        width, height = self._sides
        return Views((self.draw,), (1.0,), (width + 1.4, height + 1.2))

    @property
    def width_of_cell(self) -> float:
        """If cells are alike."""
        mesh = self.mesh
        left, right, *_ = self.box
        spacing = surface_of(mesh).mean_spacing(mesh.n_cells, float(mesh.area_cell.sum()))
        return spacing / (right - left) * self._sides[0]

    @property
    def raster(self) -> Raster:
        """Square pixels, those beyond walls not covered."""
        left, right, bottom, top = self.box
        pixel = max(right - left, top - bottom) / COLUMNS
        columns, rows = (max(1, round(side / pixel)) for side in (right - left, top - bottom))
        x = left + (right - left) * (np.arange(columns) + 0.5) / columns
        y = bottom + (top - bottom) * (np.arange(rows) + 0.5) / rows
        places = np.tile(x, rows), np.repeat(y, columns)
        return Raster(
            (rows, columns), places, WITH_AXES * self.aspect + TITLE, _covered(self.mesh, *places), self._draw_raster
        )

    def draw(self, axes: Axes, values: Array, options: dict, box: Box | None = None) -> Axes:
        """With axes along x and y; of all images what lies in `box`, left, right, bottom and top in metres."""
        box = box or self.box
        polygons = plane_polygons(patches_for(self.mesh, values), surface_of(self.mesh).periods, box)
        add_polygons(axes, polygons, values, options)
        return self._with_axes(axes, box)

    def spots(self, cells: Index) -> tuple[Array, Array]:
        """Those images of the centres that are drawn."""
        left, _, bottom, _ = self.box
        x, y = self.mesh.x_cell[cells], self.mesh.y_cell[cells]
        return _image(x, left, self.mesh.x_period), _image(y, bottom, self.mesh.y_period)

    def around(self, cell: int, reach: float) -> Closeup:
        """Images that belong together, `reach` in metres."""
        mesh, surface = self.mesh, surface_of(self.mesh)
        flat = surface.shortest(mesh.cell_points - mesh.cell_points[cell])[:, :2]
        cells = np.flatnonzero(np.abs(flat).max(axis=1) < reach)
        corners = cell_patches(mesh).corners[cells] - mesh.cell_points[cells][:, None]
        corners = surface.shortest(corners)[..., :2] + flat[cells][:, None]
        return Closeup(cells, Polygons(list(corners), np.arange(len(cells))), flat[cells])

    def place_in_words(self, cell: int) -> str:
        """Its coordinates."""
        unit, symbol = self.unit
        return f"x = {self.mesh.x_cell[cell] / unit:.4g} {symbol}, y = {self.mesh.y_cell[cell] / unit:.4g} {symbol}"

    def _draw_raster(self, axes: Axes, values: Array, options: dict) -> Axes:
        axes.imshow(values, extent=self.box, origin="lower", **options)
        return self._with_axes(axes, self.box)

    def _with_axes(self, axes: Axes, box: Box) -> Axes:
        """Name the axes of a drawing of `box`, in metres, and show what is not covered by cells as land."""
        unit, symbol = self.unit
        left, right, bottom, top = box
        axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
        axes.set(xlabel=f"x ({symbol})", ylabel=f"y ({symbol})")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(MOST_TICKS, steps=[1, 2, 2.5, 5, 10]))
            axis.set_major_formatter(
                FuncFormatter(lambda value, _: f"{value / unit:.10g}".replace("-", "\N{MINUS SIGN}"))
            )
        if has_walls(self.mesh):
            axes.set_facecolor(LAND)
        return axes


def _side(cells: Array, vertices: Array, period: float) -> tuple[float, float]:
    """First and last coordinate, m, of what is drawn along an axis, without a margin."""
    if period > 0.0:
        low = period * np.floor(cells.min() / period)
        return (low, low + period) if cells.max() <= low + period else (float(cells.min()), float(cells.min()) + period)
    return float(vertices.min()), float(vertices.max())


def _image(coordinates: Array, low: float, period: float) -> Array:
    """Coordinates, m, less whole periods, from `low` on."""
    return coordinates if period == 0.0 else low + (coordinates - low) % period


def _covered(mesh: VoronoiMesh, x: Array, y: Array) -> NDArray[np.bool_]:
    """Whether points (n,) are in cells: within the walls of the nearest one."""
    covered = np.ones(len(x), dtype=bool)
    if not has_walls(mesh):
        return covered
    surface, points = surface_of(mesh), np.column_stack([x, y, np.zeros(len(x))])
    nearest = nearest_sites(surface, mesh.cell_points, points)
    normal = np.stack([np.cos(mesh.angle_edge), np.sin(mesh.angle_edge)], axis=1)
    normal[mesh.cells_on_edge[:, 0] < 0] *= -1.0
    is_wall = np.zeros(mesh.n_edges, dtype=bool)
    is_wall[wall_edges(mesh)] = True
    for side in range(mesh.max_edges):
        edges = np.where(side < mesh.n_edges_on_cell[nearest], mesh.edges_on_cell[nearest, side], -1)
        from_edge = surface.shortest(points - mesh.edge_points[edges])[:, :2]
        covered &= ~((edges >= 0) & is_wall[edges] & (np.sum(from_edge * normal[edges], axis=1) > 0.0))
    return covered

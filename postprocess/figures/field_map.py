"""A map of any field of a run or a mesh, centred and zoomed anywhere: what `trisk.plot_field` draws."""

from functools import partial
from typing import Literal, get_args

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, Normalize
from matplotlib.ticker import ScalarFormatter

from mesh.arrays import Array
from mesh.geometry.angles import degrees_eastward
from mesh.safe_files import AnyPath
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.maps import draw_mollweide, draw_orthographic
from postprocess.figures.palettes import colours_for
from postprocess.figures.paper import Draw, PlanePaper
from postprocess.figures.shown_fields import ShownField, given_field, given_to_run, mesh_field, snapshot_field
from postprocess.figures.windows import Window, draw_cylindrical, draw_orthographic_window
from postprocess.runs.reading import Run, open_run
from swe.errors import InputError

Projection = Literal["mollweide", "orthographic", "cylindrical"]

LARGEST = {"mollweide": (360.0, 180.0), "orthographic": (180.0, 180.0), "cylindrical": (360.0, 180.0)}
"""Width and height, degrees, of what a map shows without an extent."""

Region = tuple[float, float, float, float]
"""West, east, south and north: degrees, or on a plane metres along x and y."""

MIDDLE = (0.0, 0.0)
"""Longitude and latitude of the middle of maps, degrees, unless another is asked for."""

Extent = float | tuple[float, float] | None


def plot_field(
    where: Run | VoronoiMesh | AnyPath,
    field: str | Array,
    ax: Axes | None = None,
    *,
    time: int = -1,
    centre: tuple[float, float] = MIDDLE,
    extent: Extent = None,
    region: Region | None = None,
    projection: Projection | None = None,
    cmap: str | Colormap | None = None,
    norm: Normalize | None = None,
    label: str | None = None,
    colour_bar: bool = True,
) -> Axes:
    """Draw a field of a run, or of a mesh, on a map; return the Axes that it is drawn on.

    `where` is a run, its directory or a mesh. `field` is the name of a snapshot's field or of an array of the mesh, or
    values (n,) for each cell, edge or vertex, of a run also (snapshots, n); those at vertices are drawn on triangles,
    those at edges on the quadrilaterals round them. `time` numbers the snapshots, from the end where it is negative.

    `centre` is the longitude and latitude, degrees, in the middle of the map, and `extent` the size of the window round
    it, degrees: one number, or width and height. `projection` is "mollweide", the globe on an equal-area map;
    "orthographic", as seen from above `centre`; or "cylindrical", with longitude and latitude as axes. By default it is
    the first of the globe, and the second with an `extent` or off the equator. `region` gives a window by its sides
    instead, (west, east, south, north) in degrees, on the cylindrical projection.

    A plane is drawn as it is, from border to border where it repeats itself; the data coordinates of its Axes are
    metres. Its `region` is (left, right, bottom, top) in metres; what else is told of the globe does not go with it.

    Colours run over the values on the map, symmetrically where these have both signs, in the palette of the field
    (`postprocess.figures.palettes`), unless `cmap` or `norm` say otherwise. The colour bar has the name and the units
    of the field, or `label`, and takes its room from `ax`; without `ax`, the map is on a new figure of pyplot. Raises
    `InputError` where there is no such field, snapshot or window.
    """
    shown = _shown_field(where, field, time)
    draw = drawing_of(shown.mesh, centre, extent, region, projection)
    if ax is None:
        import matplotlib.pyplot as plt  # only here: drawing on Axes of the caller's needs no backend

        _, ax = plt.subplots(layout="constrained")
    draw(ax, shown.values, {})
    drawn = ax.collections[-1]
    _set_colours(drawn, _values_in_view(ax, drawn), shown.name, cmap, norm)
    if shown.title:
        ax.set_title(shown.title)
    if colour_bar:
        figure = ax.get_figure()
        assert figure is not None
        _print_powers(figure.colorbar(drawn, ax=ax, shrink=0.8, label=shown.label if label is None else label))
    return ax


def _shown_field(where: Run | VoronoiMesh | AnyPath, field: str | Array, time: int) -> ShownField:
    if isinstance(where, VoronoiMesh):
        return mesh_field(where, field) if isinstance(field, str) else given_field(where, field)
    run = where if isinstance(where, Run) else open_run(where)
    return snapshot_field(run, field, time) if isinstance(field, str) else given_to_run(run, field, time)


def drawing_of(
    mesh: VoronoiMesh,
    centre: tuple[float, float],
    extent: Extent,
    region: Region | None,
    projection: Projection | None,
) -> Draw:
    """How values on a mesh are drawn; raise `InputError` where there is no such map."""
    if not mesh.on_a_sphere:
        if (centre, extent, projection) != (MIDDLE, None, None):
            raise InputError(
                "a plane is drawn as it is, without projection, centre and extent; leave them out, and for a part of "
                "it give region, (left, right, bottom, top) in metres"
            )
        return PlanePaper(mesh).draw if region is None else partial(PlanePaper(mesh).draw, box=_part_of(mesh, region))
    if region is not None:
        centre, extent, projection = _box(region, centre, extent, projection)
    chosen = projection or ("mollweide" if extent is None and centre[1] == 0.0 else "orthographic")
    return partial(_draw, mesh, chosen, _window(chosen, centre, extent), extent is None)


def _part_of(mesh: VoronoiMesh, region: Region) -> Region:
    """The region of a plane; raise `InputError` where there is no such one."""
    if np.shape(region) != (4,):
        raise InputError(f"a plane has no region {region}; give four numbers, left, right, bottom and top in metres")
    left, right, bottom, top = region
    if not (np.isfinite(region).all() and left < right and bottom < top):
        raise InputError(
            f"a plane has no region {region}; give left, right, bottom and top in metres, left below right and bottom "
            "below top"
        )
    for side, period in ((right - left, mesh.x_period), (top - bottom, mesh.y_period)):
        if 0.0 < period < side:
            raise InputError(
                f"the region {region} is {side:g} m long where the plane repeats itself after {period:g} m; give a "
                "smaller one"
            )
    return left, right, bottom, top


def _box(
    region: Region,
    centre: tuple[float, float],
    extent: Extent,
    projection: Projection | None,
) -> tuple[tuple[float, float], tuple[float, float], Projection]:
    """Centre, extent and projection of a `region`; raise `InputError` where there is no such region on a map."""
    if np.shape(region) != (4,):
        raise InputError(f"a map has no region {region}; give four numbers, west, east, south and north in degrees")
    west, east, south, north = region
    if centre != MIDDLE or extent is not None or projection not in (None, "cylindrical"):
        raise InputError(
            f"a region {region} is drawn between its meridians and parallels, on the cylindrical projection; give it "
            "without centre and extent, or these without a region"
        )
    if not (np.isfinite(region).all() and -90.0 <= south < north <= 90.0 and west != east):
        raise InputError(
            f"a map has no region {region}; give west, east, south and north in degrees, south below north"
        )
    width = float(degrees_eastward(np.array(east - west))) or 360.0
    return (west + 0.5 * width, 0.5 * (south + north)), (width, north - south), "cylindrical"


def _window(projection: Projection, centre: tuple[float, float], extent: Extent) -> Window:
    """What a map shows; raise `InputError` where there is no such map."""
    if projection not in get_args(Projection):
        known = ", ".join(get_args(Projection))
        raise InputError(f"there is no projection named '{projection}'; choose one of {known}")
    longitude, latitude = centre
    if not (np.isfinite(longitude) and abs(latitude) <= 90.0):
        raise InputError(f"a map has no centre ({longitude:g}, {latitude:g}); give longitude and latitude in degrees")
    if projection == "mollweide" and (extent is not None or latitude != 0.0):
        raise InputError(
            "a Mollweide map shows the whole globe with the equator in the middle; for an extent or another latitude "
            "choose the projection orthographic or cylindrical"
        )
    largest = LARGEST[projection]
    if extent is None:
        return Window(longitude, latitude if projection == "orthographic" else 0.0, *largest)
    width, height = (extent, extent) if isinstance(extent, float | int) else extent
    if not (0.0 < width <= largest[0] and 0.0 < height <= largest[1]):
        raise InputError(
            f"a window of {width:g} x {height:g} degrees does not fit on the {projection} map; it may have up to "
            f"{largest[0]:g} x {largest[1]:g}"
        )
    return Window(longitude, latitude, width, height)


def _draw(
    mesh: VoronoiMesh, projection: Projection, window: Window, whole: bool, axes: Axes, values: Array, options: dict
) -> Axes:
    if projection == "cylindrical":
        return draw_cylindrical(axes, mesh, values, options, window)
    if projection == "mollweide":
        return draw_mollweide(axes, mesh, values, options, window.centre[0])
    if whole:
        return draw_orthographic(axes, mesh, values, options, *window.centre)
    return draw_orthographic_window(axes, mesh, values, options, window)


def _values_in_view(axes: Axes, drawn: Collection) -> Array:
    """Values of the polygons that reach into the window of the map: those beside it are drawn, but not seen."""
    values = np.asarray(drawn.get_array(), dtype=float)
    corners = [np.asarray(path.vertices) for path in drawn.get_paths()]
    if not corners:
        return values
    starts = np.cumsum([0, *(len(each) for each in corners[:-1])])
    joined = np.concatenate(corners)
    least, most = np.minimum.reduceat(joined, starts), np.maximum.reduceat(joined, starts)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    return values[np.all((most > (left, bottom)) & (least < (right, top)), axis=1)]


def _set_colours(
    drawn: Collection, values: Array, name: str, cmap: str | Colormap | None, norm: Normalize | None
) -> None:
    """Colours of the field called `name` over the finite `values`, or those of the caller."""
    usual = colours_for(name, values).options
    drawn.set(cmap=cmap or usual["cmap"], norm=norm or usual["norm"])


def _print_powers(bar: Colorbar) -> None:
    """Write a power of ten over the colour bar as 10⁻⁸ is written, not as 1e-8."""
    if isinstance(bar.formatter, ScalarFormatter):
        bar.formatter.set_useMathText(True)
        bar.update_ticks()

"""Differences between the metrics of a mesh and those that follow from its generators."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.metrics import edge_angles
from mesh.geometry.angles import about_zero
from mesh.geometry.sphere import dot
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import Metrics, VoronoiMesh

PLURALS = {"cell": "cells", "edge": "edges", "vertex": "vertices"}


@dataclass(frozen=True)
class Difference:
    """How far the arrays `names` of a mesh, called `label` in files, are from what the generators give.

    `relative` is the absolute difference by the local size, of one row for each of the entities `place`; for an angle
    `radians` is the largest difference in radians, which is what a user reads.
    """

    label: str
    names: tuple[str, ...]
    place: str
    relative: Array
    radians: float | None = None

    @property
    def in_words(self) -> str:
        """The largest difference, with its unit."""
        if self.radians is not None:
            return f"{self.radians:.1e} rad"
        return f"{self.relative.max():.1e} of the local size"


def metric_differences(mesh: VoronoiMesh, exact: Metrics) -> Iterator[Difference]:
    """Every metric of `mesh` but the angles of edges beside `exact`, in lengths of its unit, that of its generators.

    The local size of a vertex is its distance to the cells; that of an edge is the largest of its own and its
    vertices'. What is not finite differs by infinity.
    """
    radius, surface = mesh.length_unit, surface_of(mesh)
    size = _local_sizes(mesh, exact)
    vertex, edge = size["vertex"][:, None], size["edge"][:, None]
    for place in ("edge", "vertex"):
        way = surface.shortest(np.stack([_difference(mesh, exact, f"{axis}_{place}", radius) for axis in "xyz"], 1))
        apart = np.sqrt(dot(way, way))
        names = tuple(f"{axis}_{place}" for axis in "xyz")
        name = place.capitalize()
        yield _relative(f"x{name}, y{name} or z{name}", names, place, apart / size[place])
    for label, name, place, power, scale in (
        ("dcEdge", "dc_edge", "edge", 1, exact.dc_edge),
        ("dvEdge", "dv_edge", "edge", 1, size["edge"]),
        ("areaCell", "area_cell", "cell", 2, exact.area_cell),
        ("areaTriangle", "area_triangle", "vertex", 2, exact.area_triangle),
        ("kiteAreasOnVertex", "kite_areas_on_vertex", "vertex", 2, vertex**2),
        ("weightsOnEdge", "weights_on_edge", "edge", 0, edge / exact.dc_edge[:, None]),
    ):
        yield _relative(label, (name,), place, _difference(mesh, exact, name, radius**power) / scale)
    for place in size:
        name, latitude = place.capitalize(), getattr(exact, f"lat_{place}")
        north = _difference(mesh, exact, f"lat_{place}", 1.0)
        yield _angle(f"lat{name}", f"lat_{place}", place, north, north / size[place])
        turn = about_zero(_difference(mesh, exact, f"lon_{place}", 1.0))
        yield _angle(f"lon{name}", f"lon_{place}", place, turn, turn * np.cos(latitude) / size[place])


def angle_difference(mesh: VoronoiMesh, exact: Metrics) -> Difference:
    """The angles of edges beside those of the generators.

    At a pole the longitude is arbitrary, and the angle counts from the east that it defines. That of a wall follows
    from its vertices, the less surely the shorter it is.
    """
    turn = about_zero(mesh.angle_edge - angles_in_place(mesh, exact))
    walls = mesh.cells_on_edge[:, 1] < 0
    sure = np.where(walls, np.minimum(exact.dv_edge / exact.dc_edge, 1.0), 1.0)
    return _angle("angleEdge", "angle_edge", "edge", turn, turn * sure)


def angles_in_place(mesh: VoronoiMesh, exact: Metrics) -> Array:
    """Angles (n_edges,) of the normals at the longitudes and latitudes that `mesh` has, radians."""
    cells, edges, vertices = (
        np.stack([getattr(exact, f"{axis}_{place}") for axis in "xyz"], axis=1) for place in ("cell", "edge", "vertex")
    )
    return edge_angles(surface_of(mesh), cells, edges, vertices, mesh, mesh.lon_edge, mesh.lat_edge)


def _local_sizes(mesh: VoronoiMesh, exact: Metrics) -> dict[str, Array]:
    first = mesh.cells_on_vertex[:, 0]
    cells = np.where(first >= 0, first, mesh.cells_on_vertex.max(axis=1))
    spoke = np.stack([getattr(exact, f"{axis}_vertex") - getattr(exact, f"{axis}_cell")[cells] for axis in "xyz"], 1)
    spoke = surface_of(mesh).shortest(spoke)
    vertex = np.sqrt(dot(spoke, spoke))
    edge = np.maximum(exact.dc_edge, vertex[mesh.vertices_on_edge].max(axis=1))
    return {"cell": np.sqrt(exact.area_cell), "edge": edge, "vertex": vertex}


def _difference(mesh: VoronoiMesh, exact: Metrics, name: str, unit: float) -> Array:
    return getattr(mesh, name) / unit - getattr(exact, name)


def _relative(label: str, names: tuple[str, ...], place: str, relative: Array) -> Difference:
    return Difference(label, names, PLURALS[place], _size(relative))


def _angle(label: str, name: str, place: str, difference: Array, relative: Array) -> Difference:
    return Difference(label, (name,), PLURALS[place], _size(relative), float(_size(difference).max()))


def _size(difference: Array) -> Array:
    """Absolute values, infinity where there is no number."""
    size = np.abs(difference)
    return np.where(np.isnan(size), np.inf, size)

"""One table: what every mesh array is called in a file, where it lives, and what it means."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

DIMENSIONS = {
    "n_cells": "nCells",
    "n_edges": "nEdges",
    "n_vertices": "nVertices",
    "max_edges": "maxEdges",
    "max_edges_2": "maxEdges2",
    "two": "TWO",
    "vertex_degree": "vertexDegree",
}


class MeshSizes(Protocol):
    """Numbers of the entities of a mesh, as `Topology` has them."""

    @property
    def n_cells(self) -> int:
        """Number of cells."""

    @property
    def n_edges(self) -> int:
        """Number of edges."""

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""

    @property
    def max_edges(self) -> int:
        """Width of the rings of cells."""


class MeshOutline(MeshSizes, Protocol):
    """All of a mesh but its arrays, as `VoronoiMesh` has it."""

    @property
    def sphere_radius(self) -> float:
        """Radius of the sphere, metres; zero on a plane."""

    @property
    def x_period(self) -> float:
        """Length after which a plane repeats itself in x, metres; zero if it does not."""

    @property
    def y_period(self) -> float:
        """The same in y."""

    @property
    def density_name(self) -> str:
        """Name of the density that the mesh was generated for."""

    @property
    def density_source(self) -> str:
        """Where that density is found."""

    @property
    def fixed_cells(self) -> NDArray[np.bool_] | None:
        """Generators that were held (n_cells,), None if none were."""


def dimension_sizes(mesh: MeshSizes) -> dict[str, int]:
    """Size of every dimension of a mesh."""
    return {
        "n_cells": mesh.n_cells,
        "n_edges": mesh.n_edges,
        "n_vertices": mesh.n_vertices,
        "max_edges": mesh.max_edges,
        "max_edges_2": 2 * mesh.max_edges,
        "two": 2,
        "vertex_degree": 3,
    }


@dataclass(frozen=True)
class MeshVariable:
    """One mesh array: `name` in memory, dimensions, units in a file of radius in metres, and meaning.

    `is_index` marks arrays whose values number entities (from 0 in memory, from 1 in files); `of` is then the
    dimension they number. `required` arrays have to be in a file; the others are made anew where absent.
    """

    name: str
    dimensions: tuple[str, ...]
    units: str
    long_name: str
    of: str | None = None
    required: bool = True
    integer: bool = False

    @property
    def is_index(self) -> bool:
        """Whether the values number entities."""
        return self.of is not None

    @property
    def file_name(self) -> str:
        """The MPAS name, the camelCase of `name`."""
        first, *rest = self.name.split("_")
        return first + "".join(word.capitalize() for word in rest)


def _coordinates(place: str, dimension: str) -> list[MeshVariable]:
    """The five coordinate arrays of one kind of entity."""
    plural = "vertices" if place == "vertex" else f"{place}s"
    angles = [
        MeshVariable(f"{short}_{place}", (dimension,), "rad", f"{full} of {plural}", required=False)
        for short, full in (("lat", "latitude"), ("lon", "longitude"))
    ]
    cartesian = [MeshVariable(f"{axis}_{place}", (dimension,), "m", f"Cartesian {axis} of {plural}") for axis in "xyz"]
    return angles + cartesian


def _index(name: str, dimensions: tuple[str, ...], of: str, long_name: str) -> MeshVariable:
    return MeshVariable(name, dimensions, "1", long_name, of=of, integer=True)


MESH_VARIABLES: tuple[MeshVariable, ...] = (
    *_coordinates("cell", "n_cells"),
    *_coordinates("edge", "n_edges"),
    *_coordinates("vertex", "n_vertices"),
    MeshVariable("n_edges_on_cell", ("n_cells",), "1", "number of edges of a cell", integer=True),
    _index("cells_on_cell", ("n_cells", "max_edges"), "n_cells", "cells across the edges of a cell"),
    _index("edges_on_cell", ("n_cells", "max_edges"), "n_edges", "edges of a cell, counter-clockwise"),
    _index("vertices_on_cell", ("n_cells", "max_edges"), "n_vertices", "vertices after each edge of a cell"),
    MeshVariable("n_edges_on_edge", ("n_edges",), "1", "number of edges that reconstruct a tangent", integer=True),
    _index("edges_on_edge", ("n_edges", "max_edges_2"), "n_edges", "edges that reconstruct a tangential velocity"),
    MeshVariable("weights_on_edge", ("n_edges", "max_edges_2"), "1", "weights of the tangential velocity"),
    _index("cells_on_edge", ("n_edges", "two"), "n_cells", "cells that an edge's normal leaves and enters"),
    _index("vertices_on_edge", ("n_edges", "two"), "n_vertices", "vertices at the tail and head of the tangent"),
    _index("cells_on_vertex", ("n_vertices", "vertex_degree"), "n_cells", "corners of a triangle"),
    _index("edges_on_vertex", ("n_vertices", "vertex_degree"), "n_edges", "edges that meet at a vertex"),
    MeshVariable(
        "kite_areas_on_vertex",
        ("n_vertices", "vertex_degree"),
        "m2",
        "part of a cell in a triangle",
    ),
    MeshVariable("area_cell", ("n_cells",), "m2", "area of a cell"),
    MeshVariable("area_triangle", ("n_vertices",), "m2", "area of a Delaunay triangle"),
    MeshVariable("dc_edge", ("n_edges",), "m", "distance between the cell centres of an edge"),
    MeshVariable("dv_edge", ("n_edges",), "m", "distance between the vertices of an edge"),
    MeshVariable("angle_edge", ("n_edges",), "rad", "angle of an edge's normal, counter-clockwise from east"),
    MeshVariable(
        "mesh_density",
        ("n_cells",),
        "1",
        "density that the mesh was generated for, at centres",
        required=False,
    ),
    MeshVariable("boundary_vertex", ("n_vertices",), "1", "1 at the boundary, 0 within", integer=True, required=False),
)

BY_NAME = {variable.name: variable for variable in MESH_VARIABLES}


def coordinates_on(mesh: MeshOutline) -> dict[str, str]:
    """Coordinates of what lies on each dimension of the file of a mesh, as the CF conventions name them."""
    names = ("lon", "lat") if mesh.sphere_radius > 0.0 else ("x", "y")
    return {
        DIMENSIONS[dimension]: " ".join(BY_NAME[f"{name}_{place}"].file_name for name in names)
        for place, dimension in (("cell", "n_cells"), ("edge", "n_edges"), ("vertex", "n_vertices"))
    }

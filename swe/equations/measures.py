"""Sizes of the entities over which integrals are taken: those that a process owns, so that each is counted once."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Signs
from mesh.voronoi_mesh import VoronoiMesh
from swe.parallel.processes import Own, Selection

Values = TypeVar("Values", bound=NDArray[Any])


@dataclass(frozen=True, eq=False)
class Measures:
    """The factors of every term of an integral, zero at entities that other processes count.

    Each is the array of the mesh itself where none does. `circulation_signs` are the factors in circulations that are
    vorticity (`mesh.discrete.walls`).
    """

    area_cell: Array
    area_triangle: Array
    kite_areas_on_vertex: Array
    dv_edge: Array
    dc_edge: Array
    circulation_signs: Signs | Array

    @cached_property
    def half_edge_area(self) -> Array:
        """l_e d_e / 2."""
        return 0.5 * self.dv_edge * self.dc_edge


def measures_of(closed: VoronoiMesh, circulation_signs: Signs | Array, own: Own) -> Measures:
    """Those of a mesh `closed` for loops, with its `circulation_signs`, whose entities `own` are counted here.

    `dc_edge` is that of the mesh everywhere, as circulations at own vertices go along edges of others.
    """
    return Measures(
        _only(own.cells, closed.area_cell),
        _only(own.vertices, closed.area_triangle),
        _only(own.vertices, closed.kite_areas_on_vertex),
        _only(own.edges, closed.dv_edge),
        closed.dc_edge,
        _only(own.vertices, circulation_signs),
    )


def _only(own: Selection, values: Values) -> Values:
    """`values` at `own` entities, and zero at others."""
    if isinstance(own, slice):
        return values
    only = np.zeros_like(values)
    only[own] = values[own]
    return only

"""Connectivity in any legal order, sorted into the order that `Topology` promises.

Programs differ in where rings start, in their sense of rotation, in what fills short rings and in how the arrays of one
entity are paired. All of it follows from the triangles and from the numbers and normals of the edges; arrays that hold
the same entities in another order are legal, and what holds other entities contradicts the rest.
"""

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.conventions import BY_NAME, MeshVariable
from mesh.discrete.connectivity import require_closed, validate_topology
from mesh.discrete.topology import FILL, connect
from mesh.discrete.validate import check_orientation
from mesh.errors import MeshError, require
from mesh.geometry.sphere import dot
from mesh.geometry.surface import UNIT_SPHERE, Surface
from mesh.triangulation.ordering import turn_triangles
from mesh.voronoi_mesh import TOPOLOGY_NAMES, Topology

Arrays = dict[str, NDArray]

EDGE_COUNTS = {"n_edges_on_cell": "cells", "n_edges_on_edge": "edges"}


def topology_in_order(arrays: Arrays, points: Array, surface: Surface = UNIT_SPHERE) -> Topology | None:
    """The topology of the arrays as they are, None if some are missing or in another order.

    `points` (n_cells, 3) are the generators on the surface.
    """
    if not all(name in arrays for name in TOPOLOGY_NAMES):
        return None
    topology = Topology(**{name: arrays[name] for name in TOPOLOGY_NAMES})
    try:
        validate_topology(topology, surface.handles)
        check_orientation(points, topology, surface)
    except MeshError:
        return None
    return topology


def arranged_topology(arrays: Arrays, points: Array, surface: Surface = UNIT_SPHERE) -> Topology:
    """The topology of triangles and, where they are there, numbers and normals of edges, rings at their lowest edges.

    Raises `MeshError` where they do not close the surface, or where any other array holds other entities.
    """
    triangles = arrays["cells_on_vertex"]
    n_cells = len(points)
    cells_on_edge = arrays.get("cells_on_edge")
    n_edges = 3 * (n_cells - 2 + 2 * surface.handles) if cells_on_edge is None else len(cells_on_edge)
    require_closed(n_cells, n_edges, len(triangles), surface.handles)
    _require_cells("cells_on_vertex", triangles, n_cells)
    if cells_on_edge is not None:
        _require_cells("cells_on_edge", cells_on_edge, n_cells)
    topology = connect(turn_triangles(_counter_clockwise(triangles, points, surface)), n_cells, cells_on_edge)
    for name in EDGE_COUNTS:
        if name in arrays:
            _require_count(name, arrays[name], getattr(topology, name))
    require_same_entities(arrays, topology)
    validate_topology(topology, surface.handles)
    check_orientation(points, topology, surface)
    return topology


def reordered(arrays: Arrays, topology: Topology) -> list[str]:
    """Names, as in files, of the connectivity arrays whose order differs from that of `topology`."""
    return [
        BY_NAME[name].file_name
        for name in TOPOLOGY_NAMES
        if name in arrays and BY_NAME[name].is_index and not _starts_with(arrays[name], getattr(topology, name))
    ]


def arrange_kites(kites: Array, cells_on_vertex: Index, topology: Topology) -> Array:
    """Kites (n_vertices, 3) of the cells in the order of the file, in that of `topology`."""
    same = np.expand_dims(topology.cells_on_vertex, 2) == np.expand_dims(cells_on_vertex, 1)
    source = np.argmax(same, axis=2)
    return np.take_along_axis(kites, source, axis=1)


def arrange_weights(weights: Array, arrays: Arrays, topology: Topology, exact: Array) -> Array:
    """Weights (n_edges, 2 max_edges) of the edges in the order of the file, in that of `topology`.

    Where the vertices of an edge stood against the tangent, its weights may be those of the tangent turned round:
    those of which the signs agree with `exact`, what the generators give, are meant.
    """
    result: Array = np.zeros(topology.edges_on_edge.shape)
    used = topology.edges_on_edge != FILL
    width = min(result.shape[1], weights.shape[1])
    source = np.argsort(_padded(arrays["edges_on_edge"], topology.n_edges_on_edge), axis=1)[:, :width]
    target = np.argsort(_padded(topology.edges_on_edge, topology.n_edges_on_edge), axis=1)[:, :width]
    values = np.take_along_axis(weights, source, axis=1)
    np.put_along_axis(result, target, values, axis=1)
    result = np.where(used, result, 0.0)
    if "vertices_on_edge" in arrays:
        turned = arrays["vertices_on_edge"][:, 0] != topology.vertices_on_edge[:, 0]
        with np.errstate(invalid="ignore"):  # what is not finite is refused later
            against = (result * exact).sum(axis=1) < 0.0
        result[turned & against] *= -1.0
    return result


def _counter_clockwise(triangles: Index, points: Array, surface: Surface) -> Index:
    """The triangles, those that run clockwise seen from outside turned round."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    clockwise = dot(surface.outward(a), np.cross(surface.shortest(b - a), surface.shortest(c - a))) < 0.0
    return np.where(clockwise[:, None], triangles[:, [0, 2, 1]], triangles)


def _require_cells(name: str, cells: Index, n_cells: int) -> None:
    """Check that all entries of an array are cells, and that no row names one twice."""
    variable = BY_NAME[name]
    place = variable.dimensions[0][2:]
    require(
        (cells >= 0) & (cells < n_cells),
        place,
        f"{variable.file_name} holds an index outside 1 to {n_cells}; only a mesh with walls has 0 for what is "
        "missing, in cellsOnEdge and in cellsOnVertex",
    )
    ordered = np.sort(cells, axis=1)
    require(ordered[:, 1:] != ordered[:, :-1], place, f"{variable.file_name} names one cell twice")


def _require_count(name: str, found: Index, expected: Index) -> None:
    require(
        found == expected,
        EDGE_COUNTS[name],
        f"{BY_NAME[name].file_name} is not the number of edges that cellsOnVertex gives; correct or remove it",
    )


def require_same_entities(arrays: Arrays, topology: Topology) -> None:
    """Raise `MeshError` unless all connectivity among the arrays has the entities of the topology, in any order."""
    for name in TOPOLOGY_NAMES:
        if name in arrays and BY_NAME[name].is_index:
            _require_same_rows(name, arrays[name], topology)


def _require_same_rows(name: str, found: Index, topology: Topology) -> None:
    """Each row of `found` has the entities of that of the array `name`, in any order and with any fill beyond them."""
    variable, expected = BY_NAME[name], getattr(topology, name)
    place = variable.dimensions[0][2:]
    counts = _counts(variable, topology)
    require(
        counts <= found.shape[1], place, f"{variable.file_name} has room for {found.shape[1]} entries and needs more"
    )
    valid = np.sort(_padded(found, counts), axis=1)[:, : expected.shape[1]]
    meant = np.sort(_padded(expected, counts), axis=1)[:, : valid.shape[1]]
    wrong = np.flatnonzero((valid != meant).any(axis=1))
    if len(wrong):
        row = wrong[0]
        here = (np.array([found[row, : counts[row]], expected[row, : counts[row]]]) + 1).tolist()
        require(
            (valid == meant).all(axis=1),
            place,
            f"{variable.file_name} holds {here[0]} where cellsOnVertex and cellsOnEdge give {here[1]} (counted from "
            "1); one of them is damaged, so correct the file",
        )


def _counts(variable: MeshVariable, topology: Topology) -> Index:
    """How many entries (n,) of the rows of an array are no fill; one beside a wall may be missing among them."""
    rows = getattr(topology, variable.name)
    of_rings = {"max_edges": topology.n_edges_on_cell, "max_edges_2": topology.n_edges_on_edge}
    return of_rings.get(variable.dimensions[1], np.full(len(rows), rows.shape[1]))


def _padded(rows: Index, counts: Index) -> Index:
    """The rows with what stands beyond their counts replaced by what sorts behind all entities."""
    return np.where(np.arange(rows.shape[1]) < counts[:, None], rows, np.iinfo(np.int32).max)


def _starts_with(found: Index, expected: Index) -> bool:
    """Whether each row of `found` begins with that of `expected`, fill left out."""
    width = min(found.shape[1], expected.shape[1])
    used = expected[:, :width] != FILL
    return bool(np.all((found[:, :width] == expected[:, :width]) | ~used))

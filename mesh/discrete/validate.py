"""Checks that a mesh is valid: consistent connectivity, metrics that belong to it, and the discrete identities.

Connectivity is checked exactly; residuals of metrics and identities, relative to the local size, must stay below a
tolerance. Errors name the first offending entities, counted from 0.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks, row_loop
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.discrete.comparison import Difference, angle_difference, metric_differences
from mesh.discrete.connectivity import validate_topology
from mesh.discrete.identities import identity_residuals
from mesh.discrete.metrics import at_walls_of, compute_metrics
from mesh.discrete.topology import FILL
from mesh.errors import MeshError, require
from mesh.geometry.surface import UNIT_SPHERE, Surface, surface_of
from mesh.geometry.vectors import cross_product, dot_product, nearest_image, outward, triple_product, vector_between
from mesh.voronoi_mesh import Metrics, Topology, VoronoiMesh

RULES = 1
"""Version of what a mesh must fulfil: to be raised when that changes, so that older files are validated anew."""

OWN_TOLERANCE = 1e-11
"""Largest residual of meshes made here."""

OUTSIDE_TOLERANCE = 1e-6
"""Largest residual of files from other programs (their converters leave relative noise of 1e-7), and largest difference
between metrics and what the generators give: rounding of coordinates is magnified in a circumcentre."""

REBUILD = "rebuild the metrics (--recompute-metrics, or recompute_metrics=True in Python) or correct the file"


def validate_mesh(mesh: VoronoiMesh, tolerance: float = OWN_TOLERANCE, fresh_metrics: bool = False) -> dict[str, float]:
    """Check everything; return the residuals of the discrete identities by name.

    `tolerance` bounds those residuals. With `fresh_metrics`, the caller has just computed the metrics from the
    generators, and they are not computed again to be compared. Raises `MeshError`, one sentence that names entities
    and values, at the first thing that fails.
    """
    surface = surface_of(mesh)
    _check_shapes(mesh)
    check_values(mesh)
    validate_topology(mesh, surface.handles)
    check_orientation(mesh.cell_points / mesh.length_unit, mesh, surface)
    exact = None
    if not fresh_metrics:
        exact = compute_metrics(surface.onto(mesh.cell_points), mesh, at_walls_of(mesh), surface)
    return validate_metrics(mesh, exact, tolerance)


def validate_metrics(mesh: VoronoiMesh, exact: Metrics | None, tolerance: float) -> dict[str, float]:
    """Check the metrics on a valid topology; return the residuals of the discrete identities by name.

    `exact` are the metrics, in lengths of the mesh's unit, that follow from the generators, None where those
    of `mesh` do. Raises `MeshError`.
    """
    _check_delaunay(mesh)
    for difference in () if exact is None else (*metric_differences(mesh, exact), angle_difference(mesh, exact)):
        require_small(difference)
    residuals = identity_residuals(mesh)
    for name, residual in residuals.items():
        if not residual <= tolerance:
            raise MeshError(
                f"{name} holds only to {residual:.1e} instead of {tolerance:.0e}; "
                "the metrics do not belong together, recompute them from the generators"
            )
    return residuals


def require_small(difference: Difference, tolerance: float = OUTSIDE_TOLERANCE) -> None:
    """Raise `MeshError` where metrics differ from what the generators give by more than `tolerance`."""
    require(
        difference.relative <= tolerance,
        difference.place,
        f"{difference.label} differs from what the generators give by up to {difference.in_words}; {REBUILD}",
    )


def _check_shapes(mesh: VoronoiMesh) -> None:
    sizes = dimension_sizes(mesh)
    for variable in MESH_VARIABLES:
        expected = tuple(sizes[dimension] for dimension in variable.dimensions)
        shape = getattr(mesh, variable.name).shape
        if not variable.integer and shape != expected:
            raise MeshError(f"{variable.file_name} has shape {shape} instead of {expected}")


def check_values(mesh: VoronoiMesh) -> None:
    """Check that all numbers are finite and that coordinates lie on the sphere of the stated radius, or on the plane.

    Raises `MeshError`.
    """
    for variable in MESH_VARIABLES:
        if not variable.integer:
            values = getattr(mesh, variable.name)
            require(
                by_blocks(_are_finite, values.reshape(len(values), -1)),
                variable.dimensions[0][2:],
                f"{variable.file_name} is not a finite number",
            )
    for place, name in (("cells", "cell"), ("edges", "edge"), ("vertices", "vertex")):
        axes = (getattr(mesh, f"{axis}_{name}") for axis in "xyz")
        _require_on(surface_of(mesh), np.stack(list(axes), axis=1), mesh.length_unit, place)


@row_loop
def _are_finite(rows: Array) -> NDArray[np.bool_]:
    """Whether all numbers of each row are finite."""
    finite = np.ones(len(rows), np.bool_)
    for row in range(len(rows)):
        for place in range(rows.shape[1]):
            finite[row] &= np.isfinite(rows[row, place])
    return finite


def require_on_sphere(points: Array, radius: float, place: str) -> None:
    """Raise `MeshError` unless all points (n, 3) lie on the sphere of this radius."""
    _require_on(UNIT_SPHERE, points, radius, place)


def _require_on(surface: Surface, points: Array, unit: float, place: str) -> None:
    """Raise `MeshError` unless all points (n, 3), in lengths of `unit`, lie on a surface."""
    wrong = f"not at sphere_radius = {unit:g} from the origin" if not surface.is_flat else "not in the plane z = 0"
    off = by_blocks(lambda rows: surface.is_off(rows, unit, OUTSIDE_TOLERANCE), points)
    require(~off, place, f"the coordinates are {wrong}")


def check_orientation(points: Array, topology: Topology, surface: Surface = UNIT_SPHERE) -> None:
    """Check that triangles and rings run counter-clockwise for generators `points` (n_cells, 3) on a surface.

    Of three cells, or of two neighbours in turn, one of which is missing, nothing is known. Raises `MeshError`.
    """
    form = surface.periods, surface.is_flat
    require(
        by_blocks(partial(_triangles_turn, points, *form), topology.cells_on_vertex),
        "vertices",
        "cellsOnVertex does not run counter-clockwise",
    )
    require(
        by_blocks(partial(_rings_turn, points, *form), points, topology.cells_on_cell, topology.n_edges_on_cell),
        "cells",
        "edgesOnCell does not run counter-clockwise",
    )


@row_loop
def _triangles_turn(points: Array, periods: Array, is_flat: bool, cells: Index) -> NDArray[np.bool_]:
    """Whether the three cells (n, 3) of each triangle run counter-clockwise."""
    turns = np.empty(len(cells), np.bool_)
    for row in range(len(cells)):
        a, b, c = cells[row, 0], cells[row, 1], cells[row, 2]
        if min(a, b, c) == FILL:
            turns[row] = True
            continue
        u = nearest_image(vector_between(points, a, points, b), periods)
        v = nearest_image(vector_between(points, a, points, c), periods)
        turns[row] = triple_product(outward(points, a, is_flat), u, v) > 0.0
    return turns


@row_loop
def _rings_turn(
    points: Array, periods: Array, is_flat: bool, centers: Array, cells: Index, counts: Index
) -> NDArray[np.bool_]:
    """Whether the neighbours (n, max_edges) of each cell run counter-clockwise round its centre (n, 3)."""
    turns = np.ones(len(cells), np.bool_)
    for row in range(len(cells)):
        for place in range(counts[row]):
            following = cells[row, place + 1 if place + 1 < counts[row] else 0]
            if cells[row, place] == FILL or following == FILL:
                continue
            spoke = nearest_image(vector_between(centers, row, points, cells[row, place]), periods)
            next_spoke = nearest_image(vector_between(centers, row, points, following), periods)
            turns[row] &= triple_product(outward(centers, row, is_flat), spoke, next_spoke) > 0.0
    return turns


def _check_delaunay(mesh: VoronoiMesh) -> None:
    """Check that edges run along their tangents: the mesh is the Voronoi mesh of its cells, with walls or without."""
    points, vertices, surface = mesh.cell_points, mesh.vertex_points, surface_of(mesh)
    for each in (points, vertices):
        each /= mesh.length_unit

    def along_tangent(*rows: NDArray) -> NDArray[np.bool_]:
        middles = np.stack(rows[:3], axis=1) / mesh.length_unit
        return _run_along_tangent(points, vertices, surface.periods, surface.is_flat, middles, *rows[3:])

    require(
        by_blocks(
            along_tangent,
            *(mesh.x_edge, mesh.y_edge, mesh.z_edge, mesh.cells_on_edge, mesh.vertices_on_edge),
        ),
        "edges",
        "the vertices of the edge lie against its tangent: the triangles are not the Delaunay triangulation of the "
        "cells, or vertices are out of place; build the mesh anew from its generators",
    )


@row_loop
def _run_along_tangent(
    points: Array, vertices: Array, periods: Array, is_flat: bool, middles: Array, cells: Index, ends: Index
) -> NDArray[np.bool_]:
    """Whether the way from the first to the second end (n, 2) of each edge does not run against its tangent."""
    right = np.empty(len(cells), np.bool_)
    for row in range(len(cells)):
        if cells[row, 1] == FILL:  # half of the way to where the other cell was
            normal = vector_between(points, cells[row, 0], middles, row)
        else:
            normal = vector_between(points, cells[row, 0], points, cells[row, 1])
        normal = nearest_image(normal, periods)
        along = nearest_image(vector_between(vertices, ends[row, 0], vertices, ends[row, 1]), periods)
        # Vertices of cells on one circle coincide but for round-off, which a circumcentre magnifies.
        slack = OUTSIDE_TOLERANCE * dot_product(normal, normal)
        right[row] = dot_product(along, cross_product(outward(middles, row, is_flat), normal)) >= -slack
    return right

"""Checks that a mesh is valid: consistent connectivity, metrics that belong to it, and the discrete identities.

Connectivity is checked exactly; residuals of metrics and identities, relative to the local size, must stay below a
tolerance. Errors name the first offending entities, counted from 0.
"""

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.discrete.comparison import Difference, angle_difference, metric_differences
from mesh.discrete.connectivity import validate_topology
from mesh.discrete.identities import identity_residuals
from mesh.discrete.metrics import compute_metrics
from mesh.errors import MeshError, require
from mesh.geometry.sphere import dot, normalize
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
    _check_shapes(mesh)
    check_values(mesh)
    validate_topology(mesh)
    check_orientation(mesh.cell_points / mesh.sphere_radius, mesh)
    exact = None if fresh_metrics else compute_metrics(normalize(mesh.cell_points), mesh)
    return validate_metrics(mesh, exact, tolerance)


def validate_metrics(mesh: VoronoiMesh, exact: Metrics | None, tolerance: float) -> dict[str, float]:
    """Check the metrics on a valid topology; return the residuals of the discrete identities by name.

    `exact` are the metrics on the unit sphere that follow from the generators, None where those of `mesh` do.
    Raises `MeshError`.
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
    """Check that all numbers are finite and that coordinates lie on the sphere of the stated radius.

    Raises `MeshError`.
    """
    for variable in MESH_VARIABLES:
        if not variable.integer:
            require(
                np.isfinite(getattr(mesh, variable.name)),
                variable.dimensions[0][2:],
                f"{variable.file_name} is not a finite number",
            )
    for place, points in (
        ("cells", mesh.cell_points),
        ("edges", mesh.edge_points),
        ("vertices", mesh.vertex_points),
    ):
        require_on_sphere(points, mesh.sphere_radius, place)


def require_on_sphere(points: Array, radius: float, place: str) -> None:
    """Raise `MeshError` unless all points (n, 3) lie on the sphere of this radius."""
    distance = np.sqrt(dot(points, points))
    require(
        np.abs(distance / radius - 1.0) <= OUTSIDE_TOLERANCE,
        place,
        f"the coordinates are not at sphere_radius = {radius:g} from the origin",
    )


def check_orientation(points: Array, topology: Topology) -> None:
    """Check that triangles and rings run counter-clockwise for generators `points` (n_cells, 3), unit vectors.

    Raises `MeshError`.
    """

    def triangles_turn(cells: Index) -> NDArray[np.bool_]:
        a, b, c = (points[cells[:, k]] for k in range(3))
        turns: NDArray[np.bool_] = dot(a, np.cross(b - a, c - a)) > 0.0
        return turns

    def rings_turn(centers: Array, cells: Index, counts: Index) -> NDArray[np.bool_]:
        place = np.arange(cells.shape[1])
        inside = place < counts[:, None]
        following = np.take_along_axis(cells, (place + 1) % counts[:, None], axis=1)
        center = centers[:, None, :]
        spokes, following_spokes = (points[np.where(inside, ring, 0)] - center for ring in (cells, following))
        return (dot(center, np.cross(spokes, following_spokes)) > 0.0) | ~inside

    require(
        by_blocks(triangles_turn, topology.cells_on_vertex), "vertices", "cellsOnVertex does not run counter-clockwise"
    )
    require(
        by_blocks(rings_turn, points, topology.cells_on_cell, topology.n_edges_on_cell),
        "cells",
        "edgesOnCell does not run counter-clockwise",
    )


def _check_delaunay(mesh: VoronoiMesh) -> None:
    """Check that edges run along their tangents: the mesh is the Voronoi mesh of its cells."""
    points, vertices = mesh.cell_points / mesh.sphere_radius, mesh.vertex_points / mesh.sphere_radius

    def along_tangent(middles: Array, cells: Index, ends: Index) -> NDArray[np.bool_]:
        normal = points[cells[:, 1]] - points[cells[:, 0]]
        along = vertices[ends[:, 1]] - vertices[ends[:, 0]]
        # Vertices of cells on one circle coincide but for round-off, which a circumcentre magnifies.
        slack = OUTSIDE_TOLERANCE * dot(normal, normal)
        right: NDArray[np.bool_] = dot(along, np.cross(middles / mesh.sphere_radius, normal)) >= -slack
        return right

    require(
        by_blocks(along_tangent, mesh.edge_points, mesh.cells_on_edge, mesh.vertices_on_edge),
        "edges",
        "the vertices of the edge lie against its tangent: the triangles are not the Delaunay triangulation of the "
        "cells, or vertices are out of place; build the mesh anew from its generators",
    )

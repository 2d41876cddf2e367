"""What every valid mesh satisfies: consistent connectivity, metrics that belong to it, and the discrete identities.

Connectivity is checked exactly; metrics and identities yield residuals, relative to the local size, that must
stay below a tolerance. Errors name the first entities that offend, counted from 0.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, sum_by_index
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.errors import MeshError
from mesh.metrics import compute_metrics, edge_angles
from mesh.sphere import dot, normalize
from mesh.topology import FILL
from mesh.voronoi_mesh import Metrics, Topology, VoronoiMesh

OWN_TOLERANCE = 1e-11
"""Largest residual of meshes made here."""

OUTSIDE_TOLERANCE = 1e-6
"""Largest residual of files of others (their converters leave relative noise of 1e-7), and largest difference
between metrics and what the generators give: rounding of coordinates is magnified in a circumcentre."""

MINIMUM_RING = 3


def validate_mesh(mesh: VoronoiMesh, tolerance: float = OWN_TOLERANCE, fresh_metrics: bool = False) -> dict[str, float]:
    """Check everything; return the residuals of the discrete identities by name.

    `tolerance` bounds those residuals. With `fresh_metrics`, the caller has just computed the metrics from the
    generators, and they are not computed again to be compared. Raises `MeshError`, one sentence that names entities
    and values, at the first thing that fails.
    """
    validate_topology(mesh)
    _check_positions(mesh)
    _check_orientation(mesh)
    if not fresh_metrics:
        _check_metrics(mesh)
    residuals = identity_residuals(mesh)
    for name, residual in residuals.items():
        if not residual <= tolerance:
            raise MeshError(
                f"{name} holds only to {residual:.1e} instead of {tolerance:.0e}; "
                "the metrics do not belong together, recompute them from the generators"
            )
    return residuals


def validate_topology(mesh: VoronoiMesh) -> None:
    """Check shapes, index ranges, generators and that all connectivity arrays tell the same story.

    Raises `MeshError`.
    """
    _check_shapes(mesh)
    _check_finite(mesh)
    _check_ranges(mesh)
    _check_rings(mesh)
    _check_vertices(mesh)
    _check_edges_on_edge(mesh)


def _require(valid: NDArray[np.bool_], place: str, problem: str) -> None:
    """Raise `MeshError` unless all rows of `valid` hold; the sentence starts with the rows that do not."""
    rows = valid if valid.ndim == 1 else valid.all(axis=tuple(range(1, valid.ndim)))
    if rows.all():
        return
    wrong = np.flatnonzero(~rows)
    named = ", ".join(str(row) for row in wrong[:3]) + (f" and {len(wrong) - 3} more" if len(wrong) > 3 else "")
    raise MeshError(f"{place} {named} (counted from 0): {problem}")


def _check_shapes(mesh: VoronoiMesh) -> None:
    sizes = dimension_sizes(mesh)
    for variable in MESH_VARIABLES:
        expected = tuple(sizes[dimension] for dimension in variable.dimensions)
        shape = getattr(mesh, variable.name).shape
        if shape != expected:
            raise MeshError(f"{variable.file_name} has shape {shape} instead of {expected}")
    euler = mesh.n_cells - mesh.n_edges + mesh.n_vertices
    if euler != 2 or mesh.n_vertices != 2 * mesh.n_cells - 4:
        raise MeshError(
            f"{mesh.n_cells} cells, {mesh.n_edges} edges and {mesh.n_vertices} vertices do not close a sphere: "
            f"{mesh.n_cells} cells need {3 * mesh.n_cells - 6} edges and {2 * mesh.n_cells - 4} vertices"
        )


def _check_finite(mesh: VoronoiMesh) -> None:
    for variable in MESH_VARIABLES:
        if not variable.integer:
            _require(
                np.isfinite(getattr(mesh, variable.name)),
                variable.dimensions[0][2:],
                f"{variable.file_name} is not a finite number",
            )


def _check_ranges(mesh: VoronoiMesh) -> None:
    sizes = dimension_sizes(mesh)
    counts = {"max_edges": mesh.n_edges_on_cell, "max_edges_2": mesh.n_edges_on_edge}
    _require(
        (mesh.n_edges_on_cell >= MINIMUM_RING) & (mesh.n_edges_on_cell <= mesh.max_edges),
        "cells",
        f"nEdgesOnCell is not between {MINIMUM_RING} and {mesh.max_edges}",
    )
    _require(
        mesh.n_edges_on_edge == mesh.n_edges_on_cell[np.clip(mesh.cells_on_edge, 0, mesh.n_cells - 1)].sum(1) - 2,
        "edges",
        "nEdgesOnEdge is not the number of other edges of the two cells",
    )
    _require(mesh.boundary_vertex == 0, "vertices", "boundaryVertex is not 0, but a global mesh has no boundary")
    for variable in MESH_VARIABLES:
        if variable.of is None:
            continue
        values, size = getattr(mesh, variable.name), sizes[variable.of]
        width = variable.dimensions[1]
        used = np.ones(values.shape, dtype=bool)
        if width in counts:
            used = np.arange(values.shape[1]) < counts[width][:, None]
        valid = np.where(used, (values >= 0) & (values < size), values == FILL)
        _require(valid, variable.dimensions[0][2:], f"{variable.file_name} holds an index outside 1 to {size}")


def _check_rings(mesh: Topology) -> None:
    """Every cell's edges and neighbours agree with the cells of the edges, each edge in exactly two rings."""
    cell = np.arange(mesh.n_cells)[:, None]
    inside = mesh.on_ring
    ends = mesh.cells_on_edge[np.where(inside, mesh.edges_on_cell, 0)]
    own = (ends == cell[:, :, None]).sum(axis=2)
    _require((own == 1) | ~inside, "cells", "edgesOnCell lists an edge that cellsOnEdge gives to other cells")
    across = ends.sum(axis=2) - cell
    _require((across == mesh.cells_on_cell) | ~inside, "cells", "cellsOnCell is not the cell across edgesOnCell")
    uses = np.bincount(mesh.edges_on_cell[inside], minlength=mesh.n_edges)
    _require(uses == 2, "edges", "edgesOnCell does not list the edge in exactly two cells")
    _require(
        _in_both(mesh.vertices_on_edge, mesh.edges_on_cell, mesh.vertices_on_cell, inside, mesh.n_edges_on_cell),
        "cells",
        "verticesOnCell does not lie between one edge and the next in edgesOnCell",
    )


def _in_both(
    vertices_on_edge: NDArray, edges: NDArray, vertices: NDArray, inside: NDArray, counts: NDArray
) -> NDArray[np.bool_]:
    """Whether vertex j of each ring is an end of edges j and j + 1."""
    following = (np.arange(edges.shape[1]) + 1) % counts[:, None]
    after = np.take_along_axis(edges, following, axis=1)
    ends = [vertices_on_edge[np.where(inside, ring, 0)] for ring in (edges, after)]
    return np.logical_and(*((end == vertices[:, :, None]).any(axis=2) for end in ends)) | ~inside


def _check_vertices(mesh: Topology) -> None:
    """Every vertex's edges and cells agree with the cells and vertices of the edges."""
    vertex = np.arange(mesh.n_vertices)[:, None]
    ends = mesh.vertices_on_edge[mesh.edges_on_vertex]
    _require(
        (ends == vertex[:, :, None]).sum(axis=2) == 1,
        "vertices",
        "edgesOnVertex lists an edge that verticesOnEdge gives to other vertices",
    )
    uses = np.bincount(mesh.edges_on_vertex.ravel(), minlength=mesh.n_edges)
    _require(uses == 2, "edges", "edgesOnVertex does not list the edge at exactly two vertices")
    pairs = np.stack([np.roll(mesh.cells_on_vertex, 1, axis=1), mesh.cells_on_vertex], axis=2)
    _require(
        np.sort(pairs, axis=2) == np.sort(mesh.cells_on_edge[mesh.edges_on_vertex], axis=2),
        "vertices",
        "cellsOnVertex does not lie between one edge and the next in edgesOnVertex",
    )


def _check_edges_on_edge(mesh: Topology) -> None:
    """`edges_on_edge` goes round the first cell, then round the second, from the edge itself."""
    edge = np.arange(mesh.n_edges)
    size = mesh.n_edges_on_cell[mesh.cells_on_edge]
    for side in (0, 1):
        ring = mesh.edges_on_cell[mesh.cells_on_edge[:, side]]
        position = np.argmax(ring == edge[:, None], axis=1)
        offset = 0 if side == 0 else size[:, 0] - 1
        for step in range(1, mesh.max_edges):
            inside = step < size[:, side]
            expected = ring[edge, (position + step) % size[:, side]]
            found = mesh.edges_on_edge[edge, np.where(inside, offset + step - 1, 0)]
            _require(
                (found == expected) | ~inside,
                "edges",
                "edgesOnEdge does not go counter-clockwise round the first cell, then round the second",
            )


def _check_positions(mesh: VoronoiMesh) -> None:
    """Coordinates lie on the sphere of the stated radius."""
    for place, points in (
        ("cells", mesh.cell_points),
        ("edges", mesh.edge_points),
        ("vertices", mesh.vertex_points),
    ):
        distance = np.sqrt(dot(points, points))
        _require(
            np.abs(distance / mesh.sphere_radius - 1.0) <= OUTSIDE_TOLERANCE,
            place,
            f"the coordinates are not at sphere_radius = {mesh.sphere_radius:g} from the origin",
        )


def _check_orientation(mesh: VoronoiMesh) -> None:
    """Triangles and rings run counter-clockwise, tangents along k x n: the mesh is the Voronoi mesh of its cells."""
    points = mesh.cell_points / mesh.sphere_radius
    a, b, c = (points[mesh.cells_on_vertex[:, k]] for k in range(3))
    _require(dot(a, np.cross(b - a, c - a)) > 0.0, "vertices", "cellsOnVertex does not run counter-clockwise")
    normal = points[mesh.cells_on_edge[:, 1]] - points[mesh.cells_on_edge[:, 0]]
    vertices = mesh.vertex_points / mesh.sphere_radius
    along = vertices[mesh.vertices_on_edge[:, 1]] - vertices[mesh.vertices_on_edge[:, 0]]
    tangent = np.cross(mesh.edge_points / mesh.sphere_radius, normal)
    # Vertices of cells on one circle coincide but for round-off, which a circumcentre magnifies.
    slack = OUTSIDE_TOLERANCE * dot(normal, normal)
    _require(
        dot(along, tangent) >= -slack,
        "edges",
        "verticesOnEdge does not run along the tangent, 90 degrees left of the normal given by cellsOnEdge "
        "(or the mesh is not Delaunay)",
    )
    inside = mesh.on_ring
    following = np.take_along_axis(
        mesh.cells_on_cell, (np.arange(mesh.max_edges) + 1) % mesh.n_edges_on_cell[:, None], axis=1
    )
    center = points[:, None, :]
    spokes = points[np.where(inside, mesh.cells_on_cell, 0)] - center
    following_spokes = points[np.where(inside, following, 0)] - center
    turns = dot(center, np.cross(spokes, following_spokes))
    _require((turns > 0.0) | ~inside, "cells", "edgesOnCell does not run counter-clockwise")


def _check_metrics(mesh: VoronoiMesh) -> None:
    """The metrics of `mesh` are those of its generators, up to `OUTSIDE_TOLERANCE` of the local size.

    The local size of a vertex is its distance to the cells; that of an edge is the largest of its own and its
    vertices'.
    """
    radius = mesh.sphere_radius
    points = normalize(mesh.cell_points)
    exact = compute_metrics(points, mesh)
    normal = points[mesh.cells_on_edge[:, 1]] - points[mesh.cells_on_edge[:, 0]]
    vertex = np.stack([exact.x_vertex, exact.y_vertex, exact.z_vertex], axis=1)
    spoke = vertex - points[mesh.cells_on_vertex[:, 0]]
    size = {"vertex": np.sqrt(dot(spoke, spoke)), "cell": np.sqrt(exact.area_cell)}
    size["edge"] = np.maximum(exact.dc_edge, size["vertex"][mesh.vertices_on_edge].max(axis=1))
    differences = {
        "xEdge, yEdge or zEdge": ("edge", _distances(mesh, exact, "edge") / size["edge"]),
        "xVertex, yVertex or zVertex": ("vertex", _distances(mesh, exact, "vertex") / size["vertex"]),
        "dcEdge": ("edge", (mesh.dc_edge / radius - exact.dc_edge) / exact.dc_edge),
        "dvEdge": ("edge", (mesh.dv_edge / radius - exact.dv_edge) / size["edge"]),
        "areaCell": ("cell", mesh.area_cell / radius**2 / exact.area_cell - 1.0),
        "areaTriangle": ("vertex", mesh.area_triangle / radius**2 / exact.area_triangle - 1.0),
        "kiteAreasOnVertex": (
            "vertex",
            (mesh.kite_areas_on_vertex / radius**2 - exact.kite_areas_on_vertex) / size["vertex"][:, None] ** 2,
        ),
        "weightsOnEdge": (
            "edge",
            (mesh.weights_on_edge - exact.weights_on_edge) * (exact.dc_edge / size["edge"])[:, None],
        ),
        # At a pole the longitude is arbitrary, and the angle counts from the east that it defines.
        "angleEdge": ("edge", _angle_difference(mesh.angle_edge, edge_angles(normal, mesh.lon_edge, mesh.lat_edge))),
    }
    for place in ("cell", "edge", "vertex"):
        latitude = getattr(exact, f"lat_{place}")
        differences[f"lat{place.capitalize()}"] = (
            place,
            (getattr(mesh, f"lat_{place}") - latitude) / size[place],
        )
        turn = _angle_difference(getattr(mesh, f"lon_{place}"), getattr(exact, f"lon_{place}"))
        differences[f"lon{place.capitalize()}"] = (place, turn * np.cos(latitude) / size[place])
    for name, (place, difference) in differences.items():
        _require(
            np.abs(difference) <= OUTSIDE_TOLERANCE,
            "vertices" if place == "vertex" else f"{place}s",
            f"{name} differs from what the generators give by up to {np.abs(difference).max():.1e} of the local size; "
            "recompute the metrics or mend the file",
        )


def _distances(mesh: VoronoiMesh, exact: Metrics, place: str) -> Array:
    """How far the points of one kind of entity lie from where they belong, on the unit sphere."""
    return np.sqrt(
        sum(
            (getattr(mesh, f"{axis}_{place}") / mesh.sphere_radius - getattr(exact, f"{axis}_{place}")) ** 2
            for axis in "xyz"
        )
    )


def _angle_difference(a: Array, b: Array) -> Array:
    """Difference of angles, in [-pi, pi]."""
    return (a - b + np.pi) % (2.0 * np.pi) - np.pi


def identity_residuals(mesh: VoronoiMesh) -> dict[str, float]:
    """Residuals of the discrete identities of Thuburn et al. (2009) and Ringler et al. (2010)."""
    sphere = 4.0 * np.pi * mesh.sphere_radius**2
    kites = mesh.kite_areas_on_vertex
    cell_sums = sum_by_index(mesh.cells_on_vertex, kites, mesh.n_cells)
    return {
        "sum of areaCell = area of the sphere": abs(mesh.area_cell.sum() / sphere - 1.0),
        "sum of areaTriangle = area of the sphere": abs(mesh.area_triangle.sum() / sphere - 1.0),
        "sum of kites = areaCell": float(np.abs(cell_sums / mesh.area_cell - 1.0).max()),
        "sum of kites = areaTriangle": float(np.abs(kites.sum(axis=1) / mesh.area_triangle - 1.0).max()),
        "antisymmetry of weightsOnEdge": _weight_asymmetry(mesh),
        "divergence of the tangential flux on triangles": _perp_inconsistency(mesh),
        "curl of a gradient = 0": _curl_of_gradient(mesh),
        "divergence and gradient are adjoint": _adjoint_defect(mesh),
    }


def _weight_asymmetry(mesh: VoronoiMesh) -> float:
    """Largest |w_ee' + w_e'e| l_e l_e' / (d_e d_e'), with w_ee' = weights_on_edge d_e / l_e'."""
    return float(
        _largest_asymmetry(mesh.n_edges_on_edge, mesh.edges_on_edge, mesh.weights_on_edge, mesh.dv_edge, mesh.dc_edge)
    )


@numba.njit(cache=True, parallel=True)
def _largest_asymmetry(
    n_edges_on_edge: Index, edges_on_edge: Index, weights: Array, dv_edge: Array, dc_edge: Array
) -> float:
    worst = 0.0
    for e in numba.prange(len(n_edges_on_edge)):
        for k in range(n_edges_on_edge[e]):
            other = edges_on_edge[e, k]
            back = 0.0
            for m in range(n_edges_on_edge[other]):
                if edges_on_edge[other, m] == e:
                    back += weights[other, m]
            defect = weights[e, k] * dv_edge[e] / dc_edge[other] + back * dv_edge[other] / dc_edge[e]
            worst = max(worst, abs(defect))
    return worst


def _perp_inconsistency(mesh: VoronoiMesh) -> float:
    """The divergence of the tangential flux on each triangle is the kite-weighted mean of that on its cells.

    Thuburn et al. (2009), equation (20), tried on one random flux; relative to the size of its terms.
    """
    flux = np.random.default_rng(0).uniform(-1.0, 1.0, mesh.n_edges)
    used = mesh.edges_on_edge != FILL
    tangential = np.where(used, mesh.weights_on_edge * flux[mesh.edges_on_edge], 0.0).sum(axis=1)
    outward = np.where(mesh.vertices_on_edge[mesh.edges_on_vertex, 1] == np.arange(mesh.n_vertices)[:, None], 1.0, -1.0)
    # Along the tangent, k x n, a flux leaves the tail's triangle; n turned by k x gives minus the normal.
    on_triangles = (outward * (tangential * mesh.dc_edge)[mesh.edges_on_vertex]).sum(axis=1)
    divergence = _sum_to_cells(mesh, flux * mesh.dv_edge) / mesh.area_cell
    expected = (mesh.kite_areas_on_vertex * divergence[mesh.cells_on_vertex]).sum(axis=1)
    scale = mesh.dc_edge[mesh.edges_on_vertex].sum(axis=1)
    return float((np.abs(on_triangles + expected) / scale).max())


def _sum_to_cells(mesh: Topology, outflow: Array) -> Array:
    """Net outflow of each cell (n_cells,) of a flow along the normals (n_edges,)."""
    first, second = mesh.cells_on_edge.T
    return sum_by_index(first, outflow, mesh.n_cells) - sum_by_index(second, outflow, mesh.n_cells)


def _curl_of_gradient(mesh: Topology) -> float:
    """Circulation of the differences of a random whole-numbered field: exactly zero."""
    field = np.random.default_rng(1).integers(-1000, 1000, mesh.n_cells).astype(float)
    difference = field[mesh.cells_on_edge[:, 1]] - field[mesh.cells_on_edge[:, 0]]
    tail, head = mesh.vertices_on_edge.T
    circulation = sum_by_index(head, difference, mesh.n_vertices) - sum_by_index(tail, difference, mesh.n_vertices)
    return float(np.abs(circulation).max())


def _adjoint_defect(mesh: VoronoiMesh) -> float:
    """sum_i h_i A_i (div F)_i + sum_e l_e d_e F_e (grad h)_e for random h and F, relative to the sum of its terms."""
    generator = np.random.default_rng(2)
    h, flux = generator.uniform(-1.0, 1.0, mesh.n_cells), generator.uniform(-1.0, 1.0, mesh.n_edges)
    inside = mesh.on_ring
    edges = np.where(inside, mesh.edges_on_cell, 0)
    sign = np.where(mesh.cells_on_edge[edges, 0] == np.arange(mesh.n_cells)[:, None], 1.0, -1.0)
    outflow = np.where(inside, sign * (flux * mesh.dv_edge)[edges], 0.0).sum(axis=1)
    gradient = h[mesh.cells_on_edge[:, 1]] - h[mesh.cells_on_edge[:, 0]]
    terms = mesh.dv_edge * flux * gradient
    return float(abs(h @ outflow + terms.sum()) / np.abs(terms).sum())

"""The discrete identities that the metrics of a mesh satisfy, as residuals relative to the local size."""

import numba
import numpy as np

from mesh.arrays import Array, Index, sum_by_index
from mesh.discrete.topology import FILL
from mesh.voronoi_mesh import Topology, VoronoiMesh


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

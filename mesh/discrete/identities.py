"""The discrete identities that the metrics of a mesh satisfy, as residuals relative to the local size."""

import numba
import numpy as np

from mesh.arrays import Array, Index, sum_by_index
from mesh.discrete.operators import Operators, build_operators
from mesh.voronoi_mesh import VoronoiMesh


def identity_residuals(mesh: VoronoiMesh) -> dict[str, float]:
    """Residuals of the discrete identities of Thuburn et al. (2009) and Ringler et al. (2010)."""
    sphere = 4.0 * np.pi * mesh.sphere_radius**2
    kites = mesh.kite_areas_on_vertex
    operators = build_operators(mesh)
    cell_sums = sum_by_index(mesh.cells_on_vertex, kites, mesh.n_cells)
    return {
        "sum of areaCell = area of the sphere": abs(mesh.area_cell.sum() / sphere - 1.0),
        "sum of areaTriangle = area of the sphere": abs(mesh.area_triangle.sum() / sphere - 1.0),
        "sum of kites = areaCell": float(np.abs(cell_sums / mesh.area_cell - 1.0).max()),
        "sum of kites = areaTriangle": float(np.abs(kites.sum(axis=1) / mesh.area_triangle - 1.0).max()),
        "antisymmetry of weightsOnEdge": _weight_asymmetry(mesh),
        "divergence of the tangential flux on triangles": _perp_inconsistency(mesh, operators),
        "curl of a gradient = 0": _curl_of_gradient(mesh, operators),
        "divergence and gradient are adjoint": _adjoint_defect(mesh, operators),
    }


def _weight_asymmetry(mesh: VoronoiMesh) -> float:
    """Largest |w_ee' + w_e'e| l_e l_e' / (d_e d_e'), with w_ee' = weights_on_edge d_e / l_e'."""
    return float(
        _largest_asymmetry(mesh.n_edges_on_edge, mesh.edges_on_edge, mesh.weights_on_edge, mesh.dv_edge, mesh.dc_edge)
    )


@numba.njit(cache=True, parallel=True, fastmath=False)
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


def _perp_inconsistency(mesh: VoronoiMesh, operators: Operators) -> float:
    """The divergence of the tangential flux on each triangle is the kite-weighted mean of that on its cells.

    Thuburn et al. (2009), equation (20), tried on one random flux; relative to the size of its terms. The divergence on
    a triangle is minus the curl of the flux turned by k x.
    """
    flux = np.random.default_rng(0).uniform(-1.0, 1.0, mesh.n_edges)
    difference = operators.curl @ (operators.perp @ flux) + operators.cell_to_vertex @ (operators.divergence @ flux)
    scale = mesh.dc_edge[mesh.edges_on_vertex].sum(axis=1)
    return float((np.abs(mesh.area_triangle * difference) / scale).max())


def _curl_of_gradient(mesh: VoronoiMesh, operators: Operators) -> float:
    """Largest circulation of the gradient of a random field, relative to the differences of the field."""
    field = np.random.default_rng(1).uniform(-1.0, 1.0, mesh.n_cells)
    return float(np.abs(mesh.area_triangle * (operators.curl @ (operators.gradient @ field))).max())


def _adjoint_defect(mesh: VoronoiMesh, operators: Operators) -> float:
    """sum_i h_i A_i (div F)_i + sum_e l_e d_e F_e (grad h)_e for random h and F, relative to the sum of its terms."""
    generator = np.random.default_rng(2)
    h, flux = generator.uniform(-1.0, 1.0, mesh.n_cells), generator.uniform(-1.0, 1.0, mesh.n_edges)
    at_cells = h @ (mesh.area_cell * (operators.divergence @ flux))
    terms = mesh.dv_edge * mesh.dc_edge * flux * (operators.gradient @ h)
    return float(abs(at_cells + terms.sum()) / np.abs(terms).sum())

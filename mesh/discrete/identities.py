"""The discrete identities that the metrics of a mesh satisfy, as residuals relative to the local size.

The operators are loops over the arrays of the mesh: the matrices of `mesh.discrete.operators`, which say the same, take
as much memory as the mesh. With walls, the identities hold for flows that vanish there, at vertices away from them; the
area of the sphere is that of its cells.
"""

from functools import partial

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks, row_loop, sum_by_index
from mesh.discrete.walls import boundary_vertices, closed_mesh, has_walls, wall_edges
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh

NONE: Index = np.zeros(0, np.intp)


def identity_residuals(mesh: VoronoiMesh) -> dict[str, float]:
    """Residuals of the discrete identities of Thuburn et al. (2009) and Ringler et al. (2010)."""
    if has_walls(mesh):
        return _residuals_of_sea(mesh)
    surface = surface_of(mesh)
    whole = surface.area * mesh.length_unit**2
    return {
        f"sum of areaCell = area of the {surface.name}": abs(mesh.area_cell.sum() / whole - 1.0),
        f"sum of areaTriangle = area of the {surface.name}": abs(mesh.area_triangle.sum() / whole - 1.0),
        **_residuals_within(mesh),
    }


def _residuals_of_sea(mesh: VoronoiMesh) -> dict[str, float]:
    """The residuals of a mesh with walls."""
    return {
        "sum of areaTriangle = sum of areaCell": abs(mesh.area_triangle.sum() / mesh.area_cell.sum() - 1.0),
        **_residuals_within(closed_mesh(mesh), ~boundary_vertices(mesh), wall_edges(mesh)),
    }


def _residuals_within(
    mesh: VoronoiMesh, inner: NDArray[np.bool_] | bool = True, walls: Index = NONE
) -> dict[str, float]:
    """Residuals of what holds in every part of a closed mesh with `inner` vertices (n_vertices,) and `walls` (n,)."""
    kites = mesh.kite_areas_on_vertex
    cell_sums = sum_by_index(mesh.cells_on_vertex, kites, mesh.n_cells)
    return {
        "sum of kites = areaCell": float(np.abs(cell_sums / mesh.area_cell - 1.0).max()),
        "sum of kites = areaTriangle": float(np.abs(kites.sum(axis=1) / mesh.area_triangle - 1.0).max()),
        "antisymmetry of weightsOnEdge": _weight_asymmetry(mesh),
        "divergence of the tangential flux on triangles": _perp_inconsistency(mesh, inner, walls),
        "curl of a gradient = 0": _curl_of_gradient(mesh, inner),
        "divergence and gradient are adjoint": _adjoint_defect(mesh, walls),
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


def _perp_inconsistency(mesh: VoronoiMesh, inner: NDArray[np.bool_] | bool = True, walls: Index = NONE) -> float:
    """The divergence of the tangential flux on each triangle is the kite-weighted mean of that on its cells.

    Thuburn et al. (2009), equation (20), tried on one random flux; relative to the size of its terms. The divergence on
    a triangle is minus the curl of the flux turned by k x.
    """
    flux = np.random.default_rng(0).uniform(-1.0, 1.0, mesh.n_edges)
    flux[walls] = 0.0
    turned = by_blocks(partial(_tangential, flux), mesh.n_edges_on_edge, mesh.edges_on_edge, mesh.weights_on_edge)
    difference = _circulations(mesh, turned)
    divergence = _outflows(mesh, flux) / mesh.area_cell
    difference += by_blocks(
        lambda kites, cells: (kites * divergence[cells]).sum(axis=1), mesh.kite_areas_on_vertex, mesh.cells_on_vertex
    )
    scale = by_blocks(lambda edges: mesh.dc_edge[edges].sum(axis=1), mesh.edges_on_vertex)
    return float((np.abs(difference) / scale).max(initial=0.0, where=inner))


def _curl_of_gradient(mesh: VoronoiMesh, inner: NDArray[np.bool_] | bool = True) -> float:
    """Largest circulation of the gradient of a random field, relative to the differences of the field."""
    field = np.random.default_rng(1).uniform(-1.0, 1.0, mesh.n_cells)
    return float(np.abs(_circulations(mesh, _gradient(mesh, field))).max(initial=0.0, where=inner))


def _adjoint_defect(mesh: VoronoiMesh, walls: Index = NONE) -> float:
    """sum_i h_i A_i (div F)_i + sum_e l_e d_e F_e (grad h)_e for random h and F, relative to the sum of its terms."""
    generator = np.random.default_rng(2)
    h, flux = generator.uniform(-1.0, 1.0, mesh.n_cells), generator.uniform(-1.0, 1.0, mesh.n_edges)
    flux[walls] = 0.0
    at_cells = h @ _outflows(mesh, flux)
    terms = by_blocks(
        lambda l_e, d_e, f_e, gradient: l_e * d_e * f_e * gradient,
        *(mesh.dv_edge, mesh.dc_edge, flux, _gradient(mesh, h)),
    )
    size = np.abs(terms).sum()
    return float(abs(at_cells + terms.sum()) / size) if size else 0.0  # of one cell alone there is nothing to add


def _gradient(mesh: VoronoiMesh, field: Array) -> Array:
    """Gradients (n_edges,) along the normals, Ringler et al. (2010), equation (22), of values at cells."""
    return by_blocks(
        lambda cells, d_e: (field[cells[:, 1]] - field[cells[:, 0]]) / d_e, mesh.cells_on_edge, mesh.dc_edge
    )


def _outflows(mesh: VoronoiMesh, flux: Array) -> Array:
    """Flux (n_cells,) out of each cell: the divergence of equation (21) times the area."""
    cells = np.arange(mesh.n_cells), mesh.n_edges_on_cell, mesh.edges_on_cell
    return by_blocks(partial(_outflow, mesh.cells_on_edge, mesh.dv_edge, flux), *cells)


def _circulations(mesh: VoronoiMesh, velocity: Array) -> Array:
    """Circulations (n_vertices,) round each triangle: the curl of equation (23) times the area."""
    vertices = np.arange(mesh.n_vertices), mesh.edges_on_vertex
    return by_blocks(partial(_circulation, mesh.vertices_on_edge, mesh.dc_edge, velocity), *vertices)


@row_loop
def _tangential(flux: Array, counts: Index, edges: Index, weights: Array) -> Array:
    """Sums (n,) of the weights (n, 2 max_edges) times the flux at the edges of each row, equation (24)."""
    sums = np.zeros(len(counts))
    for row in range(len(counts)):
        for place in range(counts[row]):
            sums[row] += weights[row, place] * flux[edges[row, place]]
    return sums


@row_loop
def _outflow(
    cells_on_edge: Index, dv_edge: Array, flux: Array, cells: Index, counts: Index, edges_on_cell: Index
) -> Array:
    sums = np.zeros(len(cells))
    for row in range(len(cells)):
        for place in range(counts[row]):
            edge = edges_on_cell[row, place]
            outward = dv_edge[edge] * flux[edge]
            sums[row] += outward if cells_on_edge[edge, 0] == cells[row] else -outward
    return sums


@row_loop
def _circulation(
    vertices_on_edge: Index, dc_edge: Array, velocity: Array, vertices: Index, edges_on_vertex: Index
) -> Array:
    sums = np.zeros(len(vertices))
    for row in range(len(vertices)):
        for corner in range(3):
            edge = edges_on_vertex[row, corner]
            along = dc_edge[edge] * velocity[edge]
            sums[row] += along if vertices_on_edge[edge, 1] == vertices[row] else -along
    return sums

"""The mesh of some cells of another, in the conventions of the MPAS mesh culler, for files that others read.

Beyond `mesh.parts.cutting.without_cells`, an edge with one cell has that cell first, so that its normal leaves the
mesh, and vertices at which a cell is missing are marked. What is missing stays -1 in its place round a vertex.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.discrete.walls import boundary_vertices
from mesh.errors import MeshError
from mesh.geometry.angles import about_zero
from mesh.parts.cutting import without_cells
from mesh.validated import is_validated, remember_validated
from mesh.voronoi_mesh import VoronoiMesh


def culled(mesh: VoronoiMesh, kept: NDArray[np.bool_]) -> VoronoiMesh:
    """The mesh of the cells that `kept` (n_cells,) marks, with the edges and vertices that touch them, in their order.

    Cells, kites and weights that stay are those of `mesh`, but for the sign of weights at an edge whose normal is
    turned; `area_triangle` is the sum of the kites that stay. Raises `MeshError` where `kept` has another shape or
    marks no cell.
    """
    if kept.shape != (mesh.n_cells,):
        raise MeshError(f"the marks of the cells to keep have shape {kept.shape}, but the mesh needs ({mesh.n_cells},)")
    if not kept.any():
        raise MeshError(f"none of the {mesh.n_cells} cells is kept; choose a region that holds the centre of a cell")
    part = _with_cells_first(_narrowed(without_cells(mesh, ~kept)))
    result = replace(part, boundary_vertex=boundary_vertices(part).astype(np.int32))
    if is_validated(mesh):
        remember_validated(result)
    return result


def _narrowed(part: VoronoiMesh) -> VoronoiMesh:
    """`part` with room for the edges of its widest cell alone."""
    width = int(part.n_edges_on_cell.max())
    widths = {
        **dict.fromkeys(("cells_on_cell", "edges_on_cell", "vertices_on_cell"), width),
        **dict.fromkeys(("edges_on_edge", "weights_on_edge"), 2 * width),
    }
    rings = {name: np.ascontiguousarray(getattr(part, name)[:, :room]) for name, room in widths.items()}
    return replace(part, **rings)  # type: ignore[arg-type]


def _with_cells_first(part: VoronoiMesh) -> VoronoiMesh:
    """`part` with the edges turned round whose first cell is missing: their normals, and so their tangents too."""
    turned = part.cells_on_edge[:, 0] < 0
    return replace(
        part,
        cells_on_edge=_swapped(part.cells_on_edge, turned),
        vertices_on_edge=_swapped(part.vertices_on_edge, turned),
        angle_edge=np.where(turned, about_zero(part.angle_edge + np.pi), part.angle_edge),
        weights_on_edge=_turned_weights(part, turned),
    )


def _swapped(pairs: Index, turned: NDArray[np.bool_]) -> Index:
    """The pairs (n, 2), those that are `turned` (n,) with the second first."""
    return np.where(turned[:, None], pairs[:, ::-1], pairs)


def _turned_weights(part: VoronoiMesh, turned: NDArray[np.bool_]) -> Array:
    """Weights (n_edges, 2 max_edges): a turned edge changes the sign of its tangent, and of what others take of it."""
    used = np.arange(part.edges_on_edge.shape[1]) < part.n_edges_on_edge[:, None]
    changes = used & (turned[:, None] ^ turned[part.edges_on_edge])
    return np.where(changes, -part.weights_on_edge, part.weights_on_edge)

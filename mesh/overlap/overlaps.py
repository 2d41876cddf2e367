"""Areas and first moments of what the cells of two meshes have in common, and means over the cells of the second.

A field that is linear in each cell of the first mesh, with the cell's value as its mean, has the mean

    sum over s of (A_ts v_s + g_s.(M_ts - A_ts M_s / A_s)) / sum over s of A_ts

over cell t of the second: A_ts is the area and M_ts the integral of the position over what t and s have in common, A_s
and M_s are those of s, and g_s is the gradient. As areas and moments add up, the integral over all is kept to round-off
where both meshes cover the same, which first-order means (g = 0) do as well; a smooth field is carried over to second
order.
"""

from dataclasses import dataclass

import numba
import numpy as np
from scipy.spatial import cKDTree

from mesh.arrays import Array, Index, sum_by_index
from mesh.geometry.sphere import dot, normalize
from mesh.overlap.polygons import area_and_moment, areas_and_moments, common_polygon, corners_of
from mesh.voronoi_mesh import VoronoiMesh

FIRST_ROOM = 64
"""Cells of one mesh that a cell of the other meets before its lists grow."""


@dataclass(frozen=True, eq=False)
class Overlaps:
    """What cells of a `source` and a target mesh have in common, on the unit sphere, row by row of the target's.

    Row t is `starts[t]` to `starts[t + 1]` of `sources` (n,), of the areas `areas` (n,), steradians, and moments
    `moments` (n, 3). `nearest` (n_targets,) is the source cell with the nearest centre, whose value is taken where a
    target meets none. `source_areas` (n_sources,) and `source_moments` (n_sources, 3) are those of whole cells.
    """

    source: VoronoiMesh
    starts: Index
    sources: Index
    areas: Array
    moments: Array
    nearest: Index
    source_areas: Array
    source_moments: Array

    @property
    def targets(self) -> Index:
        """The target cell of each entry (n,)."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))

    @property
    def covered(self) -> Array:
        """Area of each target cell (n_targets,) that lies in source cells, steradians."""
        return self._sums(self.areas)

    def means(self, values: Array) -> Array:
        """Means (n_targets,) over what is covered of each target cell, of a field with the means `values` (n_sources,).

        Where nothing is covered, the nearest value.
        """
        centroids = self.source_moments / self.source_areas[:, None]
        slopes = gradients(self.source, centroids, values)
        away = self.moments - self.areas[:, None] * centroids[self.sources]
        integrals = self._sums(self.areas * values[self.sources] + dot(slopes[self.sources], away))
        covered = self.covered
        return np.where(covered > 0.0, integrals / np.where(covered > 0.0, covered, 1.0), values[self.nearest])

    def _sums(self, entries: Array) -> Array:
        return sum_by_index(self.targets, entries, len(self.starts) - 1)


def gradients(mesh: VoronoiMesh, centroids: Array, values: Array) -> Array:
    """Gradients (n_cells, 3), per unit of the unit sphere, fitted to differences from the neighbours of each cell.

    `centroids` (n_cells, 3) is where the `values` (n_cells,) are taken to hold. Zero where neighbours do not tell both
    components.
    """
    there = mesh.on_ring & (mesh.cells_on_cell >= 0)
    neighbours = np.where(there, mesh.cells_on_cell, 0)
    up = normalize(centroids)
    ways = (centroids[neighbours] - centroids[:, None, :]) * there[..., None]
    ways -= dot(ways, up[:, None, :])[..., None] * up[:, None, :]
    differences = (values[neighbours] - values[:, None]) * there
    matrix = np.einsum("cki,ckj->cij", ways, ways)
    size = np.trace(matrix, axis1=1, axis2=2)
    matrix += size[:, None, None] * up[:, :, None] * up[:, None, :]
    told = np.linalg.det(matrix) > 1e-6 * size**3
    matrix[~told] = np.eye(3)
    slopes = np.linalg.solve(matrix, np.einsum("cki,ck->ci", ways, differences)[..., None])[..., 0]
    return np.where(told[:, None], slopes, 0.0)


def overlaps_of(source: VoronoiMesh, target: VoronoiMesh) -> Overlaps:
    """What the cells of two meshes have in common; both may be of any radius, with or without walls."""
    for mesh in (source, target):
        mesh.require_sphere("cells of two meshes are overlaid")
    centers, points = normalize(source.cell_points), normalize(target.cell_points)
    corners, vertices = normalize(source.vertex_points), normalize(target.vertex_points)
    tree = cKDTree(centers)
    near_cell, near_vertex = (tree.query(each)[1].astype(np.int32) for each in (points, vertices))
    search = (
        (corners, source.vertices_on_cell, source.n_edges_on_cell, source.cells_on_cell),
        (vertices, target.vertices_on_cell, target.n_edges_on_cell),
        near_cell,
        near_vertex,
    )
    nothing = np.empty(0, np.int32), np.empty(0), np.empty((0, 3))
    counts = np.zeros(target.n_cells + 1, np.int64)
    _search(*search, counts, False, *nothing)
    starts = np.cumsum(counts)
    found = np.empty(starts[-1], np.int32), np.empty(starts[-1]), np.empty((starts[-1], 3))
    _search(*search, starts, True, *found)
    areas, moments = areas_and_moments(corners, source.vertices_on_cell, source.n_edges_on_cell)
    return Overlaps(source, starts, *found, near_cell, areas, moments)


Cells = tuple[Array, Index, Index, Index]
Targets = tuple[Array, Index, Index]


@numba.njit(cache=True, parallel=True, fastmath=False)
def _search(
    source: Cells,
    target: Targets,
    near_cell: Index,
    near_vertex: Index,
    starts: Index,
    write: bool,
    sources: Index,
    areas: Array,
    moments: Array,
) -> None:
    """Count the source cells that each target meets in starts[t + 1], or write them from starts[t] on."""
    for cell in numba.prange(len(near_cell)):
        numbers, sizes = _met_by(cell, source, target, near_cell, near_vertex)
        if not write:
            starts[cell + 1] = len(numbers)
            continue
        first = starts[cell]
        for place in range(len(numbers)):
            sources[first + place] = numbers[place]
            areas[first + place] = sizes[place, 0]
            for axis in range(3):
                moments[first + place, axis] = sizes[place, 1 + axis]


@numba.njit(cache=True, fastmath=False)
def _met_by(cell: int, source: Cells, target: Targets, near_cell: Index, near_vertex: Index) -> tuple[Index, Array]:
    """Source cells that a target cell meets (n,), and area and moment (n, 4) of what they have in common.

    The search goes from those nearest to its centre and corners on to neighbours of those that it meets: without
    walls, what meets a convex cell hangs together.
    """
    corners, rings, counts, neighbours = source
    vertices, target_rings, target_counts = target
    own = target_rings[cell, : target_counts[cell]]
    polygon = np.empty((len(own) + rings.shape[1], 3))
    buffer = np.empty_like(polygon)
    queue: Index = np.empty(FIRST_ROOM, np.int32)
    queue[0] = near_cell[cell]
    waiting = 1
    for vertex in own:
        queue, waiting = _joined(queue, waiting, near_vertex[vertex])
    met: Index = np.empty(FIRST_ROOM, np.int32)
    sizes, found, place = np.empty((FIRST_ROOM, 4)), 0, 0
    while place < waiting:
        other = queue[place]
        place += 1
        size = corners_of(vertices, own, polygon)
        size = common_polygon(polygon, size, corners, rings[other, : counts[other]], buffer)
        if size == 0:
            continue
        if found == len(met):
            met, sizes = np.concatenate((met, np.empty_like(met))), np.concatenate((sizes, np.empty_like(sizes)))
        met[found] = other
        sizes[found, 0], sizes[found, 1], sizes[found, 2], sizes[found, 3] = area_and_moment(polygon, size)
        found += 1
        for k in range(counts[other]):
            if neighbours[other, k] >= 0:
                queue, waiting = _joined(queue, waiting, neighbours[other, k])
    return met[:found], sizes[:found]


@numba.njit(cache=True)
def _joined(queue: Index, waiting: int, number: int) -> tuple[Index, int]:
    """A queue with a number at its end, unless it was ever in it, and its length."""
    for place in range(waiting):
        if queue[place] == number:
            return queue, waiting
    if waiting == len(queue):
        queue = np.concatenate((queue, np.empty_like(queue)))
    queue[waiting] = number
    return queue, waiting + 1

"""How good a mesh is: distances between neighbours, shapes of triangles, centroid residual, areas."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, by_blocks
from mesh.density.named import Density, uniform
from mesh.density.record import density_of
from mesh.discrete.walls import boundary_vertices, has_walls, wall_edges
from mesh.geometry.sphere import arc_length, dot, normalize
from mesh.geometry.surface import surface_of
from mesh.integrals.moments import masses_and_moments
from mesh.integrals.plane_centroids import plane_centroids
from mesh.integrals.weighted_moments import WeightedCells, centroid_distances
from mesh.shown import Rows, Shown
from mesh.triangulation.moving import Triangulation
from mesh.voronoi_mesh import VoronoiMesh

STRAIGHT = 1e-9
"""Part of the area of a cell that a wall may take away or add and count as straight."""

ROUND_OFF = 10.0
"""Times the round-off of the largest coordinate, over the root of an area, by which that area may be wrong."""


@dataclass(frozen=True, repr=False)
class Quality(Shown):
    """The measures of Ju, Ringler and Gunzburger (2011), section 4, and some more.

    `mu` is the largest over the smallest distance between neighbours; `sigma` of a cell its shortest over its
    longest distance to a neighbour; `q` of a triangle with sides a, b, c is (b+c-a)(c+a-b)(a+b-c)/(abc), one if
    equilateral. Distances are chords. `residual` is the largest distance between a generator that was free to move and
    the constrained centroid of its cell, in mean spacings, and not a number where the density cannot be known; cells
    with a bent wall do not count (`bent_cells`), as a mesh does not tell where that runs. `obtuse` counts Delaunay
    triangles with an obtuse angle; `area_ratio` is the largest over the smallest cell area.
    Beside walls only neighbours and triangles that are there count, and cells as they are; what nothing counts for is
    not a number.
    """

    cells: int
    mu: float
    sigma_avg: float
    sigma_min: float
    q_avg: float
    q_min: float
    residual: float
    obtuse: int
    area_ratio: float

    def _title_and_rows(self) -> tuple[str, Rows]:
        return f"Quality of a mesh of {self.cells} cells", {
            "mu": f"{self.mu:.4f}, largest over smallest distance between neighbours",
            "sigma": f"mean {self.sigma_avg:.4f}, least {self.sigma_min:.4f}, shortest over longest distance of a cell",
            "q": f"mean {self.q_avg:.4f}, least {self.q_min:.4f}, of triangles; 1 if equilateral",
            "residual": f"{self.residual:.3g} mean spacings from a generator to its centroid, at most",
            "obtuse": f"{self.obtuse} triangles",
            "area_ratio": f"{self.area_ratio:.4f}, largest over smallest cell",
        }


def mesh_quality(mesh: VoronoiMesh, density: Density | None = None) -> Quality:
    """Measure `mesh`; see `Quality`.

    The residual is for the `density`, by default that of which the mesh tells (see `mesh.density.record`).
    """
    return quality_and_note(mesh, density)[0]


def quality_and_note(mesh: VoronoiMesh, density: Density | None = None) -> tuple[Quality, str]:
    """The result of `mesh_quality`, and a note on how to read the residual; empty if there is nothing to add."""
    density, note = density_of(mesh) if density is None else (density, "")
    notes = [note] if note else []
    if mesh.fixed_cells is not None:
        notes.append(f"{np.count_nonzero(mesh.fixed_cells)} generators that were held fixed are not counted")
    bent = bent_cells(mesh)
    if bent.any():
        count = np.count_nonzero(bent)
        notes.append(f"cells in which a wall bends are not counted ({count}), as the mesh does not tell where")
    return _measured(mesh, density, ~bent), "; ".join(notes)


def _measured(mesh: VoronoiMesh, density: Density | None, known: NDArray[np.bool_]) -> Quality:
    """The measures; the centroids of the cells that are `known` (n_cells,) count."""
    chords = edge_chords(mesh)
    sigma, q = neighbour_distance_ratio(mesh, chords), triangle_quality(mesh, chords)
    obtuse = obtuse_triangles(mesh, chords)
    if has_walls(mesh):
        chords, sigma, q = (_numbers_or_one(values) for values in (chords, sigma, q))
    return Quality(
        cells=mesh.n_cells,
        mu=float(chords.max() / chords.min()),
        sigma_avg=float(sigma.mean()),
        sigma_min=float(sigma.min()),
        q_avg=float(q.mean()),
        q_min=float(q.min()),
        residual=float("nan") if density is None else _centroid_residual(mesh, density, known),
        obtuse=int(np.count_nonzero(obtuse)),
        area_ratio=float(mesh.area_cell.max() / mesh.area_cell.min()),
    )


def _numbers_or_one(values: Array) -> Array:
    """Those of the values (n,) that are numbers, a single one that is none where there are none."""
    numbers = values[np.isfinite(values)]
    return numbers if len(numbers) else np.full(1, np.nan)


def edge_chords(mesh: VoronoiMesh) -> Array:
    """Straight distance between the two cells of each edge (n_edges,); no number at a wall.

    On the unit sphere, or in metres on a plane.
    """
    points, surface = mesh.cell_points / mesh.length_unit, surface_of(mesh)

    def lengths(cells: Index) -> Array:
        difference = surface.shortest(points[cells[:, 1]] - points[cells[:, 0]])
        return np.where(cells.min(axis=1) < 0, np.nan, np.sqrt(dot(difference, difference)))

    return by_blocks(lengths, mesh.cells_on_edge)


def neighbour_distance_ratio(mesh: VoronoiMesh, chords: Array | None = None) -> Array:
    """Shortest over longest distance to a neighbour, sigma (n_cells,); no number where a cell has no neighbour.

    `chords` are those of `edge_chords`, where they are known; here and below.
    """
    lengths = edge_chords(mesh) if chords is None else chords

    def ratio(edges: Index, counts: Index) -> Array:
        inside = np.arange(edges.shape[1]) < counts[:, None]
        distances = lengths[np.where(inside, edges, 0)]
        inside &= np.isfinite(distances)
        shortest = np.where(inside, distances, np.inf).min(axis=1)
        return shortest / np.where(inside.any(axis=1), np.where(inside, distances, 0.0).max(axis=1), np.nan)

    return by_blocks(ratio, mesh.edges_on_cell, mesh.n_edges_on_cell)


def triangle_quality(mesh: VoronoiMesh, chords: Array | None = None) -> Array:
    """The measure q of the Delaunay triangles (n_vertices,): twice the inscribed over the circumscribed radius.

    No number at the boundary, where two edges of a vertex are walls.
    """
    lengths = edge_chords(mesh) if chords is None else chords

    def quality(edges: Index) -> Array:
        a, b, c = (lengths[edges[:, k]] for k in range(3))
        return (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)

    return by_blocks(quality, mesh.edges_on_vertex)


def obtuse_triangles(mesh: VoronoiMesh, chords: Array | None = None) -> NDArray[np.bool_]:
    """Whether each Delaunay triangle (n_vertices,) is obtuse, so that its circumcentre lies outside."""
    lengths = edge_chords(mesh) if chords is None else chords

    def obtuse(edges: Index) -> NDArray[np.bool_]:
        a, b, c = (lengths[edges[:, k]] ** 2 for k in range(3))
        wrong: NDArray[np.bool_] = (a > b + c) | (b > c + a) | (c > a + b)
        return wrong

    return by_blocks(obtuse, mesh.edges_on_vertex)


def _centroid_residual(mesh: VoronoiMesh, density: Density, known: NDArray[np.bool_]) -> float:
    """Largest distance from a generator that was free to move to its constrained centroid, in mean spacings.

    Not a number where the centroid of no cell is `known` (n_cells,).
    """
    if not known.any():
        return float("nan")
    distances, spacing = _centroid_distances(mesh, density)
    free = known if mesh.fixed_cells is None else known & ~mesh.fixed_cells
    return float(distances[free].max(initial=0.0)) / spacing


def bent_cells(mesh: VoronoiMesh) -> NDArray[np.bool_]:
    """Which cells (n_cells,) have a wall that bends between its vertices, so that their areas are not of polygons.

    Areas may differ by the round-off of places, which is that of single precision where kites at walls, which a file
    gives, have no more digits.
    """
    bent, surface, unit = np.zeros(mesh.n_cells, bool), surface_of(mesh), mesh.length_unit
    cells = np.unique(mesh.cells_on_edge[wall_edges(mesh)].max(axis=1))
    if not len(cells):
        return bent
    ring = np.where(mesh.on_ring[cells], mesh.vertices_on_cell[cells], mesh.vertices_on_cell[cells, :1])
    corners, centres = mesh.vertex_points[ring] / unit, mesh.cell_points[cells, None] / unit
    found = surface.triangle_area(centres, corners, np.roll(corners, -1, axis=1)).sum(axis=1)
    areas = mesh.area_cell[cells]
    kites = mesh.kite_areas_on_vertex[boundary_vertices(mesh)]
    digits = np.finfo(np.float32 if (kites.astype(np.float32) == kites).all() else np.float64)
    round_off = ROUND_OFF * digits.eps * np.abs(mesh.vertex_points).max() / np.sqrt(areas)
    bent[cells] = np.abs(found * unit**2 / areas - 1.0) > np.maximum(STRAIGHT, round_off)
    return bent


def centroid_offsets(mesh: VoronoiMesh, density: Density) -> Array:
    """Distances (n_cells,) from all generators to the constrained centroids of their cells, in mean spacings."""
    distances, spacing = _centroid_distances(mesh, density)
    return distances / spacing


def _centroid_distances(mesh: VoronoiMesh, density: Density) -> tuple[Array, float]:
    """Distances (n_cells,) from generators to centroids, and the mean spacing, both on the unit sphere or the plane."""
    surface = surface_of(mesh)
    area = float(mesh.area_cell.sum()) / mesh.length_unit**2 if has_walls(mesh) else surface.area
    distances = _ways_to_centroids(mesh, density) if mesh.on_a_sphere else _ways_to_plane_centroids(mesh, density)
    return distances, surface.mean_spacing(mesh.n_cells, area)


def _ways_to_plane_centroids(mesh: VoronoiMesh, density: Density) -> Array:
    """Distances (n_cells,), metres, of generators from the centroids of their cells in a plane."""
    surface, points = surface_of(mesh), mesh.cell_points
    if density is uniform:
        return surface.distance(points, plane_centroids(mesh))
    starts, vertices = _vertex_rings(mesh)
    near = np.repeat(points, np.diff(starts), axis=0)
    corners = near + surface.shortest(mesh.vertex_points[vertices] - near)
    cells = WeightedCells(lambda places: density(surface.onto(places)), mesh.n_cells, surface=surface)
    sums = cells.integrate(points, corners, starts, np.arange(starts[-1], dtype=np.int32))
    distances: Array = np.linalg.norm(sums[:, 1:4], axis=1) / sums[:, 4]
    return distances


def _ways_to_centroids(mesh: VoronoiMesh, density: Density) -> Array:
    """Distances (n_cells,), radians, of generators from the constrained centroids of their cells on the sphere."""
    points = normalize(mesh.cell_points)
    if has_walls(mesh):
        cells = (points, normalize(mesh.vertex_points), *_vertex_rings(mesh))
    else:
        triangulation = Triangulation(points, mesh.cells_on_vertex)
        cells = (points, triangulation.circumcenters, triangulation.ring_starts, triangulation.rings)
    if density is uniform:
        _, moment, _ = masses_and_moments(*cells)
        return arc_length(points, normalize(moment))
    return centroid_distances(WeightedCells(density, mesh.n_cells).integrate(*cells))


def _vertex_rings(mesh: VoronoiMesh) -> tuple[Index, Index]:
    """Where each cell's vertices start (n_cells + 1,), and those of all cells one after another, counter-clockwise."""
    starts = np.concatenate([[0], np.cumsum(mesh.n_edges_on_cell)]).astype(np.int32)
    return starts, mesh.vertices_on_cell[mesh.on_ring]

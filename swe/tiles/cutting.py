"""The mesh cut into tiles of neighbouring cells, each with all that its tendency needs, in local numbers.

A tile owns a run of cells and the edges whose lower cell is among them. To find their tendency it computes

- the contributions to its edges from the cells at both ends of each: its own cells and a rim of cells after them;
- the potential vorticity at all vertices of these cells.

For these it needs the thickness of the cells around those vertices and the velocity at the edges around them. Those
that it does not own are its halo.

Everything a tile reads is stored contiguously, in the order in which it is read. The rings of sides of the cells are
stored in blocks of `LANES` cells (their first sides, their second sides, ...), so that neighbouring cells fill the
lanes of a vector, and the memory is read as one stream. Cells with fewer than `RING` sides are padded with sides of no
length, the last block with cells of none; cells with more have their rings stored separately, after the others.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index, Signs
from mesh.discrete.sides import Sides
from mesh.discrete.walls import closed_mesh, shares_of_circulation
from mesh.triangulation.ordering import inverse_order
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.parallel.processes import EVERYTHING, Own
from swe.tiles.layout import LANES, MIRROR, RING, TileArrays
from swe.tiles.numbering import LocalNumbers, order_of_cells, packed, tile_bounds
from swe.tiles.rings import in_whole_blocks, places_in_blocks, ring_array, ring_size, slots_of_sides, whole_blocks

CELLS_PER_TILE = 2560
"""Half a megabyte of scratch stays in the second-level cache, and a tile repeats a tenth of its neighbours' work."""


@dataclass(frozen=True, eq=False)
class Tiles:
    """Tiles of a mesh; `arrays` is what the kernels take.

    `cell_order` and `edge_order` are the cells and edges of the mesh in the order of the tiles, or None if that is the
    order of the mesh. `first_cell` and `first_edge` (n_tiles + 1,) are where each tile starts in it; of a part of a
    mesh, the tiles leave out cells and edges at both ends that belong to others. `halo` holds the places of the cells
    and edges that a tile reads from others; `indices` and `metrics` hold the tile's local indices and its geometry,
    with Coriolis parameter and topography. Their `..._parts` (n_tiles, ...) say where each part begins, and where the
    last one ends; `_Cutter.cut` defines their order. `most` holds the largest sizes of any tile.
    """

    cell_order: Index | None
    edge_order: Index | None
    first_cell: Index
    first_edge: Index
    halo: Index
    halo_parts: Index
    indices: Index
    index_parts: Index
    metrics: Array
    metric_parts: Index
    most: "LocalSizes"

    @property
    def arrays(self) -> TileArrays:
        """What the kernels take."""
        return (
            self.first_cell,
            self.first_edge,
            self.halo,
            self.halo_parts,
            self.indices,
            self.index_parts,
            self.metrics,
            self.metric_parts,
        )

    @property
    def n_tiles(self) -> int:
        """Number of tiles."""
        return len(self.first_cell) - 1


@dataclass(frozen=True)
class LocalSizes:
    """Numbers of cells with halo, cells computed, edges with halo, own edges, vertices, and sides of rings.

    `flux_sides` are those of the cells whose part of the flux is found first; none in tiles without such parts.
    """

    cells: int
    computed_cells: int
    edges: int
    own_edges: int
    vertices: int
    sides: int
    flux_sides: int


def build_tiles(
    mesh: VoronoiMesh,
    topography: Array,
    coriolis: Array,
    gravity: float,
    cells_per_tile: int = CELLS_PER_TILE,
    *,
    sides: Sides | None = None,
    with_border: bool = False,
    changed_vorticity: bool = False,
    own: Own = EVERYTHING,
    wall_slip: float = 0.0,
) -> Tiles:
    """Cut `mesh` (in metres) into tiles of about `cells_per_tile` cells, or fewer if scratch cannot hold them.

    `with_border` lets every tile compute the velocity at all edges of its cells, also at its border, the edges that
    other tiles own. They come first among the edges of its halo.
    Where neighbours are missing, a tile reads an edge of no length, kites of no area and a wall's own cell twice.
    `topography` (n_cells,), m; `coriolis` parameter (n_vertices,), 1/s; `gravity`, m/s2. With `sides`, the tiles are
    those of a scheme whose flux through a side has a part from each of its cells: they hold the rings of all cells
    around those computed, and the vectors of their sides. With `changed_vorticity` they hold what
    `swe.tiles.vorticity_loop` reads: the rings of these cells in all arrays, all their vertices, and what lies across
    their sides in both forms. Of a part of a mesh only tiles are made that hold its `own` entities. With `wall_slip`,
    vertices at coasts read the edges round them once more, shortened to their share of the circulation. Raises
    `InputError` if not even the surroundings of a single cell fit.
    """
    signs = mesh.edge_signs_on_cell, mesh.edge_signs_on_vertex
    whole, mesh = mesh, closed_mesh(mesh)
    cell_order = order_of_cells(mesh, tile_bounds(0, mesh.n_cells, cells_per_tile))
    cell_rank = inverse_order(cell_order)
    ends = np.sort(cell_rank[mesh.cells_on_edge], axis=1)
    edge_order = np.lexsort((ends[:, 1], ends[:, 0]))
    needed = np.concatenate([cell_rank[own.cells], ends[own.edges, 0]])
    first_cell = tile_bounds(int(needed.min()), int(needed.max()) + 1, cells_per_tile)
    first_edge = np.searchsorted(ends[edge_order, 0], first_cell)
    edge_rank = inverse_order(edge_order)
    shares = shares_of_circulation(whole, wall_slip)
    cutter = _Cutter(mesh, signs, shares, topography, coriolis, gravity, sides, changed_vorticity, cell_rank, edge_rank)
    pieces = [
        cutter.cut(
            cell_order[first_cell[tile] : first_cell[tile + 1]],
            edge_order[first_edge[tile] : first_edge[tile + 1]],
            with_border,
        )
        for tile in range(len(first_cell) - 1)
    ]
    most = LocalSizes(*np.max([list(piece.sizes) for piece in pieces], axis=0).tolist())
    if most.edges > MIRROR:
        if cells_per_tile == 1:
            raise InputError(
                f"a cell of the mesh has {most.edges} edges around it and its neighbours; the limit is {MIRROR}"
            )
        smaller = cells_per_tile // 2
        return build_tiles(
            whole,
            topography,
            coriolis,
            gravity,
            smaller,
            sides=sides,
            with_border=with_border,
            changed_vorticity=changed_vorticity,
            own=own,
            wall_slip=wall_slip,
        )
    halo, halo_parts = packed([piece.halo for piece in pieces], np.uint32)
    indices, index_parts = packed([piece.indices for piece in pieces], np.uint16)
    metrics, metric_parts = packed([piece.metrics for piece in pieces], np.float64)
    return Tiles(
        cell_order=None if _is_identity(cell_order) else cell_order,
        edge_order=None if _is_identity(edge_order) else edge_order,
        first_cell=first_cell,
        first_edge=first_edge,
        halo=halo,
        halo_parts=halo_parts,
        indices=indices,
        index_parts=index_parts,
        metrics=metrics,
        metric_parts=metric_parts,
        most=most,
    )


@dataclass(frozen=True, eq=False)
class _Piece:
    """The arrays of one tile, in the order in which the kernels unpack them; `sizes` are those of `LocalSizes`."""

    halo: list[Index]
    indices: list[Index]
    metrics: list[Array]
    sizes: tuple[int, ...]


class _Cutter:
    """Cuts tiles out of a mesh, one after another."""

    def __init__(
        self,
        mesh: VoronoiMesh,
        signs: tuple[Signs, Signs],
        shares: Array,
        topography: Array,
        coriolis: Array,
        gravity: float,
        sides: Sides | None,
        changed_vorticity: bool,
        cell_rank: Index,
        edge_rank: Index,
    ) -> None:
        self.mesh = mesh
        self.cell_rank, self.edge_rank = cell_rank, edge_rank
        self.potential = gravity * topography
        self.planetary = coriolis * mesh.area_triangle
        self.ratio = mesh.dv_edge / mesh.dc_edge
        self.on_cell, self.on_vertex = signs
        self.shares = shares
        inner = mesh.cells_on_edge[:, 0] != mesh.cells_on_edge[:, 1]
        self.turns = inner[mesh.edges_on_vertex] & (signs[1] != 0)  # along walls nothing turns
        self.sides, self.changed_vorticity = sides, changed_vorticity
        self.prefix = _area_passed(mesh)
        self.local_cells = LocalNumbers(mesh.n_cells)
        self.local_edges = LocalNumbers(mesh.n_edges)
        self.local_vertices = LocalNumbers(mesh.n_vertices)

    def cut(self, own_cells: Index, own_edges: Index, with_border: bool) -> _Piece:
        """The tile that owns these cells and edges, given by their numbers in the mesh."""
        mesh, cells, edges, vertices = self.mesh, self.local_cells, self.local_edges, self.local_vertices
        cells.add(own_cells)
        edges.add(own_edges)
        if with_border:
            edges.add(_edges_of(mesh, own_cells))
        moved = edges.known()
        cells.add(mesh.cells_on_edge[moved])
        computed = cells.known()
        sides = mesh.n_edges_on_cell[computed]
        inside = np.arange(mesh.max_edges) < sides[:, None]
        vertices.add(mesh.vertices_on_cell[computed][inside])
        round_vertices = vertices.known()
        edges.add(mesh.edges_on_vertex[round_vertices])
        cells.add(mesh.cells_on_vertex[round_vertices])
        ringed = computed if self.sides is None and not self.changed_vorticity else cells.known()
        around = mesh.n_edges_on_cell[ringed]
        edges.add(mesh.edges_on_cell[ringed][np.arange(mesh.max_edges) < around[:, None]])
        larger = np.flatnonzero(sides > RING)
        laid = computed  # the cells whose sides have places in the arrays of this order
        if self.changed_vorticity:
            laid, sides = ringed, around
            vertices.add(mesh.vertices_on_cell[ringed][np.arange(mesh.max_edges) < around[:, None]])
            round_vertices = vertices.known()
            edges.add(mesh.edges_on_vertex[round_vertices])
            cells.add(mesh.cells_on_vertex[round_vertices])
        slots = slots_of_sides(sides, mesh.max_edges)
        corners = vertices.of(mesh.vertices_on_cell[laid])
        last_corner = corners[np.arange(len(laid)), sides - 1]
        cells_across = ring_array(cells.of(mesh.cells_on_cell[laid]), sides, 0)
        opposite = self._opposite(computed, sides, around)
        halo_edges, lengths = edges.known()[len(own_edges) :], mesh.dc_edge[edges.known()]
        round_edges = edges.of(mesh.edges_on_vertex[round_vertices])
        missing = self.on_vertex[round_vertices] == 0
        if missing.any():
            round_edges[missing] = len(lengths)
            halo_edges, lengths = np.append(halo_edges, 0), np.append(lengths, 0.0)
        shares = np.where(self.turns[round_vertices], self.shares[round_vertices][:, None], 1.0)
        again = mesh.edges_on_vertex[round_vertices][shares < 1.0]
        round_edges[shares < 1.0] = len(lengths) + np.arange(len(again))
        halo_edges = np.append(halo_edges, again)
        lengths = np.append(lengths, shares[shares < 1.0] * mesh.dc_edge[again])
        ratio = np.where(self.on_cell[ringed] == 0, 0.0, self.ratio[mesh.edges_on_cell[ringed]])
        piece = _Piece(
            halo=[
                self.cell_rank[cells.known()[len(own_cells) :]],
                self.edge_rank[halo_edges],
            ],
            indices=[
                np.stack([self._slot(own_edges, end, slots) for end in (0, 1)]),
                _signed(round_edges, self.on_vertex[round_vertices] > 0).T,
                cells.of(mesh.cells_on_vertex[round_vertices]).T,
                ring_array(_signed(edges.of(mesh.edges_on_cell[ringed]), self.on_cell[ringed] > 0), around, 0),
                cells_across if self.sides is None else opposite,
                ring_array(corners, sides, last_corner),
                larger,
                slots[larger, 0],
                sides[larger],
                np.stack([self._slot(moved[len(own_edges) :], end, slots) for end in (0, 1)]),
                *self._larger_in_flux(larger, around),
                *self._for_changed_vorticity(opposite if self.sides is None else cells_across, around),
            ],
            metrics=[
                lengths,
                mesh.kite_areas_on_vertex[round_vertices].T,
                self.planetary[round_vertices],
                ring_array(ratio, around, 0.0),
                ring_array(self.prefix[laid], sides, 0.0),
                in_whole_blocks(1.0 / mesh.area_cell[ringed]),
                in_whole_blocks(self.potential[computed]),
                *self._vectors(ringed, around, ratio),
                *self._inverse_measure(ringed, around),
            ],
            sizes=(
                len(cells.known()),
                len(computed),
                len(lengths),
                len(own_edges),
                len(round_vertices),
                ring_size(sides),
                0 if self.sides is None else ring_size(around),
            ),
        )
        for numbers in (cells, edges, vertices):
            numbers.forget()
        return piece

    def _opposite(self, computed: Index, sides: Index, around: Index) -> Index:
        """The places of the same sides seen from the cells across, for the computed cells; others stand for themselves.

        `sides` are those of the cells in the ring, `around` those of the cells to whose places it points.
        """
        if self.sides is None and not self.changed_vorticity:
            return sides[:0]
        mesh, slots = self.mesh, slots_of_sides(around, self.mesh.max_edges)
        there, edges = self.on_cell[computed] != 0, mesh.edges_on_cell[computed]
        side = np.argmax(mesh.edges_on_cell[mesh.cells_on_cell[computed]] == edges[:, :, None], axis=2)
        across = np.where(there, self.local_cells.of(mesh.cells_on_cell[computed]), 0)
        opposite = slots[: len(sides)].copy()  # a side through which nothing flows is its own opposite
        opposite[: len(computed)][there] = slots[across, side][there]
        return ring_array(opposite, sides, places_in_blocks(len(sides))[:, RING - 1])

    def _larger_in_flux(self, larger: Index, around: Index) -> list[Index]:
        """Where the flux of the `larger` cells starts; and for all cells around, which are larger, and their sides."""
        if self.sides is None:
            return []
        slots, all_larger = slots_of_sides(around, self.mesh.max_edges), np.flatnonzero(around > RING)
        return [slots[larger, 0], all_larger, slots[all_larger, 0], around[all_larger]]

    def _for_changed_vorticity(self, across: Index, around: Index) -> list[Index]:
        """What lies `across` in the form that the scheme does not need; which of the cells are larger, and how."""
        if not self.changed_vorticity:
            return []
        larger = np.flatnonzero(around > RING)
        return [across, larger, slots_of_sides(around, self.mesh.max_edges)[larger, 0], around[larger]]

    def _inverse_measure(self, ringed: Index, around: Index) -> list[Array]:
        """1/(l d) at every side, zero at edges of no length."""
        if not self.changed_vorticity:
            return []
        measure = (self.mesh.dv_edge * self.mesh.dc_edge)[self.mesh.edges_on_cell[ringed]]
        return [ring_array(np.divide(1.0, measure, out=np.zeros_like(measure), where=measure > 0.0), around, 0.0)]

    def _vectors(self, ringed: Index, around: Index, ratio: Array) -> list[Array]:
        """The vector to each neighbour, and where its bisector meets the middle of the side, as parts of its length."""
        if self.sides is None:
            return []
        normal, length = self.sides.normal[ringed], self.sides.distance[ringed]
        numbers = [length * normal[..., 0], length * normal[..., 1], self.sides.offset[ringed] / length]
        rings = [ring_array(np.where(ratio == 0.0, 0.0, each), around, 0.0) for each in numbers]
        in_blocks = RING * whole_blocks(len(ringed))
        blocks = np.stack([ring[:in_blocks].reshape(-1, RING * LANES) for ring in rings], axis=1)
        ends = np.cumsum(around[around > RING])[:-1]
        whole = [
            np.concatenate(parts) for parts in zip(*(np.split(ring[in_blocks:], ends) for ring in rings), strict=True)
        ]
        return [np.concatenate([blocks.ravel(), *whole])]

    def _slot(self, edges: Index, end: int, slots: Index) -> Index:
        """Slot into which the cell at `end` of each edge writes its contribution."""
        cell = self.mesh.cells_on_edge[edges, end]
        side = np.argmax(self.mesh.edges_on_cell[cell] == edges[:, None], axis=1)
        return slots[self.local_cells.of(cell), side]


def _edges_of(mesh: VoronoiMesh, cells: Index) -> Index:
    """Edges of the cells, in the order of their rings; some stand there twice."""
    inside = np.arange(mesh.max_edges) < mesh.n_edges_on_cell[cells][:, None]
    return mesh.edges_on_cell[cells][inside]


def _is_identity(order: Index) -> bool:
    return bool(np.all(order == np.arange(len(order))))


def _area_passed(mesh: VoronoiMesh) -> Array:
    """Fraction (n_cells, max_edges) of the cell's area in its kites between side 0 and each side."""
    passed = np.zeros((mesh.n_cells, mesh.max_edges))
    cell = np.arange(mesh.n_cells)[:, None]
    for side in range(1, mesh.max_edges):
        vertex = mesh.vertices_on_cell[:, side - 1]
        kite = (mesh.kite_areas_on_vertex[vertex] * (mesh.cells_on_vertex[vertex] == cell)).sum(axis=1)
        passed[:, side] = passed[:, side - 1] + kite / mesh.area_cell
    return passed


def _signed(numbers: Index, positive: NDArray[np.bool_]) -> Index:
    """Places of U, or of -U where not `positive`."""
    return np.where(positive, numbers, numbers + MIRROR)

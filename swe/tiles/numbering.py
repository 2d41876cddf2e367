"""Numbers of entities within a tile, the order of cells from tile to tile, and the packed arrays of all tiles."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.geometry.surface import surface_of
from mesh.triangulation.ordering import hilbert_order, inverse_order, keeps_neighbours
from mesh.voronoi_mesh import VoronoiMesh


class LocalNumbers:
    """Local numbers, within a tile, of entities of one kind, in the order in which they first appear."""

    def __init__(self, size: int) -> None:
        self._number = np.full(size, -1)
        self._entities: list[Index] = []
        self._count = 0

    def add(self, entities: Index) -> None:
        """Number those that have no number yet."""
        fresh = entities.ravel()[self._number[entities.ravel()] < 0]
        fresh = fresh[np.sort(np.unique(fresh, return_index=True)[1])]
        self._number[fresh] = self._count + np.arange(len(fresh))
        self._entities.append(fresh)
        self._count += len(fresh)

    def known(self) -> Index:
        """The entities in the order of their local numbers."""
        return np.concatenate(self._entities)

    def of(self, entities: Index) -> Index:
        """Local numbers of `entities`; undefined for those that have none."""
        return self._number[entities]

    def forget(self) -> None:
        """Forget all numbers, to start on another tile."""
        for entities in self._entities:
            self._number[entities] = -1
        self._entities, self._count = [], 0


def tile_bounds(first: int, last: int, cells_per_tile: int) -> Index:
    """Where tiles of about `cells_per_tile` cells start in the run of cells from `first` up to `last`, and its end."""
    n_tiles = max(1, round((last - first) / cells_per_tile))
    return np.linspace(first, last, n_tiles + 1).astype(np.int64)


def order_of_cells(mesh: VoronoiMesh, first_cell: Index) -> Index:
    """The mesh's own order if it keeps neighbours together, else that along a Hilbert curve."""
    own, curve = np.arange(mesh.n_cells), hilbert_order(surface_of(mesh).curve_places(mesh.cell_points))
    tiles = np.searchsorted(first_cell, own, side="right")
    return own if keeps_neighbours(tiles, tiles[inverse_order(curve)], (mesh.cells_on_edge,)) else curve


def packed(pieces: list[list[NDArray[Any]]], dtype: type) -> tuple[NDArray[Any], Index]:
    """All parts of all tiles in one array, and the places where they begin, (n_tiles, parts + 1)."""
    sizes = np.array([[part.size for part in piece] for piece in pieces])
    ends = np.cumsum(sizes).reshape(sizes.shape)
    starts = np.concatenate([ends[:, :1] - sizes[:, :1], ends], axis=1)
    return np.concatenate([part.ravel() for piece in pieces for part in piece]).astype(dtype), starts

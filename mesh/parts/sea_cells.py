"""The cells of a mesh that make a sea: those of a region without its lakes and without channels of one cell's width."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Index
from mesh.errors import MeshError
from mesh.geometry.sphere import normalize
from mesh.graphs import connected_parts
from mesh.parts.culling import culled
from mesh.regions.find import find_region
from mesh.regions.region import Region
from mesh.voronoi_mesh import VoronoiMesh

Marks = NDArray[np.bool_]

ROUND = 1.2
"""A cell lies within a circle round its centre that is wider by this than the circle of its area."""

NO_CHANNEL = 1000
"""More than a cell has neighbours."""


@dataclass(frozen=True, eq=False)
class CulledSea:
    """Which cells (n_cells,) a sea keeps, and what was left out of its region.

    `channel_cells` counts the cells of channels, `lakes` the connected parts besides the largest, and `lake_cells`
    their cells.
    """

    kept: Marks
    channel_cells: int
    lakes: int
    lake_cells: int


def cull_mesh(
    mesh: VoronoiMesh, keep: str | Region, *, keep_lakes: bool = False, keep_channels: bool = False
) -> VoronoiMesh:
    """The cells of `mesh` whose centres lie in a region, `keep`, with walls where the others were.

    A text names it as `find_region` reads it. Lakes and channels are left out as `sea_cells` says. Raises `MeshError`
    where there is no such region, or no cell is left.
    """
    region = find_region(keep) if isinstance(keep, str) else keep
    return culled(mesh, sea_cells(mesh, region, keep_lakes=keep_lakes, keep_channels=keep_channels).kept)


def sea_cells(mesh: VoronoiMesh, region: Region, *, keep_lakes: bool = False, keep_channels: bool = False) -> CulledSea:
    """The cells of `mesh` whose centres lie in `region`: the largest connected sea, without channels.

    A cell is part of a channel where it has fewer than two kept neighbours, or where these stand in more than one row
    round it, with land on either side; such cells are left out until there are none, before the largest sea is sought.
    `keep_channels` and `keep_lakes` leave them. Raises `MeshError` where no cell is left.
    """
    mesh.require_sphere("regions are cut out")
    radii = ROUND * np.sqrt(mesh.area_cell / np.pi) / mesh.sphere_radius
    inside = region.contains(normalize(mesh.cell_points), radii)
    if not inside.any():
        raise MeshError(
            f"the region {region.name} holds the centre of none of the {mesh.n_cells} cells; take a larger region, or "
            "a mesh of more cells"
        )
    open_sea = inside if keep_channels else without_channels(mesh, inside)
    seas, sizes = connected_seas(mesh, open_sea)
    if not sizes.size:
        raise MeshError(
            f"the {np.count_nonzero(inside)} cells in the region {region.name} are all channels of one cell's width; "
            "take a mesh of more cells, or keep the channels"
        )
    kept = open_sea if keep_lakes else seas == sizes.argmax()
    lost = len(sizes) - 1
    return CulledSea(
        kept,
        channel_cells=int(np.count_nonzero(inside & ~open_sea)),
        lakes=0 if keep_lakes else lost,
        lake_cells=int(np.count_nonzero(open_sea & ~kept)),
    )


def without_channels(mesh: VoronoiMesh, kept: Marks) -> Marks:
    """The `kept` cells (n_cells,) without those of channels; see `sea_cells`.

    Of neighbours that are both part of a channel, those with fewer kept neighbours go first, so that the cell at the
    mouth of a channel, which is on the coast once the channel is gone, stays.
    """
    kept, ring = kept.copy(), _neighbours(mesh)
    while True:
        width = _widths_of_channels(ring, mesh.n_edges_on_cell, kept)
        beside = np.where(ring >= 0, width[ring], NO_CHANNEL).min(axis=1)
        narrow = (width < NO_CHANNEL) & (width <= beside)
        if not narrow.any():
            return kept
        kept &= ~narrow


def connected_seas(mesh: VoronoiMesh, kept: Marks) -> tuple[Index, Index]:
    """The number (n_cells,) of the connected sea of each `kept` cell, -1 for others, and how many cells each has.

    Cells with an edge in common are connected.
    """
    pairs = mesh.cells_on_edge[(mesh.cells_on_edge >= 0).all(axis=1)]
    pairs = pairs[kept[pairs].all(axis=1)]
    numbers = connected_parts(mesh.n_cells, pairs)[1]
    used, number = np.unique(numbers[kept], return_inverse=True)
    seas = np.full(mesh.n_cells, -1, np.intp)
    seas[kept] = number
    return seas, np.bincount(number, minlength=len(used))


def _widths_of_channels(ring: Index, sizes: Index, kept: Marks) -> Index:
    """How many kept neighbours (n_cells,) each kept cell has that is part of a channel; `NO_CHANNEL` for others.

    The first `sizes` (n_cells,) entries of a row of `ring` (n_cells, max_edges) are its neighbours in order, or -1.
    """
    wet = (ring >= 0) & kept[ring]
    following = np.take_along_axis(wet, (np.arange(ring.shape[1]) + 1) % sizes[:, None], axis=1)
    rows = np.count_nonzero(wet & ~following, axis=1)
    count = np.count_nonzero(wet, axis=1)
    return np.where(kept & ((rows > 1) | (count < 2)), count, NO_CHANNEL)


def _neighbours(mesh: VoronoiMesh) -> Index:
    """Neighbours (n_cells, max_edges) of each cell in their order, -1 where there is none and beyond the ring."""
    return np.where(mesh.on_ring, mesh.cells_on_cell, -1)

"""Where an error lives: the share of its square in each zone of a mesh, beside the zone's share of the area."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from mesh.geometry.sphere import hexagon_spacing
from mesh.voronoi_mesh import VoronoiMesh

Mask = NDArray[np.bool_]

BANDS = {
    "south_of_60s": (-90.0, -60.0),
    "60s_to_30s": (-60.0, -30.0),
    "30s_to_equator": (-30.0, 0.0),
    "equator_to_30n": (0.0, 30.0),
    "30n_to_60n": (30.0, 60.0),
    "north_of_60n": (60.0, 90.0),
}
"""Bands of latitude, degrees; each holds its southern limit."""

ZONES = (*BANDS, "near_irregular", "near_coast", "refined", "transition", "coarse")
"""All zones there are, bands first."""

RINGS = 2
"""Cells are near an irregular one, or near a wall, if they are at most this many cells away."""

LEAST_REFINEMENT = 1.5
"""A mesh is refined where its spacings, but for the most extreme, span this ratio or more."""

EXTREMES = 0.02
"""The share of cells at either end of the range of spacings that is left out of it."""


@dataclass(frozen=True)
class Share:
    """Share of the squared error in a zone, and of the area."""

    error: float
    area: float


def error_shares(mesh: VoronoiMesh, error: Array) -> dict[str, Share]:
    """Shares by zone of an error (n_cells,), of any unit; empty where there is no error.

    Zones are, on a sphere, the `BANDS` of latitude that hold cells, `near_irregular` (pentagons, heptagons and the
    cells round them), on a sea `near_coast`, and on a refined mesh `refined`, `transition` and `coarse`.
    """
    squared = mesh.area_cell * error**2
    total = float(squared.sum())
    if not total > 0.0:
        return {}
    area = float(mesh.area_cell.sum())
    return {
        name: Share(float(squared[mask].sum()) / total, float(mesh.area_cell[mask].sum()) / area)
        for name, mask in zones(mesh).items()
        if mask.any()
    }


def shares_as_columns(shares: Mapping[str, Share]) -> dict[str, float]:
    """Shares by the names of columns, `error_share_ZONE` and `area_share_ZONE`."""
    columns: dict[str, float] = {}
    for zone, share in shares.items():
        columns |= {f"error_share_{zone}": share.error, f"area_share_{zone}": share.area}
    return columns


def zones(mesh: VoronoiMesh) -> dict[str, Mask]:
    """Masks (n_cells,) of the zones by name; those that the mesh lacks are empty or not there."""
    found = _bands(mesh) if mesh.on_a_sphere else {}
    found["near_irregular"] = _grown(mesh, mesh.n_edges_on_cell != 6)
    at_wall = np.zeros(mesh.n_cells, bool)
    at_wall[mesh.cells_on_edge[wall_edges(mesh)].max(axis=1)] = True
    found["near_coast"] = _grown(mesh, at_wall)
    return found | _refinement(mesh)


def _bands(mesh: VoronoiMesh) -> dict[str, Mask]:
    latitude = np.degrees(mesh.lat_cell)
    found = {name: (latitude >= south) & (latitude < north) for name, (south, north) in BANDS.items()}
    found["north_of_60n"] |= latitude >= BANDS["north_of_60n"][1]
    return found


def _grown(mesh: VoronoiMesh, mask: Mask) -> Mask:
    """The cells of a mask and those up to `RINGS` away from them."""
    inner = mesh.cells_on_edge[mesh.cells_on_edge.min(axis=1) >= 0]
    for _ in range(RINGS):
        touched = mask[inner].any(axis=1)
        mask = mask.copy()
        mask[inner[touched]] = True
    return mask


def _refinement(mesh: VoronoiMesh) -> dict[str, Mask]:
    """The fine cells, the coarse ones and those between: the middle half of the range of spacings, in its logarithm."""
    spacing = np.log(hexagon_spacing(mesh.area_cell))
    finest, coarsest = np.quantile(spacing, (EXTREMES, 1.0 - EXTREMES))
    if coarsest - finest < np.log(LEAST_REFINEMENT):
        return {}
    quarter = 0.25 * (coarsest - finest)
    refined, coarse = spacing < finest + quarter, spacing > coarsest - quarter
    return {"refined": refined, "transition": ~(refined | coarse), "coarse": coarse}

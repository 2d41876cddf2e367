"""Symmetric seas, whose coasts pass through borders and corners of cells: every crossing counts once."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mesh import MeshError, VoronoiMesh
from mesh.arrays import Array
from mesh.coast import sea_cells
from mesh.coast.coastline import Coastline
from mesh.coast.portions import portions_of
from mesh.coast.sea_cells import SeaCells
from mesh.coast.sea_mesh import sea_mesh
from mesh.coast.start import fillers, sea_spacing
from mesh.geometry.sphere import from_lonlat, normalize

LATITUDES = (0.1, 0.3, 0.5)
"""Of the rows of generators in the channel, radians."""

NORTH = 0.6


def cells_of(rings: list[Array], points: Array) -> SeaCells:
    coast = Coastline(rings)
    return SeaCells(points, coast, fillers(coast, sea_spacing(coast, len(points))))


def circle(count: int, begin: float, latitude: float, eastward: bool = True) -> Array:
    """Points (count, 3) of a circle of latitude, from the longitude `begin` on, radians."""
    east = 2.0 * math.pi * np.arange(count) / count
    return from_lonlat(begin + (east if eastward else -east), np.full(count, latitude))


def channel(cells: int, per_cell: int, begin: float, stagger: float = 0.0) -> tuple[list[Array], Array]:
    """Coasts and generators of a channel along the equator, `cells` cells round, with so many coast points per cell.

    Coasts begin at `begin` widths of a cell east of a generator; every other row stands `stagger` widths further east.
    """
    width = 2.0 * math.pi / cells
    shifts = (0.0, stagger * width, 0.0)
    points = [circle(cells, shift, latitude) for shift, latitude in zip(shifts, LATITUDES, strict=True)]
    count = cells * per_cell
    rings = [circle(count, begin * width, 0.0), circle(count, begin * width, NORTH, eastward=False)]
    return rings, np.concatenate(points)


def filled(rings: list[Array], points: Array) -> VoronoiMesh:
    """The mesh of a sea; its cells fill it, and each crossing leads from the cell that the one before led into."""
    sea = cells_of(rings, points)
    entered = sea.crossing_cells[portions_of(sea, points).next_end, 0]
    np.testing.assert_array_equal(entered, sea.crossing_cells[:, 1])
    mesh = sea_mesh(sea, points)
    assert mesh.area_cell.sum() == pytest.approx(sea.coastline.area, rel=1e-12)
    return mesh


@pytest.mark.parametrize("begin", [0.5, -0.5])
def test_a_coast_may_begin_on_the_border_of_two_cells(begin: float) -> None:
    mesh = filled(*channel(16, 4, begin))
    assert mesh.boundary_vertex.sum() == 32


@settings(deadline=None, max_examples=40)
@given(
    cells=st.integers(8, 24),
    per_cell=st.integers(1, 8),
    begin=st.integers(0, 8),
    stagger=st.sampled_from([0.0, 0.25, 0.5]),
)
def test_channels_of_any_symmetry_are_filled(cells: int, per_cell: int, begin: int, stagger: float) -> None:
    filled(*channel(cells, per_cell, begin / 8.0, stagger))


@settings(deadline=None, max_examples=40)
@given(
    rows=st.sampled_from([4, 5, 6, 8]),
    width=st.sampled_from([0.4, 0.5, 0.6, 2.0 / 3.0, 0.75, 0.8, 1.0]),
    per_side=st.sampled_from([1, 2, 3, 4, 8]),
    begin=st.integers(0, 8),
)
def test_squares_are_filled(rows: int, width: float, per_side: int, begin: int) -> None:
    """Four generators about each corner of the cells, and corners on the coast."""
    along = (np.arange(rows) + 0.5) / rows * 2.0 - 1.0
    x, y = (values.ravel() for values in np.meshgrid(along, along))
    inside = (np.abs(x) < width) & (np.abs(y) < width)
    points = normalize(np.stack([x, y, np.ones_like(x)], axis=1)[inside])
    if len(points) < 12:
        return
    side = np.linspace(-width, width, per_side, endpoint=False)
    border = np.full(per_side, width)
    around = np.concatenate([side, border, -side, -border]), np.concatenate([-border, side, border, -side])
    coast = normalize(np.stack([*around, np.ones(4 * per_side)], axis=1))
    filled([np.roll(coast, -begin, axis=0)], points)


def test_an_island_within_one_cell_that_begins_on_its_border_is_refused() -> None:
    """Such a ring has no crossing, whichever of the two cells is found first."""
    rings, points = channel(16, 4, 0.0)
    border = math.pi / 16.0
    angle = -2.0 * math.pi * np.arange(16) / 16
    island = from_lonlat(border * (0.75 + 0.25 * np.cos(angle)), 0.3 + 0.05 * np.sin(angle))
    sea = cells_of([*rings, island], points)
    assert sea.n_crossings == 32
    assert (sea.loops > 1).sum() == 1
    with pytest.raises(MeshError, match="is in several parts or goes round an island"):
        sea_mesh(sea, points)


def test_a_generator_on_the_coast_itself_is_refused() -> None:
    rings, points = channel(16, 4, 0.0)
    points[3] = normalize(rings[0][12] + rings[0][13])  # at sea, on land or neither, as rounding has it
    sea = cells_of(rings, points)
    with pytest.raises(MeshError, match=r"generator 3 stands on (land|the coast itself)"):
        sea_mesh(sea, points)


def test_a_crossing_that_does_not_lead_on_is_told() -> None:
    rings, points = channel(16, 4, 0.0)
    sea = cells_of(rings, points)
    sea.crossing_cells[5, 0] += 1
    with pytest.raises(
        MeshError, match=r"the coast enters cell 5 at longitude 101\.25 .* degrees and does not leave it once"
    ):
        portions_of(sea, points)


def test_a_ring_that_never_closes_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sea_cells, "follow_coast", lambda *_: sea_cells.NOT_CLOSED)
    with pytest.raises(MeshError, match="ends in another cell than it begins in"):
        cells_of(*channel(16, 4, 0.0))

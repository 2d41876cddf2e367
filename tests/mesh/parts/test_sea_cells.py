"""The cells of a sea: lakes and channels of one cell's width, on meshes where they can be counted."""

import numpy as np
import pytest

from mesh import MeshError, Region, VoronoiMesh, cull_mesh
from mesh.arrays import Array
from mesh.geometry.sphere import from_lonlat, normalize
from mesh.parts.culling import culled
from mesh.parts.sea_cells import connected_seas, sea_cells, without_channels
from mesh.regions.find import find_region
from mesh.regions.outline import Outline


def region_of(mesh: VoronoiMesh, kept: np.ndarray) -> Region:
    """The region in which the centres of just the `kept` cells lie."""
    return Region("marked", lambda points: np.where(kept, 1.0, -1.0))


def ring_of(mesh: VoronoiMesh, cell: int) -> np.ndarray:
    return mesh.cells_on_cell[cell, : mesh.n_edges_on_cell[cell]]


def within(mesh: VoronoiMesh, cell: int, rings: int) -> np.ndarray:
    """Marks of the cells within so many rings of one."""
    marks = np.zeros(mesh.n_cells, bool)
    marks[cell] = True
    for _ in range(rings):
        for found in np.flatnonzero(marks):
            marks[ring_of(mesh, found)] = True
    return marks


def plain_channels(mesh: VoronoiMesh, kept: np.ndarray) -> np.ndarray:
    """`without_channels`, cell by cell."""
    kept = kept.copy()
    while True:
        width = {}
        for cell in np.flatnonzero(kept):
            wet = [bool(kept[other]) for other in ring_of(mesh, cell)]
            rows = sum(here and not after for here, after in zip(wet, wet[1:] + wet[:1], strict=True))
            if rows > 1 or sum(wet) < 2:
                width[int(cell)] = sum(wet)
        if not width:
            return kept
        kept[[c for c in width if width[c] <= min(width.get(int(other), 9) for other in ring_of(mesh, c))]] = False


@pytest.mark.parametrize("share", [0.5, 0.7, 0.9])
def test_channels_are_those_of_the_plain_rule(icosahedral_mesh: VoronoiMesh, share: float) -> None:
    kept = np.random.default_rng(7).random(icosahedral_mesh.n_cells) < share
    expected = plain_channels(icosahedral_mesh, kept)
    np.testing.assert_array_equal(without_channels(icosahedral_mesh, kept), expected)
    assert expected.sum() < kept.sum()


def test_all_cells_of_the_sphere_and_an_island_of_one_cell_stay(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    kept = np.ones(mesh.n_cells, bool)
    assert without_channels(mesh, kept).all()
    kept[100] = False
    sea = sea_cells(mesh, region_of(mesh, kept))
    np.testing.assert_array_equal(sea.kept, kept)
    assert (sea.channel_cells, sea.lakes, sea.lake_cells) == (0, 0, 0)
    assert culled(mesh, sea.kept).boundary_vertex.sum() == mesh.n_edges_on_cell[100]


def test_a_lake_and_a_channel_are_counted(icosahedral_mesh: VoronoiMesh) -> None:
    """Two seas joined by a row of single cells: the row goes, and then the smaller sea is a lake."""
    mesh = icosahedral_mesh
    first = int(mesh.z_cell.argmax())
    large, cell, row = within(mesh, first, 5), first, []
    for _ in range(9):
        cell = int(ring_of(mesh, cell)[mesh.z_cell[ring_of(mesh, cell)].argmin()])
        row.append(cell)
    small = within(mesh, row[-1], 1)
    channel = np.zeros(mesh.n_cells, bool)
    channel[row] = True
    channel &= ~(large | small)
    region = region_of(mesh, large | small | channel)
    sea = sea_cells(mesh, region)
    assert channel.sum() >= 2
    assert (sea.channel_cells, sea.lakes) == (channel.sum(), 1)
    np.testing.assert_array_equal(sea.kept, large)
    assert sea.lake_cells == small.sum()
    both = sea_cells(mesh, region, keep_lakes=True)
    np.testing.assert_array_equal(both.kept, large | small)
    assert (both.lakes, both.lake_cells) == (0, 0)
    joined = sea_cells(mesh, region, keep_channels=True)
    np.testing.assert_array_equal(joined.kept, large | small | channel)
    assert (joined.channel_cells, joined.lakes) == (0, 0)


def test_connected_seas(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    north, south = mesh.z_cell > 0.6, mesh.z_cell < -0.3
    seas, sizes = connected_seas(mesh, north | south)
    assert sorted(sizes) == sorted([north.sum(), south.sum()])
    assert (seas[~(north | south)] == -1).all()
    assert len(set(seas[north])) == len(set(seas[south])) == 1


def test_the_box_is_culled_on_any_radius_and_twice(icosahedral_mesh: VoronoiMesh) -> None:
    region = find_region("280,350,10,60")
    kept = sea_cells(icosahedral_mesh, region).kept
    inside = region.contains(normalize(icosahedral_mesh.cell_points))
    assert kept.sum() > 0.8 * inside.sum() > 20
    assert not (kept & ~inside).any()
    part = cull_mesh(icosahedral_mesh.scaled(6371220.0), "280,350,10,60")
    points: Array = part.cell_points / 6371220.0
    np.testing.assert_allclose(points, icosahedral_mesh.cell_points[kept], atol=1e-12)
    assert cull_mesh(part, region).n_cells == part.n_cells


def test_cells_on_an_isthmus_that_is_narrower_than_a_cell_are_land(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    meridian = from_lonlat(np.full(91, 0.3), np.linspace(-1.57, 1.57, 91))
    antimeridian = from_lonlat(np.full(91, 0.3 + np.pi), np.linspace(1.57, -1.57, 91))
    line = np.concatenate([meridian, antimeridian])
    isthmus = Outline(line, np.roll(line, -1, axis=0))
    sea = sea_cells(mesh, Region("halves", lambda points: np.ones(len(points)), isthmuses=isthmus), keep_lakes=True)
    sizes = connected_seas(mesh, sea.kept)[1]
    assert len(sizes) == 2
    assert 0.8 * mesh.n_cells < sizes.sum() < mesh.n_cells
    assert abs(int(sizes[0]) - int(sizes[1])) < 0.1 * mesh.n_cells


def test_no_cell_is_left(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match=r"the region 100,101,5,6 holds the centre of none of the 642 cells; take a"):
        cull_mesh(icosahedral_mesh, "100,101,5,6")
    kept = np.zeros(icosahedral_mesh.n_cells, bool)
    kept[5] = True
    with pytest.raises(MeshError, match=r"the 1 cells in the region marked are all channels of one cell's width; take"):
        sea_cells(icosahedral_mesh, region_of(icosahedral_mesh, kept))
    assert sea_cells(icosahedral_mesh, region_of(icosahedral_mesh, kept), keep_channels=True).kept.sum() == 1

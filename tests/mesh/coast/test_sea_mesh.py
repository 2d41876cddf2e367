"""The mesh of clipped cells: valid, with the coast as its wall, and refused where cells and coast do not allow it."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, read_mesh, write_mesh
from mesh.coast.coastline import Coastline
from mesh.coast.corners import corners_and_faults
from mesh.coast.portions import portions_of
from mesh.coast.sea_cells import SeaCells
from mesh.coast.sea_mesh import sea_mesh
from mesh.coast.start import fillers, sea_spacing
from mesh.discrete.validate import validate_mesh
from mesh.discrete.walls import wall_edges
from mesh.geometry.sphere import arc_length
from tests.mesh.coast.shores import cells_of_sea, converged, wavy_ring, wavy_sea

CELLS = 600


@pytest.fixture(scope="module")
def sea() -> tuple[VoronoiMesh, SeaCells]:
    found = converged(wavy_sea(CELLS), CELLS)
    return sea_mesh(found.sea, found.result.points), found.sea


def test_mesh_is_valid_and_fills_the_sea(sea: tuple[VoronoiMesh, SeaCells]) -> None:
    mesh, cells = sea
    assert max(validate_mesh(mesh).values()) < 1e-11
    assert mesh.area_cell.sum() == pytest.approx(cells.coastline.area, rel=1e-11)
    # A sphere with two holes.
    assert mesh.n_vertices - mesh.n_edges + mesh.n_cells == 0
    assert mesh.boundary_vertex.sum() == len(wall_edges(mesh)) == cells.n_crossings


def test_every_cell_at_the_coast_has_one_portion_of_it(sea: tuple[VoronoiMesh, SeaCells]) -> None:
    mesh, cells = sea
    walls, spacing = wall_edges(mesh), sea_spacing(cells.coastline, CELLS)
    assert (mesh.cells_on_edge[walls, 0] >= 0).all()
    assert np.bincount(mesh.cells_on_edge[walls, 0]).max() == 1
    lengths = portions_of(cells, mesh.cell_points).lengths / spacing
    assert 0.4 < lengths.min() < lengths.max() < 1.7
    np.testing.assert_allclose(lengths.sum() * spacing, cells.coastline.lengths.sum(), rtol=1e-3)
    to_coast = 0.5 * mesh.dc_edge[walls] / spacing
    assert 0.3 < to_coast.min() < to_coast.max() < 0.7
    np.testing.assert_allclose(
        to_coast * spacing, cells.coastline.distance(mesh.cell_points[mesh.cells_on_edge[walls, 0]]), rtol=1e-3
    )
    inner = np.delete(np.arange(mesh.n_edges), walls)
    at_coast = inner[mesh.boundary_vertex[mesh.vertices_on_edge[inner]].any(axis=1)]
    assert mesh.dv_edge[inner].min() > 0.1 * spacing
    assert mesh.dv_edge[at_coast].min() > 0.3 * spacing


def test_vertices_of_the_coast_lie_on_it_midway_between_their_cells(sea: tuple[VoronoiMesh, SeaCells]) -> None:
    mesh, cells = sea
    rows = np.flatnonzero(mesh.boundary_vertex)
    vertices = mesh.vertex_points[rows]
    sag = 0.125 * cells.coastline.lengths.max() ** 2
    assert np.abs(cells.coastline.distance(vertices)).max() < 1.01 * sag
    pair = mesh.cell_points[mesh.cells_on_vertex[rows, :2]]
    np.testing.assert_allclose(arc_length(pair[:, 0], vertices), arc_length(pair[:, 1], vertices), rtol=1e-10)
    np.testing.assert_array_equal(mesh.cells_on_vertex[rows, 2], -1)
    is_wall = np.isin(mesh.edges_on_vertex[rows], wall_edges(mesh))
    np.testing.assert_array_equal(is_wall, np.tile([True, False, True], (len(rows), 1)))


def test_normals_of_the_coast_lead_out_of_the_sea(sea: tuple[VoronoiMesh, SeaCells]) -> None:
    mesh, cells = sea
    walls = wall_edges(mesh)
    start, end = mesh.vertex_points[mesh.vertices_on_edge[walls]].transpose(1, 0, 2)
    outward = np.cross(end - start, mesh.edge_points[walls])
    beyond = mesh.edge_points[walls] + 1e-3 * outward / np.linalg.norm(outward, axis=1)[:, None]
    assert not cells.coastline.contains(beyond).any()


def test_file_holds_the_mesh(sea: tuple[VoronoiMesh, SeaCells], tmp_path: Path) -> None:
    mesh, _ = sea
    write_mesh(mesh, tmp_path / "sea.nc")
    for read in (read_mesh(tmp_path / "sea.nc"), read_mesh(tmp_path / "sea.nc", recompute_metrics=True)):
        for field in fields(mesh):
            ours, theirs = getattr(mesh, field.name), getattr(read, field.name)
            if field.name in ("fixed_cells", "density_name", "density_source", "mesh_density"):
                continue
            np.testing.assert_allclose(theirs, ours, rtol=1e-10, atol=1e-12, err_msg=field.name)


def test_a_coast_finer_than_the_cells_is_refused() -> None:
    points, cells = cells_of_sea(Coastline([wavy_ring(2000, amplitude=0.3, waves=15)]), 60, "fibonacci")
    with pytest.raises(MeshError, match="ask for more cells, or for a smoother coast"):
        sea_mesh(cells, points)
    corners, faulty = corners_and_faults(cells)
    sizes = np.diff(corners.starts)
    assert 0 < np.count_nonzero(faulty) < cells.n_cells
    assert faulty[(cells.loops > 1) | (sizes < 3)].all()


def test_an_island_within_a_cell_is_refused() -> None:
    coast = wavy_sea(60, island=False)
    points, _ = cells_of_sea(coast, 60, "fibonacci")
    longitude, latitude = np.arctan2(points[30, 1], points[30, 0]), np.arcsin(points[30, 2])
    pierced = Coastline([coast.points, wavy_ring(20, (longitude, latitude + 0.02), 0.01, 0.0, sea_within=False)])
    cells = SeaCells(points, pierced, fillers(pierced, sea_spacing(pierced, 60)))
    with pytest.raises(MeshError, match="cell 30 is in several parts or goes round an island"):
        sea_mesh(cells, points)
    assert np.flatnonzero(corners_and_faults(cells)[1]).tolist() == [30]


def test_a_generator_on_land_is_refused() -> None:
    coast = wavy_sea(60, island=False)
    points, _ = cells_of_sea(coast, 60, "fibonacci")
    points[7] = -points.mean(axis=0) / np.linalg.norm(points.mean(axis=0))
    with pytest.raises(MeshError, match="generator 7 stands on land"):
        sea_mesh(SeaCells(points, coast, fillers(coast, sea_spacing(coast, 60))), points)

"""Meshes with walls are validated and measured like others: on what is there, and wherever their walls stand."""

import warnings
from dataclasses import replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from numpy.typing import NDArray

from mesh import MeshError, VoronoiMesh, mesh_from_points, mesh_quality, read_mesh, validate_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES, dimension_sizes
from mesh.discrete.connectivity import validate_topology
from mesh.discrete.metrics import AtWalls, at_walls_of, compute_metrics
from mesh.discrete.quality import edge_chords, neighbour_distance_ratio, triangle_quality
from mesh.discrete.topology import connect
from mesh.discrete.walls import boundary_vertices, seas_and_coasts, wall_edges
from mesh.geometry.sphere import arc_length, mean_spacing, normalize
from mesh.parts.culling import culled
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES

EARTH = 6371229.0


def southern(mesh: VoronoiMesh) -> NDArray[np.bool_]:
    """All but a northern cap and a single cell."""
    kept = mesh.lat_cell < 0.6
    kept[np.argmin(mesh.lat_cell)] = False
    return kept


@pytest.fixture
def sea(any_mesh: VoronoiMesh) -> VoronoiMesh:
    return culled(any_mesh, southern(any_mesh))


@pytest.mark.parametrize("radius", [1.0, EARTH])
def test_all_that_holds_of_a_sphere_holds_of_a_part(sea: VoronoiMesh, radius: float) -> None:
    residuals = validate_mesh(sea.scaled(radius))
    assert len(residuals) == 7
    assert max(residuals.values()) < 1e-13


def test_seas_and_coasts_are_counted(icosahedral_mesh: VoronoiMesh) -> None:
    latitude = icosahedral_mesh.lat_cell
    assert seas_and_coasts(icosahedral_mesh) == (1, 0)
    for kept, expected in (
        (southern(icosahedral_mesh), (1, 2)),
        (np.abs(latitude) > 0.3, (2, 2)),
        (np.abs(latitude) < 0.3, (1, 2)),
        (np.arange(642) == 5, (1, 1)),
    ):
        sea = culled(icosahedral_mesh, kept)
        assert seas_and_coasts(sea) == expected
        assert sea.n_vertices - sea.n_edges + sea.n_cells == 2 * expected[0] - expected[1]


def test_a_part_of_a_ring_is_none_of_a_sphere() -> None:
    """Twelve by twelve cells that meet in triangles, and whose opposite sides meet, without one of them."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(12), np.arange(12)))

    def number(right: int, up: int) -> NDArray[np.int64]:
        return (x + right) % 12 + 12 * ((y + up) % 12)

    lower = np.stack([number(0, 0), number(1, 0), number(1, 1)], axis=1)
    upper = np.stack([number(0, 0), number(1, 1), number(0, 1)], axis=1)
    triangles = np.concatenate([lower, upper])
    triangles = np.array([np.roll(row, -int(np.argmin(row))) for row in triangles])
    topology = connect(triangles, 144)
    sizes = dimension_sizes(topology)
    nothing = {
        variable.name: np.zeros([sizes[dimension] for dimension in variable.dimensions])
        for variable in MESH_VARIABLES
        if variable.name not in TOPOLOGY_NAMES
    }
    ring = VoronoiMesh(**{name: getattr(topology, name) for name in TOPOLOGY_NAMES}, **nothing, sphere_radius=1.0)
    with pytest.raises(MeshError, match=r"are no part of a sphere: on one, 1 separate seas with 1 coasts have"):
        validate_topology(culled(ring, np.arange(144) > 0))


@pytest.mark.parametrize(
    ("name", "row", "value", "sentence"),
    [
        ("boundary_vertex", "boundary", 0, "boundaryVertex is not 1 where cellsOnVertex lacks a cell"),
        ("boundary_vertex", "inner", 1, "boundaryVertex is not 1 where cellsOnVertex lacks a cell"),
        ("cells_on_edge", "wall", (-1, 3), "cellsOnEdge has no first cell; an edge at a wall has it first"),
        ("cells_on_vertex", "boundary", (-1, -1, -1), "cellsOnVertex names no cell"),
        ("edges_on_vertex", "inner", (-1, 3, 4), "edgesOnVertex|cellsOnVertex does not lie between"),
        ("n_edges_on_edge", "wall", 10, "nEdgesOnEdge is not the number of other edges of the two cells"),
        ("vertices_on_edge", "wall", None, "verticesOnEdge does not run along the tangent"),
    ],
)
def test_wrong_connectivity_beside_walls_is_told(
    icosahedral_mesh: VoronoiMesh, name: str, row: str, value: object, sentence: str
) -> None:
    sea = culled(icosahedral_mesh, southern(icosahedral_mesh))
    rows = {"boundary": boundary_vertices(sea), "inner": ~boundary_vertices(sea)}
    place = wall_edges(sea)[4] if row == "wall" else np.flatnonzero(rows[row])[4]
    values = getattr(sea, name).copy()
    values[place] = values[place][::-1] if value is None else value
    with pytest.raises(MeshError, match=sentence):
        validate_mesh(replace(sea, **{name: values}))


def with_other_walls(sea: VoronoiMesh) -> VoronoiMesh:
    """`sea` with its coast elsewhere: vertices moved, points of walls between them, the land at another distance, and
    the area of cells beside it shared among their vertices in another way."""
    random = np.random.default_rng(5)
    given, boundary = at_walls_of(sea), boundary_vertices(sea)
    assert given is not None
    assert given.kites is not None
    size = 0.05 * mean_spacing(642)
    vertices = given.vertices.copy()
    vertices[boundary] = normalize(vertices[boundary] + size * random.normal(size=(boundary.sum(), 3)))
    ends = vertices[sea.vertices_on_edge]
    kites = given.kites * random.uniform(0.8, 1.3, given.kites.shape)
    at_walls = AtWalls(vertices, normalize(ends.sum(axis=1)), 1.2 * given.dc_edge, kites)
    metrics = compute_metrics(normalize(sea.cell_points), sea, at_walls)
    return replace(sea, **{name: getattr(metrics, name) for name in METRICS_NAMES})


def test_walls_may_stand_anywhere(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """As those of cells that a coast cuts: their vertices are no circumcentres, their points no feet."""
    sea = with_other_walls(culled(icosahedral_mesh, southern(icosahedral_mesh)))
    residuals = validate_mesh(sea)
    assert max(residuals.values()) < 1e-13
    write_mesh(sea, tmp_path / "sea.nc")
    with netCDF4.Dataset(tmp_path / "sea.nc") as file:
        assert "validated_hash" not in file.ncattrs()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read = read_mesh(tmp_path / "sea.nc")
        rebuilt = read_mesh(tmp_path / "sea.nc", recompute_metrics=True)
    for variable in MESH_VARIABLES:
        np.testing.assert_array_equal(getattr(read, variable.name), getattr(sea, variable.name), err_msg=variable.name)
        np.testing.assert_array_equal(getattr(rebuilt, variable.name), getattr(sea, variable.name))


def test_weights_beside_walls_must_be_antisymmetric(icosahedral_mesh: VoronoiMesh) -> None:
    sea = culled(icosahedral_mesh, southern(icosahedral_mesh))
    beside = np.flatnonzero(np.isin(sea.cells_on_edge[:, 0], sea.cells_on_edge[wall_edges(sea), 0]))
    edge = beside[sea.cells_on_edge[beside, 1] >= 0][0]
    inner = np.flatnonzero(sea.cells_on_edge[sea.edges_on_edge[edge, : sea.n_edges_on_edge[edge]], 1] >= 0)[0]
    weights = sea.weights_on_edge.copy()
    weights[edge, inner] += 1e-8  # less than files of others may be off
    with pytest.raises(MeshError, match="antisymmetry of weightsOnEdge holds only to"):
        validate_mesh(replace(sea, weights_on_edge=weights))


def test_quality_is_that_of_what_is_there(any_mesh: VoronoiMesh, sea: VoronoiMesh) -> None:
    """Distances, triangles and centroids that are left are those of the whole mesh."""
    kept = southern(any_mesh)
    cells = np.append(kept, False)
    pairs, triangles = cells[any_mesh.cells_on_edge].all(axis=1), cells[any_mesh.cells_on_vertex].all(axis=1)
    chords, whole, part = edge_chords(any_mesh), mesh_quality(any_mesh), mesh_quality(sea)
    assert part.cells == kept.sum()
    assert part.mu == chords[pairs].max() / chords[pairs].min()
    np.testing.assert_array_equal(edge_chords(sea)[sea.cells_on_edge[:, 1] >= 0], chords[pairs])
    q = triangle_quality(any_mesh)[triangles]
    assert (part.q_min, part.q_avg) == (q.min(), pytest.approx(q.mean(), rel=1e-14))
    assert np.isnan(triangle_quality(sea)).sum() == sea.boundary_vertex.sum()
    sigma, expected = neighbour_distance_ratio(sea), neighbour_distance_ratio(any_mesh)[kept]
    alone = (sea.cells_on_cell < 0).sum(axis=1) > (any_mesh.cells_on_cell[kept] < 0).sum(axis=1)
    np.testing.assert_array_equal(sigma[~alone], expected[~alone])
    assert np.all((sigma >= expected) | np.isnan(sigma))
    assert part.sigma_min == np.nanmin(sigma)
    area = sea.area_cell.sum() / (4.0 * np.pi)
    assert part.residual * mean_spacing(sea.n_cells) * np.sqrt(area) <= whole.residual * mean_spacing(642) * 10
    assert part.obtuse <= whole.obtuse


def test_the_residual_of_a_sea_is_that_of_its_cells() -> None:
    """All cells of random points are far from their centroids; that of the farthest is told, in mean spacings."""
    mesh = mesh_from_points(np.random.default_rng(2).normal(size=(300, 3)))
    everywhere = mesh_quality(mesh)
    one_gone = culled(mesh, np.arange(300) != 17)
    corners = normalize(mesh.vertex_points)[mesh.vertices_on_cell[17, : mesh.n_edges_on_cell[17]]]
    assert arc_length(mesh.cell_points[17], corners).max() < 0.5
    spacing = mean_spacing(299) * np.sqrt(one_gone.area_cell.sum() / (4.0 * np.pi))
    assert mesh_quality(one_gone).residual * spacing == pytest.approx(everywhere.residual * mean_spacing(300), rel=1e-9)


def test_one_cell_alone_has_no_distances(icosahedral_mesh: VoronoiMesh) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lonely = mesh_quality(culled(icosahedral_mesh, np.arange(642) == 5))
    assert np.isnan([lonely.mu, lonely.sigma_avg, lonely.sigma_min, lonely.q_avg, lonely.q_min]).all()
    assert (lonely.cells, lonely.obtuse, lonely.area_ratio) == (1, 0, 1.0)
    assert lonely.residual < 1e-5

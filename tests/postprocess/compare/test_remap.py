"""Smooth fields come through remapping with an error of third order, on any mesh and at the poles too."""

import numpy as np
import pytest

from mesh import VoronoiMesh, mesh_from_points, scvt_mesh
from mesh.discrete.operators import vertex_to_cell
from mesh.geometry.sphere import dot, east_north, from_lonlat, to_lonlat
from mesh.parts.culling import culled
from postprocess.compare import remap
from postprocess.compare.remap import remap_cells, remap_vertices

AXIS = np.array([0.48, -0.6, 0.64])


def field(longitude: np.ndarray, latitude: np.ndarray) -> np.ndarray:
    """A smooth field without symmetry."""
    x, y, z = np.moveaxis(from_lonlat(longitude, latitude), -1, 0)
    return np.exp(x) * np.sin(3 * y + z)


@pytest.fixture(scope="module")
def points() -> tuple[np.ndarray, np.ndarray]:
    return to_lonlat(np.random.default_rng(3).normal(size=(4000, 3)))


def errors(mesh: VoronoiMesh, longitude: np.ndarray, latitude: np.ndarray) -> np.ndarray:
    """Root mean square and largest errors from cells, then from vertices."""
    from_cells = remap_cells(mesh, longitude, latitude).scalar(field(mesh.lon_cell, mesh.lat_cell))
    from_vertices = remap_vertices(mesh, longitude, latitude).scalar(field(mesh.lon_vertex, mesh.lat_vertex))
    exact = field(longitude, latitude)
    return np.array(
        [(np.sqrt(np.mean((each - exact) ** 2)), np.abs(each - exact).max()) for each in (from_cells, from_vertices)]
    ).ravel()


def test_order_on_uniform_meshes(icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh, points) -> None:
    """Measured from 642 to 2562 cells: 2.94 and 2.90 from cells, 3.01 and 3.05 from vertices."""
    order = np.log2(errors(icosahedral_mesh, *points) / errors(larger_mesh, *points))
    assert np.all(order > 2.7), order


def test_order_on_refined_meshes(refined_mesh: VoronoiMesh, points) -> None:
    coarse = errors(scvt_mesh(250, density="refined-circle", tolerance=1e-3), *points)
    order = np.log2(coarse / errors(refined_mesh, *points)) * np.log(2) / np.log(np.sqrt(1000 / 250))
    assert np.all(order[[0, 2]] > 2.6), order


def test_constants_and_the_sites_own_values_are_kept(any_mesh: VoronoiMesh, points) -> None:
    random = np.random.default_rng(0)
    for remapping, n_sites, sites in (
        (remap_cells, any_mesh.n_cells, (any_mesh.lon_cell, any_mesh.lat_cell)),
        (remap_vertices, any_mesh.n_vertices, (any_mesh.lon_vertex, any_mesh.lat_vertex)),
    ):
        np.testing.assert_allclose(remapping(any_mesh, *points).scalar(np.ones(n_sites)), 1.0, rtol=1e-12)
        values = random.normal(size=n_sites)
        separate = np.unique(np.round(from_lonlat(*sites), 9), axis=0, return_index=True)[1]  # symmetric meshes
        np.testing.assert_array_equal(remapping(any_mesh, *sites).scalar(values)[separate], values[separate])


def test_cells_with_few_neighbours_use_a_second_ring(monkeypatch: pytest.MonkeyPatch, points) -> None:
    """With three or four neighbours alone five coefficients are not determined; the error is much larger."""
    mesh = mesh_from_points(np.random.default_rng(5).normal(size=(1500, 3)))
    nearest = (from_lonlat(*points) @ mesh.cell_points.T).argmax(axis=1)
    few = mesh.n_edges_on_cell[nearest] < 5
    assert np.count_nonzero(few) > 100

    def mean_error() -> float:
        found = remap_cells(mesh, *points).scalar(field(mesh.lon_cell, mesh.lat_cell))
        return float(np.mean(np.abs(found - field(*points))[few]))

    with_second_ring = mean_error()
    monkeypatch.setattr(remap, "N_TERMS", 0)
    assert with_second_ring < 0.5 * mean_error()


def test_fit_to_vertices_has_no_smoothing(larger_mesh: VoronoiMesh, points) -> None:
    """The mean over cells, as `vertex_to_cell` makes it, is more than five times further off."""
    at_cells = vertex_to_cell(larger_mesh, field(larger_mesh.lon_vertex, larger_mesh.lat_vertex))
    through_cells = remap_cells(larger_mesh, *points).scalar(at_cells) - field(*points)
    _, _, root_mean_square, _ = errors(larger_mesh, *points)
    assert np.sqrt(np.mean(through_cells**2)) > 5 * root_mean_square


def test_values_of_a_sea_come_from_the_sea(larger_mesh: VoronoiMesh, points) -> None:
    """Away from walls they are those of the whole mesh; beside them, fits lean to one side."""
    sea = culled(larger_mesh, larger_mesh.lat_cell < 0.5)
    longitude, latitude = points
    south = latitude < 0.3
    for remapping, place in ((remap_cells, "cell"), (remap_vertices, "vertex")):
        found, expected = (
            remapping(mesh, longitude, latitude).scalar(
                field(getattr(mesh, f"lon_{place}"), getattr(mesh, f"lat_{place}"))
            )
            for mesh in (sea, larger_mesh)
        )
        np.testing.assert_allclose(found[south], expected[south], rtol=0.0, atol=1e-13)
        coast = (latitude > 0.4) & (latitude < 0.48)
        assert np.abs(found - field(longitude, latitude))[coast].max() < 0.02


def test_vectors_know_no_poles(larger_mesh: VoronoiMesh) -> None:
    """Rotation about an oblique axis blows across the poles; next to them it is remapped as well as elsewhere."""

    def components(longitude: np.ndarray, latitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        east, north = east_north(longitude, latitude)
        velocity = np.cross(AXIS, from_lonlat(longitude, latitude))
        return dot(velocity, east), dot(velocity, north)

    def largest_error(longitude: np.ndarray, latitude: np.ndarray) -> float:
        to_points = remap_cells(larger_mesh, longitude, latitude)
        found = to_points.vector(*components(larger_mesh.lon_cell, larger_mesh.lat_cell))
        return float(np.abs(np.subtract(found, components(longitude, latitude))).max())

    longitude = np.linspace(0, 2 * np.pi, 50)
    elsewhere = largest_error(longitude, np.linspace(-1, 1, 50))
    assert elsewhere < 1e-5
    for degrees in (90, 89.9, 88, -86):
        assert largest_error(longitude, np.full(50, np.radians(degrees))) < 2 * elsewhere

import numpy as np
import pytest

from mesh import VoronoiMesh, scvt_mesh
from mesh.arrays import Array
from mesh.geometry.sphere import dot, east_north, from_lonlat, to_lonlat
from mesh.integrals.moments import SMALL, _small_integrand
from mesh.integrals.quadrature import cell_means, sample_cells


def harmonic(longitude: Array, latitude: Array) -> Array:
    """Spherical harmonic of degree 4 and order 3, not normalised."""
    return np.cos(latitude) ** 3 * np.sin(latitude) * np.cos(3.0 * longitude + 0.3)


def exponential(longitude: Array, latitude: Array) -> Array:
    """exp(k.x), whose integral over the unit sphere is 4 pi sinh(|k|) / |k|."""
    return np.exp(from_lonlat(longitude, latitude) @ np.array([1.0, -2.0, 2.0]))


def test_mean_of_a_constant_is_the_constant(any_mesh: VoronoiMesh) -> None:
    means = cell_means(any_mesh.scaled(6.4e6), lambda longitude, latitude: np.full(longitude.shape, 5.3))
    np.testing.assert_allclose(means, 5.3, rtol=1e-14)


def test_means_integrate_over_the_sphere_with_sixth_order(icosahedral_mesh: VoronoiMesh) -> None:
    exact = 4.0 * np.pi * np.sinh(3.0) / 3.0
    errors = []
    for mesh in (scvt_mesh(42), scvt_mesh(162), icosahedral_mesh):
        errors.append(abs(np.sum(mesh.area_cell * cell_means(mesh, exponential)) - exact) / exact)
    assert errors[0] > 32.0 * errors[1] > 32.0**2 * errors[2]
    assert 0.0 < errors[2] < 1e-7


def test_mean_is_that_of_many_points_of_the_cell(icosahedral_mesh: VoronoiMesh) -> None:
    """Random points of the tangent plane of a cell, those nearest to its centre: an independent estimate."""
    mesh, cell, count = icosahedral_mesh, 17, 400_000
    neighbours = mesh.cells_on_cell[cell, : mesh.n_edges_on_cell[cell]]
    center, tangents = mesh.cell_points[cell], np.stack(east_north(mesh.lon_cell[cell], mesh.lat_cell[cell]))
    flat = center + np.random.default_rng(0).uniform(-0.12, 0.12, (count, 2)) @ tangents
    flat = flat[np.all((flat @ center)[:, None] >= flat @ mesh.cell_points[neighbours].T, axis=1)]
    estimate = np.average(harmonic(*to_lonlat(flat)), weights=dot(flat, flat) ** -1.5)
    found, at_center = cell_means(mesh, harmonic)[cell], sample_cells(mesh, harmonic, "point")[cell]
    assert found == pytest.approx(estimate, abs=2e-4)
    assert abs(found - at_center) > 1e-3


def test_mean_differs_from_the_value_at_the_centre_by_the_square_of_the_width(
    icosahedral_mesh: VoronoiMesh, larger_mesh: VoronoiMesh
) -> None:
    differences = []
    for mesh in (scvt_mesh(162), icosahedral_mesh, larger_mesh):
        difference = sample_cells(mesh, harmonic, "mean") - sample_cells(mesh, harmonic, "point")
        differences.append(np.sqrt(np.mean(difference**2)))
    orders = np.log2(np.array(differences[:-1]) / differences[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


def test_chunks_do_not_matter(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = cell_means(icosahedral_mesh, harmonic)
    monkeypatch.setattr("mesh.integrals.quadrature.CHUNK", 100)
    np.testing.assert_array_equal(cell_means(icosahedral_mesh, harmonic), whole)


def test_unknown_sampling_is_refused(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.raises(ValueError, match="no sampling named 'median'"):
        sample_cells(icosahedral_mesh, harmonic, "median")  # type: ignore[arg-type]


@pytest.mark.parametrize(("drop", "sag"), [(1.0, 0.0), (0.6, 0.4), (0.5, 0.5), (0.2, 0.8)])
def test_series_of_the_integrand_is_exact_where_it_is_used(drop: float, sag: float) -> None:
    d, e = SMALL * drop, SMALL * sag
    exact = 2.0 * (d - e) / ((2.0 - d - e) * (1.0 - e) ** 2)
    # What is left out is of the fourth order.
    assert _small_integrand(d, e) == pytest.approx(exact, rel=6.0 * SMALL**4, abs=0.0)

"""Identities of the discrete calculus on every family of meshes, and consistency on smooth fields."""

import numpy as np
import pytest

from mesh import VoronoiMesh, build_operators, scvt_mesh
from mesh.discrete.operators import normal_velocity_from_streamfunction, velocity_at_cells, vertex_to_cell
from mesh.geometry.sphere import dot, east_north


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(7)


def edge_normals(mesh: VoronoiMesh) -> np.ndarray:
    east, north = east_north(mesh.lon_edge, mesh.lat_edge)
    return np.cos(mesh.angle_edge)[:, None] * east + np.sin(mesh.angle_edge)[:, None] * north


def test_curl_of_gradient_vanishes(any_mesh: VoronoiMesh, random: np.random.Generator) -> None:
    operators = build_operators(any_mesh)
    gradient = operators.gradient @ random.normal(size=any_mesh.n_cells)
    circulation = any_mesh.area_triangle * (operators.curl @ gradient)
    assert np.abs(circulation).max() < 1e-13
    assert np.abs(gradient * any_mesh.dc_edge).max() > 1.0


def test_divergence_and_gradient_are_adjoint(any_mesh: VoronoiMesh, random: np.random.Generator) -> None:
    operators = build_operators(any_mesh)
    h, flux = random.normal(size=any_mesh.n_cells), random.normal(size=any_mesh.n_edges)
    left = np.sum(any_mesh.area_cell * h * (operators.divergence @ flux))
    right = np.sum(any_mesh.dc_edge * any_mesh.dv_edge * flux * (operators.gradient @ h))
    assert left == pytest.approx(-right, rel=1e-11)
    assert abs(left) > 1e-3


def test_perp_is_antisymmetric(any_mesh: VoronoiMesh) -> None:
    perp = build_operators(any_mesh).perp.tocoo()
    work = perp.copy()
    work.data = perp.data * (any_mesh.dc_edge * any_mesh.dv_edge)[perp.row]
    work = work.tocsr()
    assert abs(work + work.T).max() < 1e-14
    assert abs(work).max() > 1e-4


def test_coriolis_flux_does_no_work(any_mesh: VoronoiMesh, random: np.random.Generator) -> None:
    perp = build_operators(any_mesh).perp
    q, F = random.normal(size=any_mesh.n_edges), random.normal(size=any_mesh.n_edges)
    Q = 0.5 * (q * (perp @ F) + perp @ (q * F))
    work = any_mesh.dc_edge * any_mesh.dv_edge * F * Q
    assert abs(work.sum()) < 1e-13 * np.abs(work).sum()
    one_sided = any_mesh.dc_edge * any_mesh.dv_edge * F * q * (perp @ F)
    assert abs(one_sided.sum()) > 1e-6 * np.abs(one_sided).sum()


def test_perp_of_divergence_free_flux_is_divergence_free_on_triangles(any_mesh: VoronoiMesh) -> None:
    psi = np.random.default_rng(1).normal(size=any_mesh.n_vertices)
    operators = build_operators(any_mesh)
    # Taken as fluxes u l: lengths of edges may vanish on symmetric meshes.
    tail, head = any_mesh.vertices_on_edge.T
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.where(any_mesh.dv_edge > 1e-9, -(psi[head] - psi[tail]) / any_mesh.dv_edge, 0.0)
    flux = u * any_mesh.dv_edge
    divergence = any_mesh.area_cell * (operators.divergence @ u)
    if np.all(any_mesh.dv_edge > 1e-9):
        assert np.abs(divergence).max() < 1e-12
        outflow = any_mesh.area_triangle * (operators.curl @ (operators.perp @ u))
        assert np.abs(outflow).max() < 1e-12 * np.abs(u * any_mesh.dc_edge).max()
    assert np.abs(flux).max() > 0.1


def test_divergence_of_perp_on_triangles_is_the_kite_mean_on_cells(any_mesh: VoronoiMesh) -> None:
    operators = build_operators(any_mesh)
    flux = np.random.default_rng(2).normal(size=any_mesh.n_edges)
    # With k x n along the tangent, the dual outflow of the tangential flux is minus its curl-like sum.
    on_triangles = operators.curl @ (operators.perp @ flux)
    expected = -(operators.cell_to_vertex @ (operators.divergence @ flux))
    scale = np.abs(any_mesh.dc_edge[any_mesh.edges_on_vertex]).sum(axis=1) / any_mesh.area_triangle
    assert (np.abs(on_triangles - expected) / scale).max() < 1e-13


def test_means_keep_constants(any_mesh: VoronoiMesh) -> None:
    operators = build_operators(any_mesh)
    ones = np.ones(any_mesh.n_cells)
    np.testing.assert_allclose(operators.cell_to_edge @ ones, 1.0, rtol=1e-14)
    np.testing.assert_allclose(operators.cell_to_vertex @ ones, 1.0, rtol=1e-11)
    np.testing.assert_allclose(operators.vertex_to_edge @ np.ones(any_mesh.n_vertices), 1.0, rtol=1e-14)
    np.testing.assert_allclose(vertex_to_cell(any_mesh, np.ones(any_mesh.n_vertices)), 1.0, rtol=1e-11)


def test_vorticity_sums_to_zero(any_mesh: VoronoiMesh, random: np.random.Generator) -> None:
    u = random.normal(size=any_mesh.n_edges)
    vorticity = any_mesh.area_triangle * (build_operators(any_mesh).curl @ u)
    assert abs(vorticity.sum()) < 1e-14 * np.abs(vorticity).sum()


def solid_rotation(mesh: VoronoiMesh) -> tuple[np.ndarray, np.ndarray]:
    """Unit rotation about an oblique axis: velocity at edges (n_edges, 3) and the axis."""
    axis = np.array([0.48, -0.6, 0.64])
    return np.cross(axis, mesh.edge_points), axis


def test_signs_and_sizes_on_solid_rotation(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    operators = build_operators(mesh)
    velocity, axis = solid_rotation(mesh)
    normal = edge_normals(mesh)
    u = dot(velocity, normal)
    np.testing.assert_allclose(operators.curl @ u, 2 * mesh.vertex_points @ axis, atol=0.03)
    np.testing.assert_allclose(operators.divergence @ u, 0.0, atol=0.02)
    tangential = dot(velocity, np.cross(mesh.edge_points, normal))
    np.testing.assert_allclose(operators.perp @ u, tangential, atol=0.03)
    speed = np.linalg.norm(np.cross(axis, mesh.cell_points), axis=1)
    np.testing.assert_allclose(operators.kinetic_energy @ u**2, 0.5 * speed**2, atol=0.02)
    zonal, meridional = velocity_at_cells(mesh, u)
    east, north = east_north(mesh.lon_cell, mesh.lat_cell)
    np.testing.assert_allclose(zonal, dot(np.cross(axis, mesh.cell_points), east), atol=0.01)
    np.testing.assert_allclose(meridional, dot(np.cross(axis, mesh.cell_points), north), atol=0.01)


def test_streamfunction_velocity(icosahedral_mesh: VoronoiMesh) -> None:
    mesh = icosahedral_mesh
    velocity, axis = solid_rotation(mesh)
    u = normal_velocity_from_streamfunction(mesh, -mesh.vertex_points @ axis)
    np.testing.assert_allclose(u, dot(velocity, edge_normals(mesh)), atol=0.01)
    assert np.abs(build_operators(mesh).divergence @ u).max() < 1e-12


def errors_of_operators(mesh: VoronoiMesh) -> dict[str, float]:
    """l2 errors of gradient, divergence, curl and perp on x y and the flows that it generates."""
    operators = build_operators(mesh)

    def gradient_of_xy(points: np.ndarray) -> np.ndarray:
        slope = np.stack([points[:, 1], points[:, 0], 0 * points[:, 0]], axis=1)
        return slope - dot(slope, points)[:, None] * points

    normal = edge_normals(mesh)
    slope = gradient_of_xy(mesh.edge_points)
    tangent = np.cross(mesh.edge_points, normal)
    x, y = mesh.cell_points[:, 0], mesh.cell_points[:, 1]
    laplacian_cell = -6.0 * x * y  # a spherical harmonic of degree 2
    laplacian_vertex = -6.0 * mesh.vertex_points[:, 0] * mesh.vertex_points[:, 1]
    rotated = np.cross(mesh.edge_points, slope)

    def l2(error: np.ndarray, area: np.ndarray) -> float:
        return float(np.sqrt(np.sum(area * error**2) / np.sum(area)))

    area_edge = mesh.dc_edge * mesh.dv_edge
    return {
        "gradient": l2(operators.gradient @ (x * y) - dot(slope, normal), area_edge),
        "divergence": l2(operators.divergence @ dot(slope, normal) - laplacian_cell, mesh.area_cell),
        "curl": l2(operators.curl @ dot(rotated, normal) - laplacian_vertex, mesh.area_triangle),
        "perp": l2(operators.perp @ dot(slope, normal) - dot(slope, tangent), area_edge),
    }


def test_operators_converge_on_scvts(larger_mesh: VoronoiMesh) -> None:
    coarse, fine = errors_of_operators(scvt_mesh(642)), errors_of_operators(larger_mesh)
    order = {name: np.log2(coarse[name] / fine[name]) for name in coarse}
    # The C-grid gradient is of second order, the others between first and second in l2 (Ringler et al. 2010).
    assert order["gradient"] > 1.9
    for name in ("divergence", "curl", "perp"):
        assert order[name] > 0.9, (name, order[name])

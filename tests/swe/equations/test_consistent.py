"""The consistent scheme: exact where its name says so, and with the flux that belongs to its energy."""

import numpy as np
import pytest
from scipy.spatial import Voronoi

from mesh import VoronoiMesh, mesh_from_points
from mesh.arrays import Array
from mesh.discrete.operators import normal_velocity_from_streamfunction
from mesh.generation.generators import icosahedral_points
from swe.equations.consistent import Consistent, _kinetic_energy, _velocities
from swe.equations.schemes import Ringler2010, Scheme


def cell_of_a_plane(points: Array) -> tuple[Array, ...]:
    """Sides of the Voronoi cell of the first of `points`: unit normals, middles, distances, lengths, and its area."""
    found = Voronoi(points)
    pairs = [
        (sum(pair), ends)
        for pair, ends in zip(found.ridge_points.tolist(), found.ridge_vertices, strict=True)
        if 0 in pair
    ]
    towards = np.array([points[other] - points[0] for other, _ in pairs])
    ends = np.array([found.vertices[ends] for _, ends in pairs]) - points[0]
    distance = np.linalg.norm(towards, axis=1)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    area = 0.25 * (length * distance).sum()
    return towards / distance[:, None], ends.mean(axis=1), distance, length, np.array([area])


def energies(points: Array, u: Array) -> tuple[float, Array, Array]:
    """K, v and y of the cell of the first of `points` from the velocities `u` out of its sides."""
    normal, middle, distance, length, area = cell_of_a_plane(points)
    sides = len(u)
    rings = np.array([sides]), np.arange(sides)[None], np.ones((1, sides), np.int8)
    arrays = (u, *rings, distance, length, area, normal[None], middle[None])
    K, v, y = np.empty(1), np.empty((1, 2)), np.empty((1, 2))
    _kinetic_energy(*arrays, K)
    _velocities(*arrays, v, y)
    return float(K[0]), v[0], y[0]


@pytest.mark.parametrize("seed", range(5))
def test_uniform_flow_in_the_plane_is_exact_in_any_cell(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = np.vstack([[0.1, -0.2], random.uniform(-3.0, 3.0, (60, 2))])
    normal, *_ = cell_of_a_plane(points)
    wind = random.uniform(-20.0, 20.0, 2)
    K, v, y = energies(points, normal @ wind)
    assert pytest.approx(0.5 * wind @ wind, rel=1e-12) == K
    np.testing.assert_allclose(v, wind, rtol=1e-11)
    np.testing.assert_allclose(y, wind, rtol=1e-11)


def test_a_regular_hexagon_has_the_energy_of_ringler() -> None:
    angles = np.pi / 3.0 * np.arange(6) + 0.3
    points = np.vstack([[0.0, 0.0], *(2.0 * np.array([np.cos(a), np.sin(a)]) for a in angles)])
    far = np.vstack([points, *(6.0 * np.array([np.cos(a), np.sin(a)]) for a in angles)])
    u = np.random.default_rng(1).uniform(-5.0, 5.0, 6)
    _, _, distance, length, area = cell_of_a_plane(far)
    assert pytest.approx(float((length * distance * u**2).sum() / (4.0 * area[0])), rel=1e-13) == energies(far, u)[0]


def matrix_of_flux(mesh: VoronoiMesh) -> Array:
    """The matrix from u to F over a layer 1 m thick."""
    scheme, columns = Consistent(mesh), []
    for edge in range(mesh.n_edges):
        u, F = np.zeros(mesh.n_edges), np.empty(mesh.n_edges)
        u[edge] = 1.0
        scheme.flux(np.ones(mesh.n_cells), u, F)
        columns.append(F)
    return np.array(columns).T


def test_the_flux_is_a_symmetric_positive_matrix_near_one(any_mesh: VoronoiMesh) -> None:
    weight = any_mesh.dc_edge * any_mesh.dv_edge
    form = matrix_of_flux(any_mesh) * weight[:, None]
    np.testing.assert_allclose(form, form.T, atol=1e-14 * weight.max(), rtol=0)
    there = weight > 1e-9 * weight.max()
    assert np.linalg.eigvalsh(form[np.ix_(there, there)]).min() > 0.0


def test_rows_of_the_flux_are_near_one_on_a_good_mesh(icosahedral_mesh: VoronoiMesh) -> None:
    matrix = matrix_of_flux(icosahedral_mesh)
    assert np.abs(np.diag(matrix) - 1.0).max() < 6e-3
    entries = (np.abs(matrix) > 1e-15).sum(axis=1)
    sides = icosahedral_mesh.n_edges_on_cell[icosahedral_mesh.cells_on_edge].sum(axis=1)
    np.testing.assert_array_equal(np.minimum(entries, sides - 1), entries)
    assert entries.max() == 11


def error_of_energy(level: int, scheme: type[Scheme]) -> float:
    """Largest error of K, relative to its largest value, in a flow like a turning solid, on a mesh from bisection."""
    mesh = mesh_from_points(icosahedral_points(level))
    mesh = mesh.scaled(6.4e6)
    pole = np.array([0.6, 0.0, 0.8])
    u = normal_velocity_from_streamfunction(mesh, -20.0 * (mesh.vertex_points @ pole))
    speed = 20.0 * np.linalg.norm(np.cross(pole, mesh.cell_points / mesh.sphere_radius), axis=1)
    K = np.empty(mesh.n_cells)
    scheme(mesh).kinetic_energy(u, K)
    return float(np.abs(K - 0.5 * speed**2).max() / 200.0)


def test_the_energy_converges_at_every_cell() -> None:
    ours, theirs = ([error_of_energy(level, scheme) for level in (3, 4, 5)] for scheme in (Consistent, Ringler2010))
    assert min(ours[0] / ours[1], ours[1] / ours[2]) > 1.95
    assert ours[2] < 2e-3
    assert max(theirs[0] / theirs[1], theirs[1] / theirs[2]) < 1.05

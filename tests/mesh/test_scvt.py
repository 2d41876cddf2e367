import numpy as np
import pytest

from mesh import MeshError, mesh_quality, scvt_mesh
from mesh.delaunay import delaunay, half_edge_twins
from mesh.generators import fibonacci_points, icosahedral_points
from mesh.scvt import mass_and_moment, optimize, tessellate
from mesh.sphere import normalize


def test_mass_and_moment_agree_with_sampling() -> None:
    points = normalize(np.random.default_rng(0).normal(size=(40, 3)))
    triangles = delaunay(points)
    mass, moment = mass_and_moment(points, triangles, half_edge_twins(triangles))
    samples = fibonacci_points(2_000_000)
    owner = np.concatenate([np.argmax(part @ points.T, axis=1) for part in np.array_split(samples, 20)])
    weight = 4 * np.pi / len(samples)
    np.testing.assert_allclose(mass, weight * np.bincount(owner, minlength=40), atol=2e-4)
    sampled = np.stack([weight * np.bincount(owner, samples[:, k], 40) for k in range(3)], axis=1)
    np.testing.assert_allclose(moment, sampled, atol=2e-4)


def test_masses_sum_to_the_sphere_and_moments_to_zero() -> None:
    points = normalize(np.random.default_rng(5).normal(size=(300, 3)))
    triangles = delaunay(points)
    mass, moment = mass_and_moment(points, triangles, half_edge_twins(triangles))
    assert mass.sum() == pytest.approx(4 * np.pi, rel=1e-13)
    np.testing.assert_allclose(moment.sum(axis=0), 0.0, atol=1e-13)


def test_gradient_is_the_derivative_of_the_energy() -> None:
    points = normalize(np.random.default_rng(2).normal(size=(60, 3)))
    direction = np.random.default_rng(3).normal(size=(60, 3))
    here = tessellate(points)
    step = 1e-5
    ahead, behind = (tessellate(normalize(points + sign * step * direction)).energy for sign in (1, -1))
    slope = np.sum(here.gradient * direction)
    assert (ahead - behind) / (2 * step) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_energy_never_rises_and_the_residual_is_reached(method: str) -> None:
    result = optimize(fibonacci_points(200), method, tolerance=1e-6)
    energy = np.array(result.history.energy)
    assert np.all(np.diff(energy) <= 1e-13)
    assert energy[-1] < energy[0]
    assert result.history.residual[-1] <= 1e-6
    assert len(energy) == len(result.history.seconds) == result.history.iterations + 1
    assert tessellate(result.points).residual <= 1e-6


def test_both_methods_find_the_same_mesh_and_lbfgs_sooner() -> None:
    results = [optimize(icosahedral_points(2), method, tolerance=1e-9) for method in ("lbfgs", "lloyd")]
    np.testing.assert_allclose(results[0].points, results[1].points, atol=1e-7)
    assert results[0].history.iterations < results[1].history.iterations / 2


CONVERGED = {  # mu, sigma_avg, sigma_min, q_avg, q_min of converged meshes, two independent programs
    42: (1.130826, 0.917364, 0.884309, 0.987163, 0.982884),
    162: (1.164649, 0.911025, 0.858628, 0.990385, 0.972891),
    642: (1.196451, 0.912091, 0.852541, 0.992289, 0.970083),
    2562: (1.233428, 0.914058, 0.851096, 0.993095, 0.969391),
    10242: (1.270835, 0.915721, 0.850756, 0.993366, 0.969226),
}


@pytest.mark.parametrize("cells", CONVERGED)
def test_quality_of_converged_meshes(cells: int) -> None:
    measured = mesh_quality(scvt_mesh(cells))
    found = (measured.mu, measured.sigma_avg, measured.sigma_min, measured.q_avg, measured.q_min)
    np.testing.assert_allclose(found, CONVERGED[cells], atol=2e-6)
    assert measured.obtuse == 0
    assert measured.residual is not None
    assert measured.residual <= 1e-8


def test_ten_thousand_cells_converge_in_under_200_iterations() -> None:
    assert optimize(icosahedral_points(5), tolerance=1e-8).history.iterations < 200


def test_callback_sees_every_iteration() -> None:
    seen: list[int] = []
    result = optimize(icosahedral_points(1), callback=lambda iteration, residual, energy: seen.append(iteration))
    assert seen == list(range(result.history.iterations + 1))


def test_unreachable_tolerance_and_unknown_method_are_refused() -> None:
    with pytest.raises(MeshError, match=r"after 3 iterations and does not reach the tolerance 1.0e-08"):
        optimize(fibonacci_points(100), max_iterations=3)
    with pytest.raises(MeshError, match="does not reach"):
        optimize(fibonacci_points(100), tolerance=1e-18, max_iterations=300)
    with pytest.raises(MeshError, match="the tolerance is 0 mean spacings; it must be positive"):
        optimize(fibonacci_points(100), tolerance=0.0)
    with pytest.raises(MeshError, match="no optimisation method named 'newton'"):
        optimize(fibonacci_points(100), "newton")

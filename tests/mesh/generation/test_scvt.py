from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import numba
import numpy as np
import pytest

import mesh.generation.nested
import mesh.generation.optimizer
import mesh.generation.scvt
from mesh import MeshError, mesh_quality, scvt_mesh
from mesh.density.named import NAMED, RefinedBox
from mesh.errors import HemisphereError
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Callback, Iterate, Limits, Optimizer, ScvtResult
from mesh.generation.scvt import generate_scvt, optimize
from mesh.geometry.sphere import arc_length, dot, fibonacci_points, normalize
from mesh.integrals.moments import masses_and_moments
from mesh.mesh_request import MeshRequest
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.moving import Triangulation
from tests.mesh.plain_moments import mass_and_moment


def random_points(count: int, seed: int) -> np.ndarray:
    return normalize(np.random.default_rng(seed).normal(size=(count, 3)))


def moments_of(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    cells = Triangulation(points)
    return masses_and_moments(points, cells.circumcenters, cells.ring_starts, cells.rings)


def test_plain_mass_and_moment_agree_with_sampling() -> None:
    points = random_points(40, 0)
    mass, moment = mass_and_moment(points, delaunay(points))
    samples = fibonacci_points(2_000_000)
    owner = np.concatenate([np.argmax(part @ points.T, axis=1) for part in np.array_split(samples, 20)])
    weight = 4 * np.pi / len(samples)
    np.testing.assert_allclose(mass, weight * np.bincount(owner, minlength=40), atol=2e-4)
    sampled = np.stack([weight * np.bincount(owner, samples[:, k], 40) for k in range(3)], axis=1)
    np.testing.assert_allclose(moment, sampled, atol=2e-4)


@pytest.mark.parametrize("count", [12, 40, 300, 5000])
def test_kernels_equal_their_plain_twins(count: int) -> None:
    points = fibonacci_points(count) if count == 12 else random_points(count, count)
    mass, moment, energy = moments_of(points)
    plain_mass, plain_moment = mass_and_moment(points, delaunay(points))
    np.testing.assert_allclose(mass, plain_mass, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(moment, plain_moment, atol=2e-15)
    plain_energy = 2.0 * (plain_mass - dot(points, plain_moment))
    np.testing.assert_allclose(energy, plain_energy, rtol=1e-3 if count == 12 else 1e-5, atol=1e-14)
    assert energy.sum() == pytest.approx(plain_energy.sum(), rel=2e-4 if count == 12 else 1e-6)


def test_masses_sum_to_the_sphere_and_moments_to_zero() -> None:
    mass, moment, _ = moments_of(random_points(300, 5))
    assert mass.sum() == pytest.approx(4 * np.pi, rel=1e-13)
    np.testing.assert_allclose(moment.sum(axis=0), 0.0, atol=1e-13)


def test_gradient_is_the_derivative_of_the_energy() -> None:
    points = random_points(60, 2)
    direction = np.random.default_rng(3).normal(size=(60, 3))
    mass, moment, _ = moments_of(points)
    gradient = 2.0 * (mass[:, None] * points - moment)
    gradient -= dot(gradient, points)[:, None] * points
    step = 1e-5
    ahead, behind = (moments_of(normalize(points + sign * step * direction))[2].sum() for sign in (1, -1))
    assert (ahead - behind) / (2 * step) == pytest.approx(np.sum(gradient * direction), rel=1e-4)


def residual_of(result: ScvtResult) -> float:
    _, moment = mass_and_moment(result.points, result.triangles)
    spacing = np.sqrt(8 * np.pi / (np.sqrt(3) * len(result.points)))
    return float(arc_length(result.points, normalize(moment)).max() / spacing)


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
@pytest.mark.parametrize("start", ["fibonacci", "random"])
def test_energy_never_rises_and_the_residual_is_reached(method: str, start: str) -> None:
    points = fibonacci_points(200) if start == "fibonacci" else random_points(200, 9)
    result = optimize(points, method=method, limits=Limits(1e-6))
    energy = np.array(result.history.energy)
    assert np.all(np.diff(energy) <= 1e-13 * energy[0])
    assert energy[-1] < energy[0]
    assert result.reason == "tolerance"
    assert result.history.residual[-1] <= 1e-6
    assert residual_of(result) == pytest.approx(result.history.residual[-1], rel=1e-3)
    assert len(energy) == len(result.history.seconds) == result.history.iterations + 1
    assert np.all(np.diff(result.history.seconds) >= 0.0)


def test_all_methods_find_the_same_mesh_and_lbfgs_sooner() -> None:
    results = {method: generate_scvt(MeshRequest(642, method=method)) for method in ("lbfgs", "lloyd", "multilevel")}
    for result in results.values():
        np.testing.assert_allclose(result.points, results["lbfgs"].points, atol=1e-8)
    iterations = {method: result.history.iterations for method, result in results.items()}
    assert iterations["lbfgs"] < iterations["lloyd"] / 3
    assert iterations["multilevel"] <= iterations["lbfgs"]


def test_lloyd_steps_to_the_centroids() -> None:
    points = fibonacci_points(100)
    result = optimize(points, method="lloyd", limits=Limits(iterations=1))
    _, moment = mass_and_moment(points, delaunay(points))
    np.testing.assert_allclose(result.points, normalize(moment), atol=1e-13)


@pytest.mark.parametrize("seed", [0, 1])
def test_result_does_not_depend_on_the_number_of_threads(seed: int) -> None:
    results = []
    for threads in (1, 2):
        numba.set_num_threads(threads)
        try:
            results.append(optimize(random_points(5000, seed), limits=Limits(iterations=40)))
        finally:
            numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    np.testing.assert_array_equal(results[0].points, results[1].points)
    np.testing.assert_array_equal(results[0].triangles, results[1].triangles)
    assert results[0].history.energy == results[1].history.energy


def test_random_start_converges() -> None:
    result = optimize(random_points(2000, 4), limits=Limits(1e-6))
    assert result.reason == "tolerance"
    assert result.history.iterations < 1000


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
    assert measured.residual <= 1e-8


def test_ten_thousand_cells_converge_in_few_iterations() -> None:
    """The specification allows 200; the multilevel preconditioner needs about 30."""
    assert generate_scvt(MeshRequest(10242, tolerance=1e-8)).history.iterations < 50


def test_round_off_ends_the_descent() -> None:
    result = optimize(fibonacci_points(100), limits=Limits(1e-18))
    assert result.reason == "round-off"
    assert result.history.residual[-1] < 1e-11


def test_callback_sees_every_iteration() -> None:
    seen: list[Iterate] = []
    result = generate_scvt(MeshRequest(42), callback=seen.append)
    assert [iterate.number for iterate in seen] == list(range(result.history.iterations + 1))
    assert [iterate.residual for iterate in seen] == result.history.residual
    np.testing.assert_array_equal(seen[-1].points, result.points)


def test_limits_stop_the_iteration() -> None:
    points = random_points(500, 1)
    assert optimize(points, limits=Limits(iterations=5)).history.iterations == 5
    assert optimize(points, limits=Limits(seconds=0.0)).reason == "seconds"


def test_unreachable_tolerance_and_wrong_requests_are_refused() -> None:
    with pytest.raises(MeshError, match=r"after 3 iterations and does not reach the tolerance 1.0e-08: allow more"):
        generate_scvt(MeshRequest(100, max_iterations=3))
    with pytest.raises(MeshError, match="round-off allows no further step; ask for a larger tolerance"):
        generate_scvt(MeshRequest(100, tolerance=1e-18))
    with pytest.raises(MeshError, match="the tolerance is 0 mean spacings; it must be positive"):
        Limits(0.0)
    with pytest.raises(MeshError, match="no optimisation method named 'newton'"):
        generate_scvt(MeshRequest(100, method="newton"))
    with pytest.raises(MeshError, match="multilevel method bisects the icosahedron, which gives no mesh of 100 cells"):
        generate_scvt(MeshRequest(100, method="multilevel"))


@pytest.fixture
def seconds(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A clock that goes on by one second whenever somebody looks."""
    clock = count()
    ticking = SimpleNamespace(perf_counter=lambda: float(next(clock)))
    for module in (mesh.generation.optimizer, mesh.generation.scvt, mesh.generation.nested):
        monkeypatch.setattr(module, "time", ticking)
    return clock


def test_seconds_are_for_all_levels_together(seconds: Iterator[int]) -> None:
    """Each of the three levels would take 60 seconds."""
    with pytest.raises(MeshError, match="allow more time"):
        generate_scvt(MeshRequest(10242, method="multilevel", tolerance=1e-18, max_seconds=60.0))
    assert 60 <= next(seconds) <= 75


def test_seconds_are_for_all_reseedings_together(seconds: Iterator[int]) -> None:
    """Each of the eight begins with iterate 0; with little more time than the first descent took, the second ends."""
    coarse = generate_scvt(MeshRequest(162))
    numbers: list[int] = []

    def refine(limits: Limits) -> int:
        begin = next(seconds)
        numbers.clear()
        nested_scvt(coarse.points, coarse.triangles, RefinedBox(), None, limits, lambda it: numbers.append(it.number))
        return next(seconds) - begin

    refine(Limits(1e-3))
    assert numbers.count(0) == 9
    first = numbers.index(0, 1)
    assert refine(Limits(1e-3, seconds=first + 10.0)) <= first + 20
    assert numbers.count(0) == 2


def test_loops_that_wake_the_threads_are_those_that_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = scvt_mesh(642, start="fibonacci", tolerance=1e-6)
    monkeypatch.setattr("mesh.generation.multilevel.SERIAL_LIMIT", 10)
    found = scvt_mesh(642, start="fibonacci", tolerance=1e-6)
    np.testing.assert_array_equal(found.cell_points, expected.cell_points)


@pytest.mark.parametrize("cells", [1001, 1003])
def test_under_a_density_a_coarse_mesh_comes_first(cells: int) -> None:
    """The generators start spread as the density asks: the energy at the start is near that at the end."""
    energies: list[float] = []
    request = MeshRequest(cells, RefinedBox(), tolerance=1e-4)
    refined = generate_scvt(request, lambda iterate: energies.append(iterate.energy))
    assert refined.points.shape == (cells, 3)
    assert energies[0] < 1.15 * energies[-1]
    fibonacci = generate_scvt(replace(request, start="fibonacci"))
    assert fibonacci.history.energy[0] > 1.3 * fibonacci.history.energy[-1]
    assert refined.history.energy[-1] < 1.002 * fibonacci.history.energy[-1]


def test_a_coarse_mesh_that_leaves_a_hemisphere_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []

    def failing(self: Optimizer, limits: Limits, callback: Callback | None = None) -> ScvtResult:
        tried.append(len(self._current.points))
        if len(tried) == 1:
            raise HemisphereError("the points lie in one hemisphere")
        return run(self, limits, callback)

    run = Optimizer.run
    monkeypatch.setattr(Optimizer, "run", failing)
    result = generate_scvt(MeshRequest(1001, RefinedBox(), tolerance=1e-2))
    assert tried == [251, 1001]
    assert result.history.residual[-1] <= 1e-2


def test_density_meshes_do_not_depend_on_the_number_of_threads() -> None:
    request = MeshRequest(2600, "refined-circle", tolerance=0.05)
    threads, results = numba.get_num_threads(), []
    for number in (1, threads):
        numba.set_num_threads(number)
        results.append(generate_scvt(request).points)
    np.testing.assert_array_equal(*results)


@pytest.mark.slow
def test_spacing_follows_the_density() -> None:
    """Widths go like density^(-1/4), within 10 percent in the mean, and the mesh is as good as one from elsewhere."""
    density = NAMED["refined-circle"]
    mesh = scvt_mesh(10242, density="refined-circle")
    points = normalize(mesh.cell_points)
    ratio = np.sqrt(mesh.area_cell) * density(points) ** 0.25
    ratio /= ratio.mean()
    assert np.abs(ratio - 1.0).mean() < 0.1
    quality = mesh_quality(mesh, density)
    assert quality.residual < 1.1e-6
    assert quality.q_avg > 0.985
    assert quality.sigma_avg > 0.89

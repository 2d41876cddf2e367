import numpy as np
import pytest

from mesh import MeshError, mesh_quality, scvt_mesh
from mesh.density.named import NAMED, uniform
from mesh.generation.optimizer import Limits
from mesh.generation.probabilistic import MACQUEEN, Blend, probabilistic_lloyd
from mesh.generation.scvt import default_tolerance, generate_scvt, starting_mesh
from mesh.mesh_request import MeshRequest


def start(count: int) -> np.ndarray:
    return starting_mesh(count, "random")[0]


def test_residual_and_energy_fall() -> None:
    result = probabilistic_lloyd(start(300), uniform, Blend(20_000), 1, Limits(1e-3, 40))
    assert result.reason == "iterations"
    assert result.history.iterations == 40
    assert result.history.residual[-1] < 0.15 * result.history.residual[0]
    assert result.history.energy[-1] < 0.8 * result.history.energy[0]


def test_same_seed_gives_the_same_points() -> None:
    runs = [probabilistic_lloyd(start(100), uniform, Blend(500), seed, Limits(1e-3, 3)) for seed in (5, 5, 6)]
    np.testing.assert_array_equal(runs[0].points, runs[1].points)
    assert not np.array_equal(runs[0].points, runs[2].points)


def test_macqueen_makes_generators_the_means_of_their_samples() -> None:
    """One generator's history by hand: x <- (j x + y)/(j + 1), on the sphere, for every sample y that it gets."""
    points = start(12)
    sweep = probabilistic_lloyd(points, uniform, MACQUEEN, 3, Limits(1e-3, 1))
    from mesh.generation.generators import random_points
    from mesh.geometry.sphere import normalize

    expected, counts = points.copy(), np.ones(12)
    for sample in random_points(12, uniform, np.random.default_rng(3)):
        k = int(np.argmax(expected @ sample))
        expected[k] = normalize((counts[k] * expected[k] + sample) / (counts[k] + 1.0))
        counts[k] += 1.0
    np.testing.assert_allclose(sweep.points, expected, atol=1e-14)


def test_steps_shrink_until_the_tolerance_is_reached() -> None:
    """Steps of one size leave a residual of 0.05 to 0.08, the error of so few samples."""
    result = probabilistic_lloyd(start(100), uniform, Blend(2000), 0, Limits(0.02, 5000))
    assert result.reason == "tolerance"
    assert min(result.history.residual[:40]) > 0.04


@pytest.mark.parametrize("method", ["probabilistic", "macqueen"])
@pytest.mark.parametrize("density", ["uniform", pytest.param("smooth-transition", marks=pytest.mark.slow)])
def test_default_tolerance_is_reached(method: str, density: str) -> None:
    mesh = scvt_mesh(100, density, "random", method, max_iterations=3000)
    assert mesh_quality(mesh).residual <= default_tolerance(density, method)
    assert default_tolerance(density, method) <= 0.5


def test_density_attracts_generators() -> None:
    density = NAMED["refined-circle"]
    result = probabilistic_lloyd(start(300), density, Blend(5000), 0, Limits(1e-3, 30))
    assert np.mean(density(result.points) > 80.0) > 1.5 * np.mean(density(start(300)) > 80.0)


def test_unreached_tolerance_and_wrong_weights_are_refused() -> None:
    with pytest.raises(MeshError, match="allow more iterations"):
        generate_scvt(MeshRequest(100, method="probabilistic", tolerance=1e-6, max_iterations=2))
    with pytest.raises(MeshError, match="at least one sample and weights between 0 and 1"):
        Blend(alpha=1.5)

import numpy as np
import pytest

pytest.importorskip("ducc0")

from postprocess.reference.harmonics import Harmonics, degrees, truncated, truncation_of

RADIUS = 6.4e6
TRUNCATION = 21


@pytest.fixture(scope="module")
def harmonics() -> Harmonics:
    return Harmonics(TRUNCATION, RADIUS)


def random_coefficients(seed: int, truncation: int = TRUNCATION) -> np.ndarray:
    generator = np.random.default_rng(seed)
    size = (truncation + 1) * (truncation + 2) // 2
    coefficients = generator.normal(size=size) + 1j * generator.normal(size=size)
    coefficients[: truncation + 1] = coefficients[: truncation + 1].real
    return coefficients


def test_analysis_inverts_synthesis(harmonics: Harmonics) -> None:
    coefficients = random_coefficients(0)
    assert harmonics.from_grid(harmonics.to_grid(coefficients)) == pytest.approx(coefficients, abs=1e-13)


def test_products_of_two_fields_are_free_of_aliasing(harmonics: Harmonics) -> None:
    field, other = (harmonics.to_grid(random_coefficients(seed)) for seed in (1, 2))
    fine = Harmonics(TRUNCATION, RADIUS, oversampling=3)
    product = fine.to_grid(random_coefficients(1)) * fine.to_grid(random_coefficients(2))
    assert harmonics.from_grid(field * other) == pytest.approx(fine.from_grid(product), abs=1e-12)


def test_laplacian_of_a_known_harmonic(harmonics: Harmonics) -> None:
    longitude, latitude = harmonics.points
    wave = np.cos(latitude) ** 4 * np.sin(latitude) * np.cos(4.0 * longitude)
    found = harmonics.to_grid(harmonics.laplacian * harmonics.from_grid(wave))
    assert found * RADIUS**2 == pytest.approx(-30.0 * wave, abs=1e-11)


def test_rotation_and_divergence_of_known_flows(harmonics: Harmonics) -> None:
    """Eastward solid-body rotation has vorticity 2 w sin(lat); the gradient of a sin(lat) points north."""
    longitude, latitude = harmonics.points
    still = np.zeros_like(longitude)
    curl, divergence = harmonics.curl_and_divergence(RADIUS * np.cos(latitude), still)
    assert harmonics.to_grid(curl) == pytest.approx(2.0 * np.sin(latitude), abs=1e-12)
    assert harmonics.to_grid(divergence) == pytest.approx(still, abs=1e-12)
    curl, divergence = harmonics.curl_and_divergence(still, RADIUS * np.cos(latitude))
    assert harmonics.to_grid(curl) == pytest.approx(still, abs=1e-12)
    assert harmonics.to_grid(divergence) == pytest.approx(-2.0 * np.sin(latitude), abs=1e-12)


def test_velocity_has_the_vorticity_and_divergence_it_was_made_of(harmonics: Harmonics) -> None:
    vorticity, divergence = random_coefficients(3), random_coefficients(4)
    vorticity[0] = divergence[0] = 0.0
    found = harmonics.curl_and_divergence(*harmonics.velocity_on_grid(vorticity, divergence))
    assert found[0] == pytest.approx(vorticity, abs=1e-12)
    assert found[1] == pytest.approx(divergence, abs=1e-12)


def test_values_at_points_are_those_of_the_grid(harmonics: Harmonics) -> None:
    vorticity, divergence = random_coefficients(5), random_coefficients(6)
    longitude, latitude = (angle.ravel() for angle in harmonics.points)
    longitude = longitude - 2.0 * np.pi  # any branch of the longitude will do
    values = harmonics.at_points(vorticity, longitude, latitude)
    assert values == pytest.approx(harmonics.to_grid(vorticity).ravel(), abs=1e-10)
    velocity = harmonics.velocity_at_points(vorticity, divergence, longitude, latitude)
    for found, exact in zip(velocity, harmonics.velocity_on_grid(vorticity, divergence), strict=True):
        assert found / RADIUS == pytest.approx(exact.ravel() / RADIUS, abs=1e-10)


def test_power_adds_up_to_the_mean_square(harmonics: Harmonics) -> None:
    coefficients = random_coefficients(7)
    field = harmonics.to_grid(coefficients)
    mean_square = harmonics.from_grid(field**2)[0].real / np.sqrt(4.0 * np.pi)
    assert harmonics.power(coefficients).sum() == pytest.approx(mean_square, rel=1e-12)
    assert harmonics.root_mean_square(np.stack([coefficients])) == pytest.approx(np.sqrt(mean_square), rel=1e-12)


def test_truncation_keeps_the_low_degrees() -> None:
    coefficients = random_coefficients(8)
    kept = truncated(coefficients, 10)
    assert (truncation_of(coefficients), truncation_of(kept)) == (TRUNCATION, 10)
    fine, coarse = Harmonics(TRUNCATION, 1.0), Harmonics(10, 1.0)
    low = np.where(degrees(TRUNCATION) <= 10, coefficients, 0.0)
    places = np.array([0.3, 2.0]), np.array([-1.0, 0.7])
    assert coarse.at_points(kept, *places) == pytest.approx(fine.at_points(low, *places), abs=1e-11)

import json
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, MeshWarning, mesh_from_points, mesh_quality, read_mesh, scvt_mesh, write_mesh
from mesh.density.gridded import Shaping, find_density, read_density
from mesh.density.named import NAMED, RefinedBox, RefinedCircle, SmoothTransition, uniform
from mesh.density.record import source_of
from mesh.generation.generators import random_points
from mesh.generation.optimizer import RELATIVE_QUADRATURE_ERROR, Limits, Optimizer
from mesh.generation.scvt import optimize, starting_mesh
from mesh.geometry.sphere import fibonacci_points, from_lonlat, normalize, to_lonlat
from mesh.integrals.moments import masses_and_moments
from mesh.integrals.weighted_moments import WeightedCells
from mesh.triangulation.moving import Triangulation


def at(longitude: float, latitude: float) -> np.ndarray:
    """One point, degrees."""
    return from_lonlat(np.radians([longitude]), np.radians([latitude]))


def test_named_densities_have_their_published_shape() -> None:
    circle = RefinedCircle()
    assert circle(at(270, 30))[0] == pytest.approx(81.0)
    assert circle(at(270, 59.9))[0] == pytest.approx(81.0)
    assert circle(at(270, 67.5))[0] == pytest.approx(16.0)
    assert circle(at(270, 80))[0] == circle(at(90, -30))[0] == 1.0
    box = RefinedBox()
    assert box(at(230, 0))[0] == pytest.approx(81.0)
    assert box(at(310 + np.degrees(0.12), 20))[0] == pytest.approx(16.0)
    assert box(at(10, 20))[0] == 1.0
    smooth = SmoothTransition()
    assert smooth(at(270, 30))[0] / smooth(at(90, -30))[0] == pytest.approx(81.0, rel=0.03)
    # One scale of the transition beyond the circle, the width is 1 + 2 (1 + tanh 1) / 2.
    width = smooth(at(270, 30 + 30 + 9))[0] ** -0.25
    assert width == pytest.approx(2.0 + np.tanh(1.0), rel=1e-12)


def test_circle_is_whole_where_it_crosses_the_prime_meridian() -> None:
    circle = RefinedCircle(longitude=0.0)
    assert circle(at(350, 30))[0] == circle(at(10, 30))[0] == pytest.approx(81.0)


def test_unknown_density_is_refused_with_the_choices() -> None:
    with pytest.raises(MeshError, match="no density named 'fine'; choose one of uniform, refined-circle"):
        find_density("fine")


def test_named_densities_are_not_shaped() -> None:
    with pytest.raises(MeshError, match="refined-circle cannot be shaped"):
        find_density("refined-circle", shaping=Shaping(floor=1.0))
    with pytest.raises(MeshError, match="none of them negative but the power"):
        Shaping(smoothing=-1)


def weighted(points: np.ndarray, density) -> np.ndarray:
    cells = Triangulation(points)
    return WeightedCells(density, len(points)).integrate(points, cells.circumcenters, cells.ring_starts, cells.rings)


def test_quadrature_agrees_with_the_exact_integrals_of_uniform_density() -> None:
    points = fibonacci_points(3000)
    cells = Triangulation(points)
    mass, moment, energy = masses_and_moments(points, cells.circumcenters, cells.ring_starts, cells.rings)
    sums = weighted(points, uniform)
    np.testing.assert_allclose(sums[:, 0], mass, rtol=1e-9)
    np.testing.assert_allclose(sums[:, 4], (moment * points).sum(axis=1), rtol=1e-9)
    tangential = moment - (moment * points).sum(axis=1)[:, None] * points
    np.testing.assert_allclose(sums[:, 1:4], tangential, atol=1e-9 * mass.max())
    np.testing.assert_allclose(sums[:, 5], energy, rtol=1e-6)


def test_quadrature_has_order_six_in_the_size_of_cells() -> None:
    """Exact for polynomials of degree five, so that errors of smooth densities fall like the sixth power of the size.

    The total mass of exp(z) is 4 pi sinh(1), that of its moment along z the derivative of it.
    """

    def smooth(points: np.ndarray) -> np.ndarray:
        return np.exp(2.0 * points[:, 2])

    exact = 2.0 * np.pi * np.sinh(2.0)
    errors = [abs(weighted(fibonacci_points(count), smooth)[:, 0].sum() - exact) for count in (50, 200)]
    assert errors[1] < 1e-4 * exact
    assert np.log2(errors[0] / errors[1]) > 5.0


def test_quadrature_of_a_kinked_density_agrees_with_sampling() -> None:
    density = NAMED["refined-circle"]
    samples = fibonacci_points(1_000_000)
    expected = density(samples).mean() * 4.0 * np.pi
    assert weighted(fibonacci_points(2562), density)[:, 0].sum() == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (lambda points: points[:, 2], r"density is -.* at longitude .* must be finite and not negative"),
        (lambda points: np.where(points[:, 0] > 0.9, np.nan, 1.0), "density is nan"),
        (lambda points: np.where(points[:, 0] > 0.2, 0.0, 1.0), "density is zero on the whole cell"),
    ],
)
def test_unusable_densities_are_refused(density, words: str) -> None:
    with pytest.raises(MeshError, match=words):
        scvt_mesh(200, density=density)


def test_random_points_follow_the_density() -> None:
    density = NAMED["refined-circle"]
    points = random_points(20_000, density, np.random.default_rng(0))
    samples = fibonacci_points(200_000)
    inside = density(samples) > 80.0
    share = density(samples)[inside].sum() / density(samples).sum()
    assert np.mean(density(points) > 80.0) == pytest.approx(share, abs=0.01)
    np.testing.assert_array_equal(points, random_points(20_000, density, np.random.default_rng(0)))
    assert not np.array_equal(points[:10], random_points(20_000, density, np.random.default_rng(1))[:10])


def test_density_that_vanishes_cannot_be_sampled() -> None:
    with pytest.raises(MeshError, match="the density is zero everywhere it was tried; give one that is positive"):
        random_points(10, lambda points: np.zeros(len(points)), np.random.default_rng(0))


@pytest.mark.parametrize(
    "start", ["icosahedral", *(pytest.param(start, marks=pytest.mark.slow) for start in ("random", "random-root"))]
)
def test_refined_circle_converges_with_the_right_widths(start: str) -> None:
    mesh = scvt_mesh(2562, density="refined-circle", start=start, tolerance=1e-5)
    quality = mesh_quality(mesh)
    assert quality.residual <= 1.1e-5
    assert 0.86 < quality.sigma_avg < 0.885
    assert 0.983 < quality.q_avg < 0.989
    assert 4.0 < quality.mu < 5.6
    width = np.sqrt(mesh.area_cell)
    fine, coarse = mesh.mesh_density > 80.9, mesh.mesh_density < 1.1
    assert np.median(width[coarse]) / np.median(width[fine]) == pytest.approx(3.0, rel=0.05)


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_energy_never_rises_above_the_error_of_its_quadrature(method: str) -> None:
    limits = Limits(1e-4, iterations=300)
    density = NAMED["refined-circle"]
    start = starting_mesh(642, "random", density)
    energy = np.array(optimize(*start, method, density, limits).history.energy)
    assert np.all(energy <= (1.0 + RELATIVE_QUADRATURE_ERROR) * np.minimum.accumulate(energy))
    assert energy[-1] < 0.9 * energy[0]
    if method == "lloyd":
        assert np.all(np.diff(energy) <= 0.0)


def test_widths_follow_the_density_to_minus_a_quarter() -> None:
    mesh = scvt_mesh(2562, density="smooth-transition", tolerance=1e-4)
    slope, _ = np.polyfit(np.log(mesh.mesh_density), np.log(np.sqrt(mesh.area_cell)), 1)
    assert slope == pytest.approx(-0.25, abs=0.01)


def test_density_is_kept_in_the_file(tmp_path: Path) -> None:
    mesh = scvt_mesh(162, density="refined-circle", tolerance=1e-5)
    write_mesh(mesh, tmp_path / "mesh.nc")
    read = read_mesh(tmp_path / "mesh.nc")
    assert read.density_name == "refined-circle"
    assert mesh_quality(read).residual == pytest.approx(mesh_quality(mesh).residual, rel=1e-6)
    np.testing.assert_array_equal(read.mesh_density, NAMED["refined-circle"](mesh.cell_points))


def test_fixed_generators_stay() -> None:
    points = normalize(np.random.default_rng(0).normal(size=(400, 3)))
    fixed = points[:, 2] < 0.0
    result = Optimizer(points, fixed=fixed).run(Limits(1e-5))
    np.testing.assert_array_equal(result.points[fixed], points[fixed])
    assert result.reason == "tolerance"
    assert np.abs(result.points[~fixed] - points[~fixed]).max() > 0.01


def write_grid(path: Path, values: np.ndarray, latitude: np.ndarray, longitude: np.ndarray) -> Path:
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("lat", len(latitude))
        file.createDimension("lon", len(longitude))
        for name, places, unit in (("lat", latitude, "degrees_north"), ("lon", longitude, "degrees_east")):
            file.createVariable(name, "f8", (name,)).units = unit
            file[name][:] = places
        file.createVariable("density", "f4", ("lat", "lon"))[:] = values
    return path


def test_gridded_density_is_interpolated(tmp_path: Path) -> None:
    latitude, longitude = np.arange(90.0, -91.0, -2.0), np.arange(-180.0, 180.0, 2.0)
    north, east = np.meshgrid(np.radians(latitude), np.radians(longitude), indexing="ij")

    def field(lon: np.ndarray, lat: np.ndarray) -> np.ndarray:
        return 2.0 + np.cos(lat) * np.cos(lon) + 0.3 * np.sin(lat)

    density = read_density(write_grid(tmp_path / "grid.nc", field(east, north), latitude, longitude))
    points = fibonacci_points(500)
    np.testing.assert_allclose(density(points), field(*to_lonlat(points)), atol=2e-3)
    mesh = scvt_mesh(300, density=str(tmp_path / "grid.nc"), tolerance=1e-4)
    assert mesh.area_cell[mesh.x_cell > 0.9].mean() < 0.8 * mesh.area_cell[mesh.x_cell < -0.9].mean()


def test_gridded_density_is_shaped(tmp_path: Path) -> None:
    latitude, longitude = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)
    values = np.zeros((19, 36))
    values[9, 18] = 16.0
    path = write_grid(tmp_path / "grid.nc", values, latitude, longitude)
    there, beside = at(180, 0), at(190, 0)
    plain = read_density(path)
    assert plain(there)[0] == pytest.approx(16.0)
    assert plain(beside)[0] == pytest.approx(0.0, abs=1e-12)
    shaped = read_density(path, shaping=Shaping(floor=0.5, power=0.5, smoothing=1))
    assert shaped(there)[0] == pytest.approx(np.sqrt(0.5 * 16.0 + 0.5 * 0.5))
    assert shaped(beside)[0] == pytest.approx(np.sqrt(0.875 * 0.5 + 0.125 * 16.0))


def test_density_on_a_mesh_is_interpolated(tmp_path: Path) -> None:
    path = tmp_path / "mesh.nc"
    write_mesh(mesh_from_points(fibonacci_points(2000)), path)
    with netCDF4.Dataset(path, "r+") as file:
        file.createVariable("density", "f8", ("nCells",))[:] = 3.0 + file["zCell"][:]
    points = fibonacci_points(501)
    np.testing.assert_allclose(read_density(path)(points), 3.0 + points[:, 2], atol=0.03)


def test_grid_may_close_the_circle_of_longitudes(tmp_path: Path) -> None:
    latitude, longitude = np.arange(-90.0, 91.0, 30.0), np.arange(-180.0, 181.0, 30.0)
    values = np.repeat(np.arange(1.0, 8.0)[:, None], 13, axis=1)
    density = read_density(write_grid(tmp_path / "grid.nc", values, latitude, longitude))
    np.testing.assert_allclose(density(at(180, 0)), 4.0)
    np.testing.assert_allclose(density(at(179.999, 15)), 4.5)


def test_missing_and_negative_values_of_a_file_are_refused(tmp_path: Path) -> None:
    latitude, longitude = np.array([-60.0, 0.0, 60.0]), np.arange(4) * 90.0
    values = np.ones((3, 4))
    values[1, 2] = -5.0
    path = write_grid(tmp_path / "grid.nc", values, latitude, longitude)
    with pytest.raises(MeshError, match="density falls to -5; a density is not negative"):
        read_density(path)
    assert read_density(path, shaping=Shaping(floor=0.5))(at(180, 0))[0] == pytest.approx(0.5)
    with netCDF4.Dataset(path, "r+") as file:
        file["density"][0, 0] = np.ma.masked
    with pytest.raises(MeshError, match="1 of 12 values of density are missing or not finite"):
        read_density(path, shaping=Shaping(floor=0.5))


def test_unusable_density_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match="there is no such file"):
        find_density(str(tmp_path / "absent.nc"))
    path = write_grid(tmp_path / "grid.nc", np.full((3, 4), np.nan), np.array([-60.0, 0.0, 60.0]), np.arange(4) * 90.0)
    with pytest.raises(MeshError, match="12 of 12 values of density are missing or not finite"):
        read_density(path)
    with pytest.raises(
        MeshError, match="no variable named depth; name one of those that it has, which are lat, lon, density"
    ):
        read_density(path, "depth")


SHAPES = {
    "list": lambda values: [float(value) for value in values],
    "single precision": lambda values: values.astype(np.float32),
    "column": lambda values: values[:, None],
    "large": lambda values: 1e300 * values,
    "small": lambda values: 1e-300 * values,
}


@pytest.mark.parametrize("name", SHAPES)
def test_functions_may_return_any_numbers_of_any_size(name: str) -> None:
    """Only ratios of a density count, so that the mesh is the same."""
    density, given = NAMED["smooth-transition"], SHAPES[name]
    expected = scvt_mesh(162, density, tolerance=1e-5)
    found = scvt_mesh(162, lambda points: given(density(points)), tolerance=1e-5)
    np.testing.assert_allclose(found.cell_points, expected.cell_points, atol=1e-4)
    np.testing.assert_allclose(found.mesh_density, np.ravel(given(density(found.cell_points))), rtol=1e-6)


@pytest.mark.parametrize("factor", [0.25, 2.0**600, 2.0**-900])
def test_powers_of_four_change_no_digit(factor: float) -> None:
    density = NAMED["refined-circle"]
    meshes = [scvt_mesh(100, lambda points, f=f: f * density(points), "random", tolerance=1e-4) for f in (1.0, factor)]
    np.testing.assert_array_equal(meshes[1].cell_points, meshes[0].cell_points)


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (lambda points: np.ones(3), r"gives values of shape \(3,\) at 20000 points; return one per point"),
        (lambda points: None, "gives NoneType instead of real numbers"),
        (lambda points: "dense", "gives str instead of real numbers"),
        (lambda points: [[1.0], [1.0, 2.0]], "gives list instead of real numbers"),
        (lambda points: points[:, 0] + 2j, "gives ndarray instead of real numbers"),
        (lambda points: 0.0, "density is zero everywhere it was tried"),
        (lambda points: np.exp(60.0 * points[:, 2]), "draws 200 generators to one hemisphere; ask for more cells"),
    ],
)
def test_functions_that_give_no_density_are_refused(density, words: str) -> None:
    with pytest.raises(MeshError, match=words):
        scvt_mesh(200, density=density)


def test_extreme_ratio_converges() -> None:
    """Widths from 1 to 100."""
    mesh = scvt_mesh(2562, lambda points: 1e8 ** (0.5 + 0.5 * points[:, 2]), "random-root", tolerance=1e-4)
    assert mesh.area_cell.max() / mesh.area_cell.min() > 500.0


@pytest.mark.parametrize("scale", [1e-200, 1e200])
def test_scale_of_widths_does_not_count(scale: float, tmp_path: Path) -> None:
    latitude, longitude = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)
    width = np.repeat(1.0 + 0.01 * (latitude + 90.0), 36).reshape(19, 36)
    path = write_grid(tmp_path / "grid.nc", np.ones((19, 36)), latitude, longitude)
    with netCDF4.Dataset(path, "r+") as file:
        file.createVariable("width", "f8", ("lat", "lon"))[:] = scale * width
    density = read_density(path, "width", Shaping(power=-4.0, smoothing=1))
    south, north = (density(at(0, latitude))[0] for latitude in (-40, 40))
    assert 0.0 < south < np.inf
    assert north / south == pytest.approx((1.5 / 2.3) ** 4, rel=1e-9)


def test_end_by_kinks_is_accepted_where_no_tolerance_is_asked_for() -> None:
    """A density that jumps is never converged to the default tolerance."""

    def jump(points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 2] > 0.3, 1.0 + 1e-3 * points[:, 0] ** 2, 1.0)

    with pytest.warns(MeshWarning, match="taken as converged at a centroid residual of .*; kinks of the density"):
        mesh = scvt_mesh(100, jump)
    assert 1e-6 < mesh_quality(mesh, jump).residual <= 1e-4
    with pytest.raises(MeshError, match="the density jumps or changes much within a cell"):
        scvt_mesh(100, jump, tolerance=1e-6)


def test_arguments_may_be_numbers_of_numpy_and_paths(tmp_path: Path) -> None:
    latitude, longitude = np.arange(-90.0, 91.0, 30.0), np.arange(0.0, 360.0, 30.0)
    path = write_grid(tmp_path / "grid.nc", np.ones((7, 12)), latitude, longitude)
    plain = scvt_mesh(100, str(path), "random", tolerance=1e-3, max_iterations=500, seed=3)
    mesh = scvt_mesh(
        np.int32(100), path, "random", tolerance=np.float64(1e-3), max_iterations=np.int16(500), seed=np.uint8(3)
    )
    np.testing.assert_array_equal(mesh.cell_points, plain.cell_points)
    density = read_density(path, shaping=Shaping(np.float32(0.5), np.float32(1.0), np.int64(1)))
    assert json.loads(source_of(density)) == {
        "path": str(path),
        "variable": "density",
        "floor": 0.5,
        "power": 1.0,
        "smoothing": 1,
        "sha256": density.digest,
    }

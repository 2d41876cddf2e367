"""Meshes of any generators on periodic planes: identities, seams that cannot be seen, files, and what is refused."""

import warnings
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import (
    MeshError,
    VoronoiMesh,
    build_operators,
    hexagon_mesh,
    periodic_mesh,
    read_mesh,
    validate_mesh,
    write_mesh,
)
from mesh.arrays import Array
from mesh.conventions import MESH_VARIABLES
from mesh.discrete.operators import normal_component, velocity_at_cells
from mesh.integrals.plane_centroids import plane_centroids
from mesh.integrals.quadrature import cell_means
from swe import ShallowWaterModel, State
from swe.equations.consistent import Consistent
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.tendency import consistent, ringler2010, tendency
from swe.run.composition import fused_method, plain_method

PERIODS = (3e5, 2e5)


def random_points(count: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).uniform(0.0, PERIODS, (count, 2))


@pytest.fixture(scope="module", params=[80, 300])
def mesh(request: pytest.FixtureRequest) -> VoronoiMesh:
    return periodic_mesh(random_points(request.param), PERIODS)


def test_identities_hold_and_cells_cover_the_plane(mesh: VoronoiMesh) -> None:
    assert max(validate_mesh(mesh).values()) < 1e-12
    assert mesh.area_cell.sum() == pytest.approx(6e10, rel=1e-13)
    assert mesh.n_edges_on_cell.mean() == 6.0
    assert np.ptp(mesh.n_edges_on_cell) > 3


def test_a_uniform_flow_is_found_again(mesh: VoronoiMesh) -> None:
    velocity = normal_component(mesh, 3.0, -2.0)
    eastward, northward = velocity_at_cells(mesh, velocity)
    np.testing.assert_allclose(eastward, 3.0, rtol=1e-10)
    np.testing.assert_allclose(northward, -2.0, rtol=1e-10)
    energy = np.empty(mesh.n_cells)
    Consistent(mesh).kinetic_energy(velocity, energy)
    np.testing.assert_allclose(energy, 6.5, rtol=1e-9)
    assert np.abs(build_operators(mesh).divergence @ velocity).max() < 1e-9 * 3.0 / np.sqrt(mesh.area_cell.min())


def test_seams_cannot_be_seen(mesh: VoronoiMesh) -> None:
    """The translated generators give the translated mesh."""
    shift = np.array([1.234e5, 0.77e5])
    moved = periodic_mesh(mesh.cell_points[:, :2] + shift, PERIODS)
    for name in ("cells_on_edge", "vertices_on_cell", "edges_on_edge"):
        np.testing.assert_array_equal(getattr(moved, name), getattr(mesh, name))
    for name, scale in (("area_cell", 1e9), ("dv_edge", 1e5), ("weights_on_edge", 1e1), ("angle_edge", 1e1)):
        np.testing.assert_allclose(getattr(moved, name), getattr(mesh, name), rtol=0, atol=1e-9 * scale)
    way = plane_centroids(mesh) - mesh.cell_points
    np.testing.assert_allclose(plane_centroids(moved) - moved.cell_points, way, atol=1e-4)


def test_centroids_are_the_means_of_positions(mesh: VoronoiMesh) -> None:
    centroids = plane_centroids(mesh)
    for axis in range(2):
        means = cell_means(mesh, lambda *places, axis=axis: places[axis])
        np.testing.assert_allclose(centroids[:, axis], means, rtol=0, atol=1e-6)
    assert np.abs(centroids - mesh.cell_points).max() > 1e3


def test_the_generators_of_hexagons_give_the_hexagons() -> None:
    expected = hexagon_mesh((1e4, 1e4 * 0.5 * np.sqrt(3.0)), (6, 6))
    found = periodic_mesh(expected.cell_points[:, :2], (expected.x_period, expected.y_period))
    np.testing.assert_array_equal(found.cells_on_vertex, expected.cells_on_vertex)
    np.testing.assert_allclose(found.area_cell, expected.area_cell, rtol=1e-12)


def test_files_come_back_to_the_bit(mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(mesh, tmp_path / "plane.nc")
    with netCDF4.Dataset(tmp_path / "plane.nc", "r+") as file:
        file.delncattr("validated_hash")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = read_mesh(tmp_path / "plane.nc")
    for variable in MESH_VARIABLES:
        np.testing.assert_array_equal(getattr(found, variable.name), getattr(mesh, variable.name))


@pytest.mark.parametrize(("scheme", "energy"), [(Ringler2010, ringler2010), (Consistent, consistent)])
def test_forms_of_the_model_agree_and_keep_energy(mesh: VoronoiMesh, scheme: type[Scheme], energy: object) -> None:
    random = np.random.default_rng(2)
    bottom = random.uniform(0.0, 500.0, mesh.n_cells)
    model = ShallowWaterModel(mesh, bottom, 1e-4 + 1e-11 * mesh.y_vertex, 9.8, scheme=scheme)
    # Smooth, so that thickness at the vertices of obtuse triangles, too, is positive.
    x, y = (2.0 * np.pi * each / period for each, period in zip((mesh.x_cell, mesh.y_cell), PERIODS, strict=True))
    state = State(1000.0 + 5.0 * np.sin(x) * np.cos(y), random.uniform(-30.0, 30.0, mesh.n_edges))
    rate, flux, kinetic = state.copy(), np.empty(mesh.n_edges), np.empty(mesh.n_cells)
    model.tendency(state, rate)
    expected = tendency(state, build_operators(mesh), bottom, model.coriolis, 9.8, energy)  # type: ignore[arg-type]
    for name in ("thickness", "normal_velocity"):
        wanted = getattr(expected, name)
        np.testing.assert_allclose(getattr(rate, name), wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    model.scheme.flux(state.thickness, state.normal_velocity, flux)
    model.scheme.kinetic_energy(state.normal_velocity, kinetic)
    of_cells = mesh.area_cell * (kinetic + 9.8 * (state.thickness + bottom)) * rate.thickness
    of_edges = mesh.dc_edge * mesh.dv_edge * flux * rate.normal_velocity
    assert abs(of_cells.sum() + of_edges.sum()) < 1e-12 * np.abs(of_cells).sum()
    fused, plain = state.copy(), state.copy()
    plain_method(model, plain, "rk4").step(plain, 0.1)
    assert fused_method(model, "rk4").advance(fused, 0.1, 1) == 1
    np.testing.assert_allclose(fused.normal_velocity, plain.normal_velocity, atol=1e-11 * 30.0)


@pytest.mark.parametrize(
    ("points", "periods", "words"),
    [
        (random_points(5), PERIODS, "at least 12 of them"),
        (np.full((20, 2), np.nan), PERIODS, "generator 0 is .*, which is no point of a plane"),
        (
            np.column_stack([np.linspace(0.0, 1.0, 20), np.zeros(20)]),
            (0.0, 1.0),
            "a length of the plane is 0 m",
        ),
        (random_points(20), (1e5,), "give two numbers, along x and along y"),
        (random_points(30), PERIODS, "longer than half a period of the plane; give more generators"),
        (
            random_points(80)[[*range(80), 3]],
            PERIODS,
            "generators 3 and 80 are at the same place; leave one of them out",
        ),
    ],
)
def test_what_makes_no_mesh_is_told(points: Array, periods: tuple[float, ...], words: str) -> None:
    with pytest.raises(MeshError, match=words):
        periodic_mesh(points, periods)

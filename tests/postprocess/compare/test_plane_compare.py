"""Comparison of runs on planes: fields at other places across the seams, norms, maps, truncation errors, spectra."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mesh import VoronoiMesh, hexagon_mesh, periodic_mesh
from mesh.arrays import Array
from mesh.geometry.surface import surface_of
from postprocess.compare.comparison import compare_runs
from postprocess.compare.fourier import Fourier
from postprocess.compare.places import nearest_sites, points_at
from postprocess.compare.plane_flow import plane_flow
from postprocess.compare.remap import remap_cells, remap_vertices
from postprocess.compare.shares import error_shares
from postprocess.compare.spectra import spectra_of
from postprocess.compare.truncation import truncation_errors
from postprocess.figures import compare_maps, paper
from postprocess.runs.reading import read_run
from swe.errors import InputError
from tests.postprocess.conftest import LENGTHS


def wave(x: Array, y: Array) -> Array:
    return np.cos(2.0 * np.pi * (x / LENGTHS[0] + y / LENGTHS[1]))


def places(count: int, beyond: float = 0.0) -> tuple[Array, Array]:
    x, y = np.random.default_rng(1).random((2, count))
    return (x + beyond) * LENGTHS[0], (y - beyond) * LENGTHS[1]


def test_nearest_sites_may_be_images(any_plane: VoronoiMesh) -> None:
    surface, sites = surface_of(any_plane), any_plane.cell_points
    points = points_at(surface, *places(200))
    ways = surface.shortest(sites[None] - points[:, None])
    np.testing.assert_array_equal(
        nearest_sites(surface, sites, points), np.argmin(np.linalg.norm(ways, axis=-1), axis=1)
    )


def test_fields_at_other_places_converge_across_the_seams() -> None:
    errors = []
    for count in (12, 24):
        mesh = hexagon_mesh(LENGTHS, (count, count))
        for remap, place in ((remap_cells, "cell"), (remap_vertices, "vertex")):
            found = remap(mesh, *places(2000, beyond=0.5)).scalar(wave(*mesh.coordinates(place)))
            errors.append(np.abs(found - wave(*places(2000, beyond=0.5))).max())
    assert max(errors) < 0.1
    assert errors[0] / errors[2] > 6.0
    assert errors[1] / errors[3] > 6.0


def test_a_parabola_in_a_box_is_kept(any_plane: VoronoiMesh) -> None:
    """The fit is quadratic; where the plane repeats itself there is no parabola."""
    if any_plane.x_period:
        return
    x, y = places(500)
    found = remap_cells(any_plane, x, y).scalar(any_plane.x_cell**2 - any_plane.x_cell * any_plane.y_cell)
    np.testing.assert_allclose(found, x**2 - x * y, atol=1e-6 * LENGTHS[0] ** 2)


def test_components_stay_along_x_and_y(periodic_plane: VoronoiMesh) -> None:
    remap = remap_cells(periodic_plane, *places(100))
    along, across = periodic_plane.x_cell, periodic_plane.y_cell
    found = remap.vector(along, across)
    np.testing.assert_allclose(found[0], remap.scalar(along), rtol=1e-12)
    np.testing.assert_allclose(found[1], remap.scalar(across), rtol=1e-12)


def test_runs_on_planes_are_compared_with_each_other(plane_run: Path, finer_plane_run: Path) -> None:
    exact = compare_runs(plane_run, finer_plane_run)
    assert exact.solution.name == "exact solution"
    coarse, fine = (entry.norms["thickness"].l2 for entry in exact.entries)
    assert 3.0 < coarse / fine < 5.0
    other = compare_runs(plane_run, reference=finer_plane_run).entries[0].norms["thickness"].l2
    assert other == pytest.approx(coarse - fine, rel=0.2)


def test_maps_are_drawn(
    plane_run: Path, finer_plane_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paper, "COLUMNS", 60)
    monkeypatch.setattr(compare_maps, "DOTS_PER_INCH", 40)
    monkeypatch.setattr(compare_maps, "MAP_FIELDS", {"velocity": compare_maps.MAP_FIELDS["velocity"]})
    paths = compare_maps.write_maps(compare_runs(plane_run, finer_plane_run), tmp_path / "maps")
    assert len(paths) == 2
    assert all(path.stat().st_size > 3000 for path in paths)


def test_runs_on_different_planes_are_not_compared(plane_run: Path) -> None:
    run = read_run(plane_run)
    longer = read_run(plane_run)
    vars(longer)["mesh"] = replace(run.mesh, x_period=2e6)
    with pytest.raises(InputError, match=r"repeats itself after 2000 km in x .*; compare runs on one plane"):
        compare_runs(run, longer)


def test_there_are_no_bands_of_latitude(any_plane: VoronoiMesh) -> None:
    shares = error_shares(any_plane, np.ones(any_plane.n_cells))
    assert {name for name in shares if "0" in name} == set()
    assert ("near_coast" in shares) == (any_plane.y_period == 0.0)


def test_truncation_errors_on_hexagons_are_of_second_order() -> None:
    coarse, fine = (vars(truncation_errors(hexagon_mesh(LENGTHS, (count, count)))) for count in (12, 24))
    for operator in ("gradient", "divergence", "perp", "kinetic_energy"):
        assert coarse[operator].l2 / fine[operator].l2 > 3.6, operator
        assert fine[operator].l2 < 0.04, operator


def test_the_flow_is_consistent() -> None:
    mesh = periodic_mesh(np.random.default_rng(3).random((300, 2)) * LENGTHS, LENGTHS)
    flow, points, step = plane_flow(mesh), points_at(surface_of(mesh), *places(50)), 10.0
    slopes = {}
    for axis in range(2):
        aside = np.zeros(3)
        aside[axis] = step
        slopes[axis] = (flow.velocity(points + aside) - flow.velocity(points - aside)) / (2.0 * step)
        gradient = (flow.streamfunction(points + aside) - flow.streamfunction(points - aside)) / (2.0 * step)
        np.testing.assert_allclose(flow.streamfunction_gradient(points)[:, axis], gradient, atol=1e-11)
    np.testing.assert_allclose(slopes[0][:, 1] - slopes[1][:, 0], flow.vorticity(points), atol=1e-16)
    np.testing.assert_allclose(slopes[0][:, 0] + slopes[1][:, 1], flow.divergence(points), atol=1e-16)
    whole = points + np.array([mesh.x_period, -mesh.y_period, 0.0])
    np.testing.assert_allclose(flow.velocity(whole), flow.velocity(points), atol=1e-18)


def test_spectra_of_a_wave_have_its_wavenumber(finer_plane_run: Path) -> None:
    """One wave along x and one along y, of which 1.15 fit the longer period: hypot(1, 1.15), rounded to two."""
    run = read_run(finer_plane_run)
    spectra = spectra_of(run, float(run.days[0]))
    assert spectra.kinetic_energy[2] > 0.999 * spectra.kinetic_energy.sum()
    speed = np.hypot(*(run.snapshot(0.0).fields[f"velocity_{name}"] for name in ("zonal", "meridional")))
    assert spectra.kinetic_energy.sum() == pytest.approx(0.5 * np.mean(speed**2), rel=1e-2)
    assert spectra.potential_enstrophy.sum() == pytest.approx(0.5 * 100.0 * (1e-4 / 100.0) ** 2, rel=1e-4)
    assert spectra.wavenumber_in_words == "wavenumber (waves in 1000 km)"


@pytest.mark.parametrize("waves", [(0, 0), (3, 0), (0, 2), (-2, 1), (2, 1)])
def test_power_is_at_the_wavenumber_of_a_wave(waves: tuple[int, int]) -> None:
    fourier = Fourier((4.0, 2.0), 6)
    x, y = fourier.points
    power = fourier.power(3.0 * np.cos(2.0 * np.pi * (waves[0] * x / 4.0 + waves[1] * y / 2.0)))
    number = round(np.hypot(waves[0], 2 * waves[1]))
    assert power[number] == pytest.approx(power.sum()) == pytest.approx(9.0 if waves == (0, 0) else 4.5)


def test_walls_have_no_spectra(plane_run: Path, channel: VoronoiMesh) -> None:
    run = read_run(plane_run)
    vars(run)["mesh"] = channel
    with pytest.raises(InputError, match="is on a plane with walls"):
        spectra_of(run, 0.0)

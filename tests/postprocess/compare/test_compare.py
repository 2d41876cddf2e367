"""Runs against solutions and against each other: what is measured, what is chosen, what is refused."""

import json
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.image import imread

from cases import Williamson1, Williamson2, Williamson5
from cases.base import Case
from mesh import VoronoiMesh, scvt_mesh
from mesh.integrals.quadrature import cell_means
from postprocess.compare import solutions
from postprocess.compare.comparison import compare_runs, comparison_record, fields_on
from postprocess.compare.norms import Norms, scalar_norms, vector_norms
from postprocess.compare.solutions import ExactSolution, RunSolution
from postprocess.figures import compare_maps, paper
from postprocess.figures.palettes import colours_for, deviation_colours
from postprocess.reference import stored_references
from postprocess.runs.reading import open_run, read_run
from swe import Simulation
from swe.errors import InputError

DAYS = 1.0


@dataclass(frozen=True)
class OwnCase(Williamson5):
    """A case that the registry does not know."""

    name = "of-my-own"


def write_run(directory: Path, mesh: VoronoiMesh, case: Case, days: float = DAYS, **options: object) -> Path:
    Simulation(mesh, case, directory, snapshot_interval=43200.0, **options).run(days, progress=False)
    return directory


@pytest.fixture(scope="module")
def small_mesh() -> VoronoiMesh:
    return scvt_mesh(162)


@pytest.fixture(scope="module")
def runs(small_mesh: VoronoiMesh, icosahedral_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of short runs of test cases 2 and 5 on two meshes."""
    folder = tmp_path_factory.mktemp("runs")
    write_run(folder / "steady-162", small_mesh, Williamson2())
    write_run(folder / "steady-642", icosahedral_mesh, Williamson2())
    write_run(folder / "mountain-162", small_mesh, Williamson5())
    write_run(folder / "mountain-162-longer", small_mesh, Williamson5(), days=1.5, time_step=1200.0)
    write_run(folder / "mountain-642", icosahedral_mesh, Williamson5())
    return folder


@pytest.fixture(autouse=True)
def folder_of_runs(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(runs)
    with_stored(monkeypatch, None)


def with_stored(monkeypatch: pytest.MonkeyPatch, reference: "Stored | None") -> None:
    """Let `reference` be the one that comes with the package for test case 5, and the one in any file."""
    path = None if reference is None else Path("williamson5.nc")
    monkeypatch.setattr(solutions, "stored_path", lambda case: path if case == "williamson5" else None)
    files = SimpleNamespace(stored_reference=lambda case: reference, read_reference=lambda path: reference)
    monkeypatch.setattr(solutions, "_reference_files", lambda: files)


def test_norms_from_the_exact_solution(runs: Path) -> None:
    """The numbers are those of the plain formulae at cells, edges and vertices."""
    comparison = compare_runs(Path("steady-162"), Path("steady-642"))
    assert comparison.solution.name == "exact solution"
    assert comparison.days == (DAYS,)
    run, case = read_run(Path("steady-642")), Williamson2()
    mesh, fields = run.mesh, run.last_snapshot().fields
    norms = comparison.entries[1].norms
    exact = case.thickness(mesh.lon_cell, mesh.lat_cell)
    assert norms["thickness"] == scalar_norms(fields["thickness"], exact, mesh.area_cell)
    wind = case.wind_speed * np.cos(mesh.lat_cell), np.zeros(mesh.n_cells)
    velocity = fields["velocity_zonal"], fields["velocity_meridional"]
    assert norms["velocity"].l2 == pytest.approx(vector_norms(velocity, wind, mesh.area_cell).l2)
    along_normal = case.wind_speed * np.cos(mesh.lat_edge) * np.cos(mesh.angle_edge)
    at_edges = scalar_norms(fields["normal_velocity"], along_normal, mesh.dc_edge * mesh.dv_edge)
    assert norms["normal_velocity"].l2 == pytest.approx(at_edges.l2)
    vorticity = 2 * case.wind_speed / case.radius * np.sin(mesh.lat_vertex)
    at_vertices = scalar_norms(fields["relative_vorticity"], vorticity, mesh.area_triangle)
    assert norms["vorticity"].l2 == pytest.approx(at_vertices.l2)
    coarse = comparison.entries[0].norms
    for name, of_coarse in coarse.items():
        assert norms[name].l2 < 0.7 * of_coarse.l2, name


def test_runs_on_one_mesh_are_compared_without_interpolation(runs: Path) -> None:
    first, second = (read_run(Path(name)) for name in ("mountain-162", "mountain-162-longer"))
    comparison = compare_runs(first.directory, second.directory)
    assert isinstance(comparison.solution, RunSolution)
    assert comparison.solution.run.directory == first.directory
    assert comparison.days == (1.0,)
    assert comparison.entries[0].norms == {}
    norms = comparison.entries[1].norms
    theirs, ours = (run.snapshot(1.0).fields for run in (first, second))
    area = first.mesh.area_cell
    assert norms["thickness"] == scalar_norms(ours["thickness"], theirs["thickness"], area)
    assert 0.0 < norms["thickness"].l2 < 1e-4
    velocity = [(each["velocity_zonal"], each["velocity_meridional"]) for each in (ours, theirs)]
    assert norms["velocity"].l2 == pytest.approx(vector_norms(*velocity, area).l2)
    assert "normal_velocity" not in norms


def test_runs_on_different_meshes_differ_as_their_errors_do(runs: Path) -> None:
    """The coarse run's distance to the fine one is its own error, but for the error of the fine one."""
    coarse, fine = Path("steady-162"), Path("steady-642")
    of_exact = compare_runs(coarse, fine, reference="exact")
    of_fine = compare_runs(coarse, reference=str(fine))
    for name in ("thickness", "velocity"):
        own, fine_error = (entry.norms[name].l2 for entry in of_exact.entries)
        assert abs(of_fine.entries[0].norms[name].l2 - own) < 1.2 * fine_error


def test_days_that_are_asked_for(runs: Path) -> None:
    comparison = compare_runs(Path("mountain-162"), Path("mountain-642"), days=[1.0, 0.5])
    assert comparison.days == (0.5, 1.0)
    assert [(entry.day, entry.run.mesh.n_cells) for entry in comparison.entries] == [
        (0.5, 162),
        (0.5, 642),
        (1.0, 162),
        (1.0, 642),
    ]
    assert [run.mesh.n_cells for run in comparison.compared] == [642]
    series = read_run(Path("mountain-642")).series
    for entry in comparison.entries[1::2]:
        row = np.flatnonzero(series["time"] == entry.day * 86400.0)[0]
        for name, value in entry.conservation.items():
            assert value == series[name][row]
    assert comparison.entries[1].conservation != comparison.entries[3].conservation


def test_background_of_a_bell_is_no_signal(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    case = Williamson1()
    write_run(tmp_path / "bell", small_mesh, case, days=0.5)
    run = read_run(tmp_path / "bell")
    exact = case.thickness(run.mesh.lon_cell, run.mesh.lat_cell, 43200.0) - case.background_depth
    found = run.last_snapshot().fields["thickness"] - case.background_depth
    norms = compare_runs(tmp_path / "bell").entries[0].norms
    assert norms["thickness"].l1 == pytest.approx(scalar_norms(found, exact, run.mesh.area_cell).l1)
    assert norms["thickness"].l1 > 0.1


def test_run_of_cell_means_is_compared_with_means(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_run(tmp_path / "means", small_mesh, Williamson2(), days=0.5, sampling="mean")
    run = read_run(tmp_path / "means")
    exact = fields_on(run, ExactSolution(Williamson2()), 0.0).thickness
    np.testing.assert_allclose(exact, run.snapshot(0.0).fields["thickness"], rtol=1e-14)
    np.testing.assert_allclose(exact, cell_means(run.mesh, Williamson2().thickness), rtol=1e-14)
    assert compare_runs(tmp_path / "means", days=[0.0]).entries[0].norms["thickness"].linf < 1e-14


@dataclass(frozen=True)
class Stored:
    """Stands for a spectral reference: the initial state of test case 5 a little deeper, known on day 0.5 alone."""

    case: Case
    days: tuple[float, ...] = (0.5, 10.0)
    name: str = "spectral T42"

    def uncertainty(self, day: float) -> dict[str, float]:
        return {"thickness": 1e-5}

    def thickness(self, longitude: np.ndarray, latitude: np.ndarray, day: float) -> np.ndarray:
        return 1.01 * self.case.thickness(longitude, latitude)

    def velocity(self, longitude: np.ndarray, latitude: np.ndarray, day: float) -> tuple[np.ndarray, np.ndarray]:
        return self.case.velocity(longitude, latitude)

    def vorticity(self, longitude: np.ndarray, latitude: np.ndarray, day: float) -> np.ndarray:
        return self.case.vorticity(longitude, latitude)


def test_stored_reference_is_chosen_where_it_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    both = [Path("mountain-162"), Path("mountain-642")]
    with_stored(monkeypatch, Stored(Williamson5()))
    comparison = compare_runs(*both)
    assert comparison.solution.name == "spectral T42"
    assert comparison.days == (0.5,)
    assert all(0.005 < entry.norms["thickness"].l2 < 0.02 for entry in comparison.entries)
    assert "normal_velocity" in comparison.entries[0].norms
    assert comparison_record(comparison)["uncertainty"] == {"0.5": {"thickness": 1e-5}}
    assert isinstance(compare_runs(*both, days=[1.0]).solution, RunSolution)
    with_stored(monkeypatch, Stored(Williamson5(wind_speed=10.0)))
    assert isinstance(compare_runs(*both).solution, RunSolution)
    with_stored(monkeypatch, None)
    assert isinstance(compare_runs(*both).solution, RunSolution)
    assert compare_runs(Path("steady-162")).solution.name == "exact solution"


def test_stored_reference_knows_all_days_that_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    both = [Path("mountain-162"), Path("mountain-642")]
    with_stored(monkeypatch, Stored(Williamson5()))
    assert isinstance(compare_runs(*both, days=[0.5, 1.0]).solution, RunSolution)
    assert compare_runs(*both, days=[0.5, 0.0]).days == (0.0, 0.5)
    with pytest.raises(InputError, match=r"nothing to compare mountain-162 with: .* is known on day 0\.5, 1;"):
        compare_runs(*both[:1], days=[0.5, 1.0])
    with_stored(monkeypatch, Stored(Williamson5(), days=(0.0, 0.5)))
    comparison = compare_runs(*both, days=[0.5, 0.0])
    assert (comparison.solution.name, comparison.days) == ("spectral T42", (0.0, 0.5))


def test_only_cases_of_the_package_have_stored_references(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(stored_references, "FOLDER", tmp_path / "references")
    (tmp_path / "references").mkdir()
    for name in ("williamson5", "mine"):
        (tmp_path / "references" / f"{name}.nc").touch()
    (tmp_path / "mine.py:Mine.nc").touch()
    assert stored_references.stored_path("williamson5") == tmp_path / "references" / "williamson5.nc"
    for name in ("williamson6", "mine", f"{tmp_path}/mine.py:Mine", "../references/williamson5"):
        assert stored_references.stored_path(name) is None


def test_reference_file_must_fit(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "reference.nc"
    file.touch()
    with_stored(monkeypatch, Stored(Williamson5()))
    assert compare_runs(Path("mountain-162"), reference=str(file)).days == (0.5,)
    with pytest.raises(InputError, match=r"reference\.nc is of case williamson5, but steady-162 of williamson2"):
        compare_runs(Path("steady-162"), reference=str(file))
    with_stored(monkeypatch, Stored(Williamson5(mountain_height=1000.0)))
    with pytest.raises(InputError, match=r"mountain_height = 1000\.0, but mountain-162 has 2000\.0"):
        compare_runs(Path("mountain-162"), reference=str(file))
    with_stored(monkeypatch, Stored(Williamson5(), days=(10.0, 15.0)))
    with pytest.raises(
        InputError, match=r"known on day 10, 15, but the snapshots that all runs have are of day 0\.5, 1;"
    ):
        compare_runs(Path("mountain-162"), reference=str(file))


def test_without_the_spectral_package(runs: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.undo()
    monkeypatch.chdir(runs)
    monkeypatch.setattr(stored_references, "FOLDER", tmp_path / "nowhere")
    monkeypatch.setitem(sys.modules, "ducc0", None)
    for name in ("harmonics", "spectral_model", "making", "reference_file"):
        monkeypatch.delitem(sys.modules, f"postprocess.reference.{name}", raising=False)
    with pytest.raises(InputError, match="there is nothing to compare mountain-162 with"):
        compare_runs(Path("mountain-162"))
    (tmp_path / "reference.nc").touch()
    (tmp_path / "williamson5.nc").touch()
    monkeypatch.setattr(stored_references, "FOLDER", tmp_path)
    for reference in (str(tmp_path / "reference.nc"), "auto"):
        with pytest.raises(InputError, match=r"need the package ducc0; install .*trisk\[reference\]"):
            compare_runs(Path("mountain-162"), reference=reference)
    with pytest.warns(UserWarning, match="the first run is the reference instead"):
        assert isinstance(compare_runs(Path("mountain-162"), Path("mountain-642")).solution, RunSolution)
    assert compare_runs(Path("steady-162")).solution.name == "exact solution"


def test_refusals(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_run(tmp_path / "other-radius", small_mesh, Williamson5(radius=6.0e6), days=0.5)
    write_run(tmp_path / "other-wind", small_mesh, Williamson5(wind_speed=10.0), days=0.5)
    write_run(tmp_path / "other-days", small_mesh, Williamson5(), days=0.25)
    write_run(tmp_path / "own", small_mesh, OwnCase(), days=0.5)
    mountain, steady = Path("mountain-162"), Path("steady-162")
    for directories, reference, days, words in (
        ([mountain], "auto", (), "there is nothing to compare mountain-162 with"),
        ([tmp_path / "own"], "auto", (), "there is nothing to compare"),
        ([tmp_path / "own"], "exact", (), "no exact solution of of-my-own is known"),
        ([mountain], "exact", (), "no exact solution of williamson5 is known"),
        ([mountain, mountain], "auto", (), "nothing but itself"),
        ([mountain], str(mountain), (), "nothing but itself"),
        ([mountain], "nowhere.nc", (), "there is no reference 'nowhere.nc'"),
        ([mountain], str(tmp_path), (), "holds no readable run"),
        ([mountain, steady], "auto", (), "steady-162 is of case williamson2, but mountain-162 of williamson5"),
        ([mountain], str(steady), (), "steady-162 is of case williamson2"),
        ([mountain, tmp_path / "other-radius"], "auto", (), "on a sphere of radius 6e\\+06 m"),
        ([mountain, tmp_path / "other-wind"], "auto", (), r"has wind_speed = 10\.0, but mountain-162 has 20\.0"),
        ([mountain, tmp_path / "other-days"], "auto", (), "the runs have no snapshot in common after the start"),
        ([mountain, tmp_path / "other-days"], "auto", (0.5,), r"no snapshot of day 0\.5; its days are 0, 0\.25"),
        ([mountain], str(tmp_path / "other-days"), (1.0,), "no snapshot of day 1"),
        ([steady], "auto", (7.0,), "no snapshot of day 7"),
        ([mountain], "auto", (float("nan"),), "mountain-162 has no snapshot of day nan; its days are 0, 0.5, 1"),
        ([mountain], "auto", (-1.0,), "mountain-162 has no snapshot of day -1"),
    ):
        with pytest.raises(InputError, match=words):
            compare_runs(*directories, reference=reference, days=days)


def test_own_cases_are_compared_with_each_other(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    for name, time_step in (("one", 1200.0), ("two", 600.0)):
        write_run(tmp_path / name, small_mesh, OwnCase(), days=0.5, time_step=time_step)
    with pytest.warns(UserWarning, match="of-my-own, .* without subtracting a background depth") as warned:
        entry = compare_runs(
            tmp_path / "one", tmp_path / "two", reference=str(tmp_path / "one"), days=[0.0, 0.5]
        ).entries[-1]
    assert len(warned) == 1
    assert 0.0 < entry.norms["thickness"].l2 < 1e-4


@dataclass(frozen=True)
class Plain(Williamson2):
    """Numbers in place of fields."""

    def velocity(self, longitude: np.ndarray, latitude: np.ndarray, time: float = 0.0) -> tuple:
        return 1, np.zeros(latitude.shape)


class FailsLater(Williamson2):
    """Knows no time but the start."""

    def thickness(self, longitude: np.ndarray, latitude: np.ndarray, time: float = 0.0) -> np.ndarray:
        return super().thickness(longitude, latitude) / [1.0][int(time > 0.0)]

    def vorticity(self, longitude: np.ndarray, latitude: np.ndarray, time: float = 0.0) -> np.ndarray:
        return np.zeros(3)

    def velocity(self, longitude: np.ndarray, latitude: np.ndarray, time: float = 0.0) -> tuple:
        return (np.zeros(latitude.shape),)


def test_exact_solution_that_fails_is_told_in_a_sentence() -> None:
    longitude, latitude = np.zeros(4), np.linspace(-1.0, 1.0, 4)
    zonal, meridional = ExactSolution(Plain()).velocity(longitude, latitude, 1.0)
    np.testing.assert_array_equal(zonal, np.ones(4))
    np.testing.assert_array_equal(meridional, np.zeros(4))
    solution = ExactSolution(FailsLater())
    assert solution.thickness(longitude, latitude, 0.0).shape == (4,)
    for function, words in (
        (solution.thickness, r"thickness of williamson2 failed in line \d+ of .*test_compare.py: IndexError"),
        (solution.vorticity, r"vorticity of williamson2 gives an array of shape \(3,\)"),
        (solution.velocity, "velocity of williamson2 gives tuple; it must give an eastward and a northward velocity"),
    ):
        with pytest.raises(InputError, match=words):
            function(longitude, latitude, 1.0)


def test_record_is_json_without_nan(runs: Path) -> None:
    comparison = compare_runs(Path("steady-162"))
    entry = comparison.entries[0]
    entry.norms["velocity"] = Norms(np.nan, np.nan, np.nan)  # as of a flow at rest
    record = json.loads(json.dumps(comparison_record(comparison), allow_nan=False))
    assert record["reference"] == "exact solution"
    assert record["entries"][0]["norms"]["velocity"] == {"l1": None, "l2": None, "linf": None}
    assert record["entries"][0]["norms"]["thickness"]["l2"] == entry.norms["thickness"].l2
    assert record["entries"][0]["cells"] == 162


def test_maps(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(paper, "ROWS", 45)
    monkeypatch.setattr(paper, "COLUMNS", 90)
    monkeypatch.setattr(compare_maps, "DOTS_PER_INCH", 40)
    comparison = compare_runs(Path("mountain-162"), Path("mountain-642"), reference="mountain-162")
    paths = compare_maps.write_maps(comparison, tmp_path / "maps")
    assert {path.name for path in paths} == {
        f"compare_{name}{kind}_day1.png"
        for name in ("thickness", "velocity", "vorticity")
        for kind in ("", "_difference")
    }
    for path in paths:
        assert imread(path).std() > 0.05, f"{path} is blank"


def test_maps_have_one_scale_and_say_what_it_is() -> None:
    x = np.linspace(-1.0, 3.0, paper.ROWS * paper.COLUMNS)
    panels = [x, x - 7.0, 0 * x]
    scales = (colours_for("thickness", [panel + 9.0 for panel in panels]), deviation_colours(panels))
    for colours, limits in zip(scales, [(1.0, 12.0), (-8.0, 8.0)], strict=True):
        figure = compare_maps.map_figure(panels, ["one", "two", "three"], "Heading", "label (m)", colours)
        images = [image for axes in figure.axes for image in axes.get_images()]
        assert [image.get_clim() for image in images] == [limits] * 3
        assert [axes.get_title() for axes in figure.axes[:3]] == ["one", "two", "three"]
        assert figure.get_suptitle() == "Heading"
        assert figure.axes[-1].get_xlabel() == "label (m)"
    figure = compare_maps.map_figure([np.abs(x)], ["one"], "Heading", "label (m)", colours_for("speed", x**2))
    assert figure.axes[0].get_images()[0].get_clim() == (0.0, 9.0)


def test_runs_that_are_open_and_the_table_in_print() -> None:
    coarse, fine = open_run("mountain-162"), open_run("mountain-642")
    comparison = compare_runs(coarse, fine, reference=fine, days=[0.5])
    assert comparison.entries[0].run is coarse
    of_folders = compare_runs("mountain-162", fine, reference="mountain-642", days=[0.5])
    assert of_folders.entries[0].norms == comparison.entries[0].norms
    title, header, *rows = repr(comparison).splitlines()
    assert title == "williamson5: error norms, reference: mountain-642, 642 cells"
    assert header.split() == ["day", "run", "cells", "field", "l1", "l2", "linf"]
    norms = comparison.entries[0].norms
    assert [row.split()[:4] for row in rows] == [["0.5", "mountain-162", "162", name] for name in norms]
    assert rows[0].split()[4:] == [f"{value:.2e}" for value in vars(norms["thickness"]).values()]


def test_open_runs_are_checked_as_folders_are(tmp_path: Path) -> None:
    shutil.copytree("mountain-162", tmp_path / "mixed")
    shutil.copy("mountain-642/mesh.nc", tmp_path / "mixed" / "mesh.nc")
    with pytest.raises(InputError, match=r"has 162 values of thickness, but mesh\.nc beside it needs 642"):
        compare_runs(open_run(tmp_path / "mixed"), "mountain-642")

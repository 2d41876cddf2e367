"""`open_run(...)`: maps of a run, and its grid."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mesh import VoronoiMesh, write_mesh
from postprocess import open_run
from swe.errors import InputError


@pytest.fixture
def ax() -> Axes:
    return Figure().subplots()


def values_on(ax: Axes) -> np.ndarray:
    return np.asarray(ax.collections[-1].get_array())


@pytest.mark.parametrize("name", ["thickness", "normal_velocity", "potential_vorticity"])
@pytest.mark.parametrize("day", [0.25, None])
def test_fields_of_cells_edges_and_vertices_on_a_day(
    ax: Axes, mountain_run: Path, name: str, day: float | None
) -> None:
    run = open_run(mountain_run)
    assert run.plot(name, day, ax) is ax
    snapshot = run.last_snapshot() if day is None else run.snapshot(day)
    assert set(values_on(ax)) == set(snapshot.fields[name])
    assert ax.get_title() == f"williamson5, 162 cells, day {snapshot.day:g}"


def test_a_region_and_options_of_maps(ax: Axes, mountain_run: Path) -> None:
    open_run(mountain_run).plot("potential_vorticity", ax=ax, region=(-120, -60, 10, 50), cmap="magma", label="mine")
    assert (ax.get_xlim(), ax.get_ylim()) == ((-120.0, -60.0), (10.0, 50.0))
    assert ax.collections[-1].get_cmap().name == "magma"
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_ylabel() == "mine"


def test_a_difference_of_datasets_is_drawn_on_its_day(ax: Axes, mountain_run: Path) -> None:
    pytest.importorskip("xarray")
    with open_run(mountain_run) as run:
        run.plot(run.data["thickness"] - run.data["thickness"].isel(Time=0), 0.25, ax)
        expected = run.snapshot(0.25).fields["thickness"] - run.snapshot(0.0).fields["thickness"]
    assert set(values_on(ax)) == set(expected)
    assert ax.collections[-1].get_cmap().name == "cmo.balance"


def test_a_day_without_a_snapshot_is_refused(ax: Axes, mountain_run: Path) -> None:
    with pytest.raises(InputError, match=r"has no snapshot of day 3; its days are 0, 0\.25, 0\.5"):
        open_run(mountain_run).plot("thickness", 3.0, ax)


def test_the_grid_is_one_of_uxarray(mountain_run: Path) -> None:
    uxarray = pytest.importorskip("uxarray")
    run = open_run(mountain_run)
    assert isinstance(run.grid, uxarray.Grid)
    assert (run.grid.n_face, run.grid.n_node) == (162, 320)
    assert run.grid is run.grid


def test_without_uxarray_a_sentence_names_the_command(mountain_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "uxarray", None)
    with pytest.raises(InputError, match=r"uxarray, .*; install it with pip install 'trisk\[uxarray\]'$"):
        _ = open_run(mountain_run).grid


def test_a_run_on_a_plane_is_drawn_and_shown(ax: Axes, plane_run: Path) -> None:
    with open_run(plane_run) as run:
        drawn = run.plot("relative_vorticity", day=0.01, ax=ax, region=(9e5, 11e5, 0.0, 1e5))
        assert (drawn.get_xlim(), drawn.get_ylabel()) == ((9e5, 11e5), "y (km)")
        assert "day 0.01" in drawn.get_title()
        np.testing.assert_array_equal(run.data["thickness"][-1], run.last_snapshot().fields["thickness"])
        assert "coast" not in repr(run)


def test_walls_of_a_plane_are_told_without_a_sphere(plane_run: Path, channel: VoronoiMesh, tmp_path: Path) -> None:
    directory = shutil.copytree(plane_run, tmp_path / "run")
    (directory / "mesh.nc").unlink()
    write_mesh(channel, directory / "mesh.nc")
    assert "coast: walls" in repr(open_run(directory))


def test_grids_of_uxarray_are_of_spheres(plane_run: Path) -> None:
    with pytest.raises(InputError, match=r"mesh.nc is a mesh on a plane, and grids of uxarray are on spheres alone"):
        _ = open_run(plane_run).grid

"""Commands on the file of a mesh with walls: quality, partition, runs and their figures."""

import json
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, write_mesh
from mesh.discrete.walls import wall_edges
from mesh.files.cells_of_file import read_cells
from mesh.partition.cell_graph import cell_graph, pieces
from mesh.parts.culling import culled
from tests.plain_culler import cull_file
from tests.trisk.conftest import Call


@pytest.fixture(scope="module")
def sea(icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    """Two seas, the southern one with an island."""
    kept = np.abs(icosahedral_mesh.lat_cell - 0.4) > 0.2
    kept[np.argmin(icosahedral_mesh.lat_cell)] = False
    return culled(icosahedral_mesh, kept)


@pytest.fixture(scope="module")
def sea_file(sea: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sea") / "sea.nc"
    write_mesh(sea, path)
    return path


def test_quality(trisk: Call, sea_file: Path, sea: VoronoiMesh, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    code, out, err = trisk("quality", sea_file, "--json")
    assert (code, err) == (0, "")
    measured = json.loads(out)
    assert measured["cells"] == sea.n_cells
    assert 1.0 < measured["mu"] < 1.3
    assert 0.96 < measured["q_min"] < measured["q_avg"] < 1.0
    assert measured["residual"] < 1e-5
    assert trisk("quality", sea_file)[0] == 0
    write_mesh(culled(icosahedral_mesh, np.arange(642) == 3), tmp_path / "pond.nc")
    pond = json.loads(trisk("quality", tmp_path / "pond.nc", "--json")[1])
    assert (pond["cells"], pond["mu"], pond["q_avg"]) == (1, None, None)


def test_partition(trisk: Call, sea_file: Path, sea: VoronoiMesh, tmp_path: Path) -> None:
    """The graph is that of the seas, and no block needs to lie on both."""
    pytest.importorskip("pymetis")
    code, out, _ = trisk("partition", sea_file, "--blocks", 4, "-o", tmp_path)
    assert code == 0
    assert "islands" not in out
    graph = cell_graph(sea)
    first, *rows = (tmp_path / "graph.info").read_text().splitlines()
    assert first.split()[:2] == [str(sea.n_cells), str(np.count_nonzero(sea.cells_on_edge[:, 1] >= 0))]
    assert rows[7].split() == [str(cell + 1) for cell in graph.rows_of(np.array([7]))[1]]
    blocks = np.loadtxt(tmp_path / "graph.info.part.4", dtype=int)
    assert pieces(graph, blocks)[0] == 4
    from_file, _ = read_cells(sea_file)
    np.testing.assert_array_equal(from_file.neighbours, graph.neighbours)


def test_run_and_figures(trisk: Call, sea_file: Path, sea: VoronoiMesh, tmp_path: Path) -> None:
    assert trisk("run", "lake-at-rest", "--mesh", sea_file, "--days", 1, "-o", tmp_path / "rest", "-q")[0] == 0
    with netCDF4.Dataset(tmp_path / "rest" / "diagnostics.nc") as file:
        assert file["max_speed"][-1] < 1e-11
        assert abs(file["mass_change"][-1]) < 1e-15
    assert trisk("run", "williamson5", "--mesh", sea_file, "--days", 0.5, "-o", tmp_path / "flow", "-q")[0] == 0
    with netCDF4.Dataset(tmp_path / "flow" / "history.nc") as file:
        velocity = np.asarray(file["normal_velocity"][:])
        assert velocity.shape[1] == sea.n_edges
        assert not velocity[:, wall_edges(sea)].any()
        assert np.abs(velocity).max() > 5.0
    with netCDF4.Dataset(tmp_path / "flow" / "diagnostics.nc") as file:
        assert np.abs(file["mass_change"][:]).max() < 1e-14
    assert trisk("plot", tmp_path / "flow")[0] == 0
    assert (tmp_path / "flow" / "figures" / "potential_vorticity.png").stat().st_size > 10_000


@pytest.mark.filterwarnings("ignore::mesh.MeshWarning")
def test_a_file_of_the_communitys_culler_runs_like_ours(
    trisk: Call, sea_file: Path, icosahedral_mesh: VoronoiMesh, tmp_path: Path
) -> None:
    """Byte for byte, but for the angles of its walls, which no step reads."""
    kept = np.abs(icosahedral_mesh.lat_cell - 0.4) > 0.2
    kept[np.argmin(icosahedral_mesh.lat_cell)] = False
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    cull_file(tmp_path / "mesh.nc", tmp_path / "theirs.nc", kept)
    for name, file in (("ours", sea_file), ("theirs", tmp_path / "theirs.nc")):
        assert trisk("run", "williamson5", "--mesh", file, "--days", 0.25, "-o", tmp_path / name, "-q")[0] == 0
    ours, theirs = (netCDF4.Dataset(tmp_path / name / "history.nc") for name in ("ours", "theirs"))
    with ours, theirs:
        for name in ("thickness", "normal_velocity", "potential_vorticity"):
            np.testing.assert_array_equal(ours[name][:], theirs[name][:])

"""`trisk partition`: what it writes, prints and refuses."""

import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from matplotlib.image import imread

from mesh import VoronoiMesh, partition_mesh, scvt_mesh, write_mesh
from mesh.files.partition_files import read_partition
from mesh.partition.cell_graph import cell_graph
from mesh.partition.measures import measure_partition
from tests.cut_mesh import without_cells
from tests.trisk.conftest import Call

pytest.importorskip("pymetis", reason="the extra mpi is not installed")


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


def test_files_table_and_picture(trisk: Call, mesh_file: Path, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "blocks"
    code, out, err = trisk("partition", mesh_file, "--blocks", 12, "-o", folder)
    assert (code, err) == (0, "")
    assert sorted(path.name for path in folder.iterdir()) == ["blocks.png", "graph.info", "graph.info.part.12"]
    partition = partition_mesh(icosahedral_mesh, 12)
    np.testing.assert_array_equal(
        read_partition(folder / "graph.info.part.12", 642).block_of_cell, partition.block_of_cell
    )
    assert (folder / "graph.info").read_text().startswith("642 1920\n")
    assert imread(folder / "blocks.png").std() > 0.05
    measures = measure_partition(cell_graph(icosahedral_mesh), partition)
    rows = {cells[1].strip(): cells[2].strip() for line in out.splitlines() if len(cells := line.split("│")) == 4}
    assert rows == {
        "cells": "642",
        "cells of a block: fewest, mean, most": f"{measures.cells[0]}, 53.50, {measures.cells[2]}",
        "largest block / mean": f"{measures.balance:.4f}",
        "edges between blocks (edge cut)": str(measures.edge_cut),
        "neighbouring blocks: mean, most": f"{measures.neighbours[0]:.2f}, {measures.neighbours[1]}",
        "cells within 1 of a block (halo): mean, most": f"{measures.halos[0][0]:.2f}, {measures.halos[0][1]}",
        "cells within 2 of a block (halo): mean, most": f"{measures.halos[1][0]:.2f}, {measures.halos[1][1]}",
        "blocks in pieces or empty": "0",
    }
    assert out.splitlines()[-3:] == [str(folder / name) for name in ("graph.info", "graph.info.part.12", "blocks.png")]
    code, out, err = trisk("partition", mesh_file, "--blocks", 3, "-o", folder, "-q")
    assert (code, out, err) == (0, "", "")
    assert (folder / "graph.info.part.3").exists()


def test_a_large_mesh_gives_the_same_blocks(
    trisk: Call, mesh_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of which only generators and triangles are read: others may be wrong."""
    assert trisk("partition", mesh_file, "--blocks", 12, "-o", tmp_path / "small")[0] == 0
    monkeypatch.setattr("trisk.arguments.cells.MOST_POLYGONS", 641)
    with netCDF4.Dataset(mesh_file, "a") as file:
        file["areaCell"][:] = -1.0
    assert trisk("partition", mesh_file, "--blocks", 12, "-o", tmp_path / "large")[0] == 0
    for name in ("graph.info", "graph.info.part.12"):
        assert (tmp_path / "small" / name).read_bytes() == (tmp_path / "large" / name).read_bytes()
    small, large = (imread(tmp_path / name / "blocks.png") for name in ("small", "large"))
    assert small.shape != large.shape


def test_weights_are_balanced(trisk: Call, mesh_file: Path, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    weights = 1.0 + 3.0 * (icosahedral_mesh.z_cell > 0.0)
    with netCDF4.Dataset(mesh_file, "a") as file:
        file.createVariable("cost", "f8", ("nCells",))[:] = weights
    code, out, _ = trisk("partition", mesh_file, "--blocks", 6, "-o", tmp_path, "--weights", f"{mesh_file}:cost")
    assert code == 0
    load = np.bincount(read_partition(tmp_path / "graph.info.part.6", 642).block_of_cell, weights)
    assert load.max() <= 1.05 * load.mean()
    assert f"│ {load.max() / load.mean():.4f}" in out


def test_what_is_mended_is_said(trisk: Call, mesh_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "mesh.partition.partition.metis_blocks", lambda graph, n_blocks, weights: np.arange(graph.n_cells) % n_blocks
    )
    code, out, _ = trisk("partition", mesh_file, "--blocks", 12, "-o", tmp_path / "blocks")
    assert code == 0
    assert "METIS left blocks 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 2 more in pieces or empty; mended\n" in out


def test_blocks_on_several_islands_are_said(trisk: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    islands = without_cells(scvt_mesh(642), np.abs(scvt_mesh(642).lat_cell) < 0.2)
    monkeypatch.setattr("trisk.arguments.cells.count_cells", lambda path: islands.n_cells)
    monkeypatch.setattr("trisk.arguments.cells.read_mesh", lambda path, recompute_metrics: islands)
    _, out, _ = trisk("partition", "islands.nc", "--blocks", 1, "-o", tmp_path)
    assert "block 0 lies on several islands of the mesh\n" in out
    _, out, _ = trisk("partition", "islands.nc", "--blocks", 2, "-o", tmp_path)
    assert "islands of" not in out


@pytest.mark.parametrize("blocks", [0, -1, 643])
def test_numbers_of_blocks_that_are_refused(trisk: Call, mesh_file: Path, tmp_path: Path, blocks: int) -> None:
    code, out, err = trisk("partition", mesh_file, "--blocks", blocks, "-o", tmp_path / "blocks")
    assert (code, out) == (2, "")
    assert err == f"error: 642 cells cannot be divided into {blocks} blocks; ask for 1 to 642 blocks\n"
    assert not (tmp_path / "blocks").exists()


def test_files_that_are_refused(trisk: Call, mesh_file: Path, tmp_path: Path) -> None:
    code, _, err = trisk("partition", mesh_file, "--blocks", 3, "-o", mesh_file)
    assert code == 2
    assert "is not a writable folder; choose another place" in err
    code, _, err = trisk("partition", tmp_path / "none.nc", "--blocks", 3, "-o", tmp_path)
    assert (code, err) == (2, f"error: {tmp_path / 'none.nc'}: no such file; give an MPAS mesh file\n")
    (tmp_path / "text.nc").write_text("no mesh")
    code, _, err = trisk("partition", tmp_path / "text.nc", "--blocks", 3, "-o", tmp_path)
    assert code == 2
    assert "not a readable NetCDF file" in err
    code, _, err = trisk("partition", mesh_file, "--blocks", 3, "-o", tmp_path, "--weights", "cost")
    assert code == 2
    assert "'cost' names no variable of a file; write FILE.nc:VARIABLE" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mesh.nc", "text.nc"]


def test_without_the_extra_one_sentence_says_so(
    trisk: Call, mesh_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pymetis", None)
    code, _, err = trisk("partition", mesh_file, "--blocks", 3, "-o", tmp_path / "blocks")
    assert code == 2
    assert err == (
        "error: a mesh is divided into blocks by the package pymetis; install it with pip install 'trisk[mpi]'\n"
    )

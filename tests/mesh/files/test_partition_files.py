"""The files that METIS and MPAS read: their text, their way back, and what is refused."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, Partition, VoronoiMesh
from mesh.files import partition_files
from mesh.files.partition_files import read_partition, read_weights, write_partition
from mesh.partition.cell_graph import cell_graph, graph_of_rings
from tests.cut_mesh import without_cap


@pytest.fixture
def blocks(icosahedral_mesh: VoronoiMesh) -> Partition:
    return Partition(np.floor(icosahedral_mesh.lon_cell).astype(np.int32), 7)


def parsed(text: str) -> tuple[int, int, list[set[int]]]:
    """The numbers of a graph in METIS's format, and the neighbours of each node counted from 1."""
    head, *lines = text.split("\n")
    assert lines.pop() == ""
    n_nodes, n_edges = map(int, head.split(" "))
    return n_nodes, n_edges, [set(map(int, line.split())) for line in lines]


@pytest.mark.parametrize("at_once", [7, 100_000])
def test_the_graph_as_metis_reads_it(
    any_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at_once: int
) -> None:
    monkeypatch.setattr(partition_files, "CELLS_AT_ONCE", at_once)
    for mesh in (any_mesh, without_cap(any_mesh)):
        path, _ = write_partition(tmp_path, cell_graph(mesh), Partition(np.zeros(mesh.n_cells, dtype=np.int32), 1))
        assert path == tmp_path / "graph.info"
        n_nodes, n_edges, neighbours = parsed(path.read_text())
        assert n_nodes == len(neighbours) == mesh.n_cells
        inner = [(one + 1, other + 1) for one, other in mesh.cells_on_edge.tolist() if min(one, other) >= 0]
        assert n_edges == len(inner)
        expected: list[set[int]] = [set() for _ in range(mesh.n_cells)]
        for one, other in inner:
            expected[one - 1].add(other)
            expected[other - 1].add(one)
        assert neighbours == expected


def test_a_cell_alone_has_an_empty_line(tmp_path: Path) -> None:
    graph = graph_of_rings(np.array([1, 0, 1]), np.array([[2], [0], [0]]))
    path, _ = write_partition(tmp_path, graph, Partition(np.zeros(3, dtype=np.int32), 1))
    assert path.read_text() == "3 1\n3\n\n1\n"


def test_blocks_are_read_back(icosahedral_mesh: VoronoiMesh, blocks: Partition, tmp_path: Path) -> None:
    _, path = write_partition(tmp_path, cell_graph(icosahedral_mesh), blocks)
    assert path == tmp_path / "graph.info.part.7"
    assert path.read_text() == "".join(f"{int(longitude)}\n" for longitude in icosahedral_mesh.lon_cell)
    for given in (read_partition(path, 642), read_partition(path, 642, 7)):
        assert given.n_blocks == 7
        assert given.block_of_cell.dtype == np.int32
        np.testing.assert_array_equal(given.block_of_cell, blocks.block_of_cell)
    assert read_partition(path, 642, 9).n_blocks == 9
    assert sorted(each.name for each in tmp_path.iterdir()) == ["graph.info", "graph.info.part.7"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0\n1\n", "2 blocks for 3 cells; give the file of this mesh"),
        ("0\n1\n2\n0\n", "4 blocks for 3 cells"),
        ("0\n3\n1\n", "line 2 names block 3, but the 3 blocks are 0 to 2"),
        ("0\n1\n-1\n", "line 3 names block -1, but the 3 blocks"),
        ("0\none\n2\n", "give a file with one whole number, the block, for each cell"),
        ("0\n1.5\n2\n", "give a file with one whole number, the block, for each cell"),
        ("0\n99999999999999999999\n2\n", "give a file with one whole number, the block, for each cell"),
        ("", "0 blocks for 3 cells"),
    ],
)
def test_files_that_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "graph.info.part.3"
    path.write_text(text)
    with pytest.raises(MeshError, match=f"part.3: .*{message}"):
        read_partition(path, 3)


def test_names_that_are_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match="No such file or directory; give a file with the block of each cell"):
        read_partition(tmp_path / "graph.info.part.3", 3)
    for name in ("blocks.txt", "blocks", "graph.info.part.0"):
        (tmp_path / name).write_text("0\n")
        with pytest.raises(MeshError, match=r"does not end with the number of blocks; name it graph\.info\.part\.N"):
            read_partition(tmp_path / name, 1)
        assert read_partition(tmp_path / name, 1, 1).n_blocks == 1


def test_weights_are_read_or_refused(tmp_path: Path) -> None:
    path = tmp_path / "costs.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("nCells", 3)
        file.createDimension("other", 4)
        for name, kind, dimension in (("cost", "i4", "nCells"), ("far", "f8", "other"), ("words", str, "nCells")):
            file.createVariable(name, kind, (dimension,))
        file["cost"][:] = [3, 1, 2]
    assert read_weights(path, "cost", 3).tolist() == [3.0, 1.0, 2.0]
    for name, message in (
        ("price", "no variable named 'price'; name one that holds a weight for each cell"),
        ("far", r"far of shape \(4,\) and type float64 is not one number for each of 3 cells"),
        ("words", "words of shape .* is not one number for each of 3 cells"),
    ):
        with pytest.raises(MeshError, match=rf"costs\.nc: {message}"):
            read_weights(path, name, 3)
    with pytest.raises(MeshError, match="no such file; give one with a weight for each cell"):
        read_weights(tmp_path / "none.nc", "cost", 3)
    (tmp_path / "text.nc").write_text("no numbers")
    with pytest.raises(MeshError, match="not a readable NetCDF file"):
        read_weights(tmp_path / "text.nc", "cost", 3)

"""Of a file only the cells: the same as of the whole mesh, from generators and triangles alone."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, read_mesh, write_mesh
from mesh.files.cells_of_file import count_cells, read_cells
from mesh.partition.cell_graph import cell_graph


def part_of_file(mesh: VoronoiMesh, folder: Path, *names: str) -> Path:
    """A file with the variables `names` of the mesh alone."""
    write_mesh(mesh, folder / "mesh.nc")
    with netCDF4.Dataset(folder / "mesh.nc") as old, netCDF4.Dataset(folder / "part.nc", "w") as new:
        for name, each in old.dimensions.items():
            new.createDimension(name, len(each))
        for name in names:
            copy = new.createVariable(name, old[name].dtype, old[name].dimensions)
            copy.setncatts(old[name].__dict__)
            copy[:] = old[name][:]
    return folder / "part.nc"


@pytest.mark.parametrize("names", [("xCell", "yCell", "zCell"), ("lonCell", "latCell")])
def test_generators_and_triangles_are_enough(any_mesh: VoronoiMesh, tmp_path: Path, names: tuple[str, ...]) -> None:
    path = part_of_file(any_mesh, tmp_path, *names, "cellsOnVertex")
    graph, points = read_cells(path)
    whole = read_mesh(tmp_path / "mesh.nc")
    np.testing.assert_array_equal(graph.starts, cell_graph(whole).starts)
    np.testing.assert_array_equal(graph.neighbours, cell_graph(whole).neighbours)
    np.testing.assert_allclose(points, whole.cell_points, atol=1e-14)
    assert count_cells(path) == any_mesh.n_cells


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("xCell", "yCell", "zCell"), "cellsOnVertex is missing; a mesh file must have its triangles"),
        (("xCell", "yCell", "cellsOnVertex"), "xCell, yCell and zCell are missing, and lonCell and latCell too"),
    ],
)
def test_files_without_cells_are_refused(
    small_mesh: VoronoiMesh, tmp_path: Path, names: tuple[str, ...], message: str
) -> None:
    with pytest.raises(MeshError, match=rf"part\.nc: {message}"):
        read_cells(part_of_file(small_mesh, tmp_path, *names))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("cellsOnVertex", 163, r"vertices 5 \(counted from 0\): cellsOnVertex names none of the 162 cells"),
        ("xCell", np.nan, r"cells 5 \(counted from 0\): the generator is no place on a sphere"),
    ],
)
def test_wrong_cells_are_refused(
    small_mesh: VoronoiMesh, tmp_path: Path, name: str, value: float, message: str
) -> None:
    path = part_of_file(small_mesh, tmp_path, "xCell", "yCell", "zCell", "cellsOnVertex")
    with netCDF4.Dataset(path, "a") as file:
        file[name][5] = value
    with pytest.raises(MeshError, match=message):
        read_cells(path)


def test_what_is_no_mesh_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"mesh\.nc: no such file; give an MPAS mesh file"):
        count_cells(tmp_path / "mesh.nc")
    (tmp_path / "mesh.nc").write_text("no numbers")
    with pytest.raises(MeshError, match=r"mesh\.nc: not a readable NetCDF file"):
        read_cells(tmp_path / "mesh.nc")

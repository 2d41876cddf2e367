"""What large meshes need: formats that hold their arrays, and arrays that are written in slabs."""

from pathlib import Path

import pytest

from mesh import MeshError, VoronoiMesh, read_mesh, write_mesh
from mesh.conventions import dimension_sizes
from mesh.files.io import least_sizes, mesh_hash, require_format


def test_arrays_too_large_for_classic_files_are_refused() -> None:
    """Sizes are of any magnitude; nothing of this size is made."""
    sizes = {**least_sizes(10_485_762), "max_edges": 10, "max_edges_2": 20}
    for file_format in ("cdf5", "netcdf4"):
        require_format(file_format, sizes)
    with pytest.raises(
        MeshError,
        match=r"weightsOnEdge of 10485762 cells takes 5\.0 GB, and files of the format classic hold arrays of 4\.3 GB "
        r"at most; choose the format cdf5 or netcdf4",
    ):
        require_format("classic", sizes)


def test_least_sizes_are_those_of_icosahedral_meshes(icosahedral_mesh: VoronoiMesh) -> None:
    assert least_sizes(icosahedral_mesh.n_cells) == dimension_sizes(icosahedral_mesh)


def test_the_largest_classic_file_holds_some_fifteen_million_cells() -> None:
    require_format("classic", least_sizes(14_900_000))
    with pytest.raises(MeshError, match="weightsOnEdge"):
        require_format("classic", least_sizes(15_000_000))


@pytest.mark.parametrize("rows", [1, 1000, 10**6])
def test_slabs_of_any_size_make_the_same_file(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rows: int
) -> None:
    monkeypatch.setattr("mesh.files.io.SLAB", rows)
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    assert mesh_hash(read_mesh(tmp_path / "mesh.nc")) == mesh_hash(icosahedral_mesh)

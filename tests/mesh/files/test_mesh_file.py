"""What a file of a mesh is refused for before its numbers are looked at, and the precision of its generators."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, read_mesh, write_mesh
from mesh.files.mesh_file import read_content


@pytest.mark.parametrize(
    ("dimension", "size", "kept"), [("TWO", 3, "cellsOnEdge"), ("vertexDegree", 4, "cellsOnVertex")]
)
def test_an_edge_has_two_ends_and_a_triangle_three_corners(
    small_mesh: VoronoiMesh, tmp_path: Path, dimension: str, size: int, kept: str
) -> None:
    write_mesh(small_mesh, tmp_path / "mesh.nc")
    with netCDF4.Dataset(tmp_path / "mesh.nc") as old, netCDF4.Dataset(tmp_path / "odd.nc", "w") as new:
        wrong = old.dimensions[dimension].name
        for name, each in old.dimensions.items():
            new.createDimension(name, size if name == wrong else len(each))
        for name in ("xCell", "yCell", "zCell", kept):
            copy = new.createVariable(name, old[name].dtype, old[name].dimensions)
            copy[:] = np.resize(old[name][:], copy.shape)
    with pytest.raises(
        MeshError, match=rf"odd\.nc: {kept} has a dimension {dimension} of {size} instead of {size - 1}$"
    ):
        read_mesh(tmp_path / "odd.nc")


@pytest.mark.parametrize(
    "names", [("xCell", "yCell", "zCell"), ("lonCell", "latCell"), ("zCell", "lonCell", "latCell")]
)
@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_the_precision_is_that_of_the_generators(names: tuple[str, ...], kind: str, tmp_path: Path) -> None:
    """Cartesian coordinates, where there are any, say it, and else longitudes and latitudes; nothing else does."""
    other = {"f4": "f8", "f8": "f4"}[kind]
    with netCDF4.Dataset(tmp_path / "mesh.nc", "w") as file:
        file.createDimension("nCells", 12)
        for name in (*names, "areaCell"):
            says = name in names and (name in ("xCell", "yCell", "zCell") or "zCell" not in names)
            file.createVariable(name, kind if says else other, ("nCells",))[:] = 0.5
        assert read_content(file).single_precision == (kind == "f4")

"""What is read of a file slab by slab is what the mesh in memory gives, bit for bit."""

from dataclasses import fields
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, read_mesh, scvt_mesh, write_mesh
from mesh.arrays import Index
from mesh.files import stamped_file
from mesh.files.io import mesh_hash
from mesh.files.part_of_file import read_blocks_along_curve, read_part, scaled_hash_of_file, write_scaled_copy
from mesh.files.stamped_file import NotValidatedError
from mesh.geometry.sphere import normalize
from mesh.partition.curve import blocks_along_curve
from mesh.parts.culling import culled
from mesh.parts.mesh_part import MeshPart, cut_part
from mesh.triangulation.ordering import hilbert_keys

EARTH = 6371229.0


@pytest.fixture(scope="module")
def nested_mesh() -> VoronoiMesh:
    return scvt_mesh(nested=scvt_mesh(42), density="refined-circle", cells=60)


@pytest.fixture(params=["icosahedral", "larger", "nested", "sea"])
def mesh(
    request: pytest.FixtureRequest,
    icosahedral_mesh: VoronoiMesh,
    larger_mesh: VoronoiMesh,
    nested_mesh: VoronoiMesh,
) -> VoronoiMesh:
    """The nested one has generators that were held, the sea has walls."""
    if request.param == "sea":
        return culled(larger_mesh, larger_mesh.lat_cell < 0.6)
    return {"icosahedral": icosahedral_mesh, "larger": larger_mesh, "nested": nested_mesh}[str(request.param)]


@pytest.fixture
def mesh_file(mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A stamped file, which is read in slabs that hold no ring array whole."""
    monkeypatch.setattr(stamped_file, "SLAB", 40 * mesh.n_cells)
    write_mesh(mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


def assert_same(found: object, expected: object) -> None:
    """All fields of two meshes or parts are the same, to the bit."""
    for each in fields(expected):  # type: ignore[arg-type]
        value, wanted = getattr(found, each.name), getattr(expected, each.name)
        if isinstance(wanted, np.ndarray):
            np.testing.assert_array_equal(value, wanted, err_msg=each.name, strict=True)
            assert value.tobytes() == wanted.tobytes(), each.name
        elif isinstance(wanted, VoronoiMesh):
            assert_same(value, wanted)
        else:
            assert value == wanted, each.name


def scattered(mesh: VoronoiMesh, count: int) -> Index:
    """Blocks of which each has cells everywhere."""
    return np.random.default_rng(3).integers(0, count, mesh.n_cells)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_parts_are_those_of_the_mesh_in_memory(mesh: VoronoiMesh, mesh_file: Path, count: int) -> None:
    blocks = read_blocks_along_curve(mesh_file, count)
    for block in range(count):
        assert_same(read_part(mesh_file, blocks, block, 2), cut_part(mesh, blocks, block, 2))
    blocks = scattered(mesh, 4 * count)
    assert_same(read_part(mesh_file, blocks, 1, 0), cut_part(mesh, blocks, 1, 0))


def test_only_what_a_part_needs_is_read(
    larger_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No more rows together than a slab holds, and of a twentieth of the mesh much fewer than all."""
    write_mesh(larger_mesh, tmp_path / "mesh.nc")
    monkeypatch.setattr(stamped_file, "SLAB", 5000)
    sizes, true_read = [], stamped_file.read_variable

    def counted(*arguments: object) -> object:
        values = true_read(*arguments)  # type: ignore[arg-type]
        sizes.append(values.nbytes)  # type: ignore[union-attr]
        return values

    monkeypatch.setattr(stamped_file, "read_variable", counted)
    blocks = read_blocks_along_curve(tmp_path / "mesh.nc", 20)
    part: MeshPart = read_part(tmp_path / "mesh.nc", blocks, 7, 2)
    assert part.mesh.n_cells < 400
    assert max(sizes) <= 5000
    whole = sum(value.nbytes for value in vars(larger_mesh).values() if isinstance(value, np.ndarray))
    assert sum(sizes) < 0.6 * whole


def test_blocks_along_the_curve_are_those_of_the_mesh_in_memory(mesh: VoronoiMesh, mesh_file: Path) -> None:
    keys = hilbert_keys(normalize(mesh.cell_points))
    for count in (2, 5):
        blocks = read_blocks_along_curve(mesh_file, count)
        np.testing.assert_array_equal(blocks, blocks_along_curve(keys, (mesh.cells_on_edge,), count), strict=True)
    for count in (0, mesh.n_cells + 1):
        with pytest.raises(MeshError, match=rf"cells cannot be divided into {count} blocks"):
            read_blocks_along_curve(mesh_file, count)


@pytest.mark.parametrize("radius", [1.0, EARTH])
def test_the_hash_is_that_of_the_mesh_in_memory(mesh_file: Path, radius: float) -> None:
    assert scaled_hash_of_file(mesh_file, radius) == mesh_hash(read_mesh(mesh_file).scaled(radius))


def test_a_stamp_that_does_not_fit_gives_no_hash(mesh_file: Path, tmp_path: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["edgesOnEdge"][-1, -1] = 7
    assert scaled_hash_of_file(mesh_file, EARTH) is None


def test_a_file_without_a_stamp_is_left_to_others(mesh: VoronoiMesh, mesh_file: Path, tmp_path: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file.delncattr("validated_hash")
    assert scaled_hash_of_file(mesh_file, EARTH) is None
    with pytest.raises(NotValidatedError, match=r"mesh\.nc: the file has no stamp of a validated mesh; read"):
        read_part(mesh_file, scattered(mesh, 2), 0, 2)
    with pytest.raises(NotValidatedError):
        write_scaled_copy(mesh_file, tmp_path / "copy.nc", EARTH, "0" * 64)
    assert not (tmp_path / "copy.nc").exists()


def test_what_cannot_be_read_is_told_of(mesh: VoronoiMesh, mesh_file: Path, tmp_path: Path) -> None:
    blocks = scattered(mesh, 2)
    with pytest.raises(MeshError, match=r"none\.nc: no such file; give an MPAS mesh file"):
        read_part(tmp_path / "none.nc", blocks, 0, 2)
    with pytest.raises(MeshError, match="block 2 has no cells"):
        read_part(mesh_file, blocks, 2, 2)
    with pytest.raises(MeshError, match=r"absent/copy\.nc: cannot be written"):
        write_scaled_copy(mesh_file, tmp_path / "absent" / "copy.nc", EARTH, "0" * 64)


@pytest.mark.parametrize("file_format", ["netcdf4", "cdf5"])
def test_a_scaled_copy_is_the_file_of_the_scaled_mesh(mesh_file: Path, tmp_path: Path, file_format: str) -> None:
    expected = read_mesh(mesh_file).scaled(EARTH)
    write_mesh(expected, tmp_path / "expected.nc", "by a test", file_format)
    identity = scaled_hash_of_file(mesh_file, EARTH)
    assert identity is not None
    write_scaled_copy(mesh_file, tmp_path / "copy.nc", EARTH, identity, "by a test", file_format)
    assert contents(tmp_path / "copy.nc") == contents(tmp_path / "expected.nc")
    assert_same(read_mesh(tmp_path / "copy.nc"), expected)


def contents(path: Path) -> dict[str, object]:
    """All that a file holds, in its order, but for the time in its history."""
    with netCDF4.Dataset(path) as file:
        return {
            "model": file.data_model,
            "history": file.history.partition("UTC: ")[2],
            "attributes": [(name, file.getncattr(name)) for name in file.ncattrs() if name != "history"],
            "dimensions": [(name, len(each), each.isunlimited()) for name, each in file.dimensions.items()],
            "variables": [
                (name, each.dtype.str, each.dimensions, [(key, each.getncattr(key)) for key in each.ncattrs()])
                for name, each in file.variables.items()
            ],
            "values": [each[:].tobytes() for each in file.variables.values()],
        }

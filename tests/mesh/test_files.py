"""Files written through links, names of any bytes, and threads that read at once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mesh import VoronoiMesh, read_mesh, write_mesh
from mesh.files.io import mesh_hash
from mesh.safe_files import dataset, definitions, written_aside

READERS = """
import sys
from concurrent.futures import ThreadPoolExecutor
from mesh import read_mesh
from mesh.files.io import mesh_hash
with ThreadPoolExecutor(8) as pool:
    print(len(set(pool.map(lambda _: mesh_hash(read_mesh(sys.argv[1])), range(60)))), mesh_hash(read_mesh(sys.argv[1])))
"""


def test_threads_read_at_once(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    command = [sys.executable, "-c", READERS, str(tmp_path / "mesh.nc")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout.split()) == (0, ["1", mesh_hash(icosahedral_mesh)]), done.stderr


def test_a_name_that_is_no_text(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"mesh_\xff_\xc3\xa9.nc")
    write_mesh(icosahedral_mesh, path)
    assert os.listdir(os.fsencode(tmp_path)) == [b"mesh_\xff_\xc3\xa9.nc"]
    assert mesh_hash(read_mesh(path)) == mesh_hash(icosahedral_mesh)


@pytest.mark.parametrize("exists", [True, False])
def test_links_are_written_through(tmp_path: Path, exists: bool) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "target", tmp_path / "link"
    link.symlink_to(Path("folder") / "target")
    if exists:
        target.write_text("old")
        target.chmod(0o640)
    with written_aside(link) as aside:
        aside.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert [path.name for path in (tmp_path / "folder").iterdir()] == ["target"]
    if exists:
        assert target.stat().st_mode & 0o777 == 0o640


def test_what_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(OSError, match="Too many levels of symbolic links"), written_aside(tmp_path / "a"):
        pass
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FileExistsError, match="something that is no file"), written_aside(tmp_path / "pipe"):
        pass


@pytest.mark.parametrize("file_format", ["NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4"])
def test_definitions_are_made_together(tmp_path: Path, file_format: str) -> None:
    """A classic file leaves the mode of definitions, and writes its header, once and not for each of them."""
    path = tmp_path / "file.nc"
    with dataset(path, "w", format=file_format) as file:
        with definitions(file):
            size = path.stat().st_size
            file.createDimension("n", 3)
            for name in ("a", "b"):
                file.createVariable(name, "f8", ("n",)).setncatts({"units": "m"})
            if file_format != "NETCDF4":
                assert path.stat().st_size == size
        file["b"][:] = [1.0, 2.0, 3.0]
        file.title = "defined later"
    with dataset(path) as file:
        assert file.title == "defined later"
        assert [file[name].units for name in ("a", "b")] == ["m", "m"]
        assert file["b"][:].tolist() == [1.0, 2.0, 3.0]

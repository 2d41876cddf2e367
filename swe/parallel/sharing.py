"""A mesh shared among the processes of a run, each of which reads its part of it from a file."""

import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from mpi4py import MPI

from mesh.errors import MeshError
from mesh.files.io import mesh_hash, whole_arrays, write_arrays
from mesh.files.part_of_file import read_blocks_along_curve, read_part, scaled_hash_of_file
from mesh.files.whole_mesh import MeshInFile, mesh_in_file
from mesh.safe_files import remove_leftovers
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.parallel.agreement import on_first, together
from swe.parallel.mpi import MpiProcesses

FEWEST_CELLS = 8
"""Cells that every process must have; a run pays off with some thousands."""


def share_mesh(file: Path, radius: float, rings: int, communicator: MPI.Intracomm = MPI.COMM_WORLD) -> MpiProcesses:
    """Processes of a run on the mesh of a `file`, on a sphere of `radius` metres; each holds a part, `processes.part`.

    A part is a run of cells along a space-filling curve, all of about the same size, with so many `rings` of cells
    round it (`swe.run.composition.rings_needed`). The file must be one that trisk has validated before it wrote it
    (`mesh.files.stamp`), as no process sees all of it: `MeshError` is raised if it is not, and `InputError` if it has
    too few cells for so many processes.
    """
    whole = on_first(communicator, lambda: _checked(file, radius))
    return _shared(whole, rings, communicator)


@contextmanager
def shared_mesh(
    file: Path | None,
    make: Callable[[], VoronoiMesh],
    place: Path,
    radius: float,
    rings: int,
    communicator: MPI.Intracomm = MPI.COMM_WORLD,
) -> Iterator[MpiProcesses]:
    """The same for a mesh of any origin: one that is not in a validated `file` the first process makes as a whole.

    It then stands in a file beside `place`, from which all processes read their parts, until the context is left.
    """
    written: list[Path] = []
    try:
        whole = on_first(communicator, lambda: _known(file, radius) or _made(make, place, radius, written))
        yield _shared(whole, rings, communicator)
    finally:
        for path in written:
            path.unlink(missing_ok=True)


def _checked(file: Path, radius: float) -> MeshInFile:
    whole = _known(file, radius)
    if whole is None:
        raise MeshError(
            f"{file}: not a file that trisk has validated, so that no process can trust its part; read it and write it "
            "anew (mesh.read_mesh, mesh.write_mesh)"
        )
    return whole


def _known(file: Path | None, radius: float) -> MeshInFile | None:
    """The whole mesh of a `file` that trisk has validated; None if it has not."""
    if file is None:
        return None
    scaled_hash = scaled_hash_of_file(file, radius)
    return None if scaled_hash is None else mesh_in_file(file, radius, scaled_hash)


def _made(make: Callable[[], VoronoiMesh], place: Path, radius: float, written: list[Path]) -> MeshInFile:
    """The mesh that `make` makes, in a file beside `place` that joins those `written`."""
    mesh = make()
    folder = next(parent for parent in place.absolute().parents if parent.is_dir())
    remove_leftovers(folder, (place.name,))
    path = folder / f".{place.name}.{uuid.uuid4().hex[:8]}.part"
    written.append(path)
    # It was read or made just now, and no file is known to others before it is.
    write_arrays(mesh, whole_arrays(mesh), path, "", "netcdf4", mesh_hash(mesh), validated=True)
    return mesh_in_file(path, radius, mesh_hash(mesh.scaled(radius)))


def _shared(whole: MeshInFile, rings: int, communicator: MPI.Intracomm) -> MpiProcesses:
    size, rank = communicator.size, communicator.rank
    if whole.n_cells < FEWEST_CELLS * size:
        raise InputError(
            f"{size} processes are too many for a mesh of {whole.n_cells} cells; start {whole.n_cells // FEWEST_CELLS} "
            "at most"
        )
    blocks = on_first(communicator, lambda: read_blocks_along_curve(whole.path, size))
    part = together(communicator, lambda: read_part(whole.path, blocks, rank, rings))
    return MpiProcesses(part, whole, communicator)

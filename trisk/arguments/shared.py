"""The processes that a run is divided among, each with its mesh: one with the whole, or as many as mpiexec started."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mesh import VoronoiMesh
from swe.parallel.processes import ONE_PROCESS, Processes
from trisk.arguments.meshes import MeshSource
from trisk.processes.launch import launch_of


@contextmanager
def processes_with_mesh(
    source: MeshSource, output: Path, radius: float, rings: int
) -> Iterator[tuple[VoronoiMesh, Processes]]:
    """The mesh of `source`, or this process's part of it, and the processes that share it.

    A part has so many `rings` of cells round its own; the run is written to `output`, on a sphere of `radius` metres.
    """
    if launch_of().size == 1:
        yield source.mesh(), ONE_PROCESS
        return
    from swe.parallel.sharing import shared_mesh

    with shared_mesh(source.unchanged_file, source.mesh, output, radius, rings) as processes:
        yield processes.part.mesh, processes

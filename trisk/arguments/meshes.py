"""The mesh that a command runs on, read or generated."""

from dataclasses import dataclass
from pathlib import Path

import typer

from mesh import MeshError, VoronoiMesh, read_mesh
from mesh.generation.pipeline import generate_mesh
from mesh.generation.scvt import limits_of
from mesh.mesh_request import MeshRequest
from swe.output.files import MESH_FILE
from trisk.report.bars import convergence_bar


def chosen_mesh(mesh_file: Path | None, cells: int | None, recompute_metrics: bool, quiet: bool) -> VoronoiMesh:
    """The mesh of `mesh_file`, or a new one of `cells` cells, generated with a progress bar unless `quiet`.

    Raises `typer.BadParameter` if neither is given, or both.
    """
    if mesh_file is not None and cells is None:
        return read_mesh(mesh_file, recompute_metrics)
    if cells is None or mesh_file is not None:
        raise typer.BadParameter("give either --mesh FILE or --cells N")
    if recompute_metrics:
        raise typer.BadParameter("--recompute-metrics goes with --mesh FILE")
    request = MeshRequest(cells)
    with convergence_bar(limits_of(request).tolerance, not quiet) as show:
        return generate_mesh(request, show).mesh


@dataclass(frozen=True)
class MeshSource:
    """Where the mesh of a run comes from, as the options of the command say: a file, or generation.

    A run to be resumed goes on with the mesh in its directory, `of_run`, without being told; that of a directory
    without one comes from the options. `mesh` raises `MeshError` if `cells` is given and that mesh has another number.
    """

    file: Path | None
    cells: int | None
    recompute_metrics: bool
    quiet: bool
    of_run: Path | None = None

    @property
    def unchanged_file(self) -> Path | None:
        """The file whose mesh the run takes as it is, if there is one."""
        if self.of_run is not None:
            return None if self.cells is not None else self.of_run
        return None if self.recompute_metrics or self.cells is not None else self.file

    def mesh(self) -> VoronoiMesh:
        """The mesh, read or generated."""
        if self.of_run is None:
            return chosen_mesh(self.file, self.cells, self.recompute_metrics, self.quiet)
        mesh = read_mesh(self.of_run)
        if self.cells is not None and self.cells != mesh.n_cells:
            raise MeshError(
                f"{self.of_run} has {mesh.n_cells} cells, not {self.cells}; give the same options, or another directory"
            )
        return mesh


def mesh_file_of_run(directory: Path) -> Path | None:
    """The mesh file of the run in the directory; None if there is none."""
    path = directory / MESH_FILE
    return path if path.is_file() else None

"""The mesh that a command runs on, read or generated."""

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


def mesh_of_run(directory: Path, cells: int | None) -> VoronoiMesh | None:
    """The mesh of the run in the directory, None if there is none; a run continues on it without being told.

    Raises `MeshError` if `cells` is given and the mesh has another number of cells.
    """
    path = directory / MESH_FILE
    if not path.is_file():
        return None
    mesh = read_mesh(path)
    if cells is not None and cells != mesh.n_cells:
        raise MeshError(f"{path} has {mesh.n_cells} cells, not {cells}; give the same options, or another directory")
    return mesh

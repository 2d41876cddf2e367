"""`trisk mesh`: from options to a mesh file, with progress and checkpoints."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import typer

from mesh import MeshError, VoronoiMesh, read_mesh, write_mesh
from mesh.density.gridded import Shaping, find_density
from mesh.density.named import Density
from mesh.files.io import require_format
from mesh.generation.checkpoint import CheckpointKeeper, checkpoint_path, load_checkpoint
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Callback, Iterate, Limits, ScvtResult
from mesh.generation.pipeline import mesh_of
from mesh.generation.scvt import Request, check_converged, generate_scvt, optimize
from mesh.generation.well_centered import GOAL, well_center
from mesh.geometry.sphere import normalize
from trisk.arguments.outputs import require_possible_file
from trisk.report.bars import convergence_bar


@dataclass(frozen=True)
class MeshOptions:
    """What the user typed, by the names of the options."""

    cells: int | None
    density: str
    density_variable: str
    shaping: Shaping
    start: str | None
    seed: int
    method: str
    nested: Path | None
    well_centered: bool
    limits: Limits
    resume: bool
    quiet: bool

    @property
    def description(self) -> dict[str, object]:
        """What determines the generation, for its checkpoint."""
        return {
            "cells": self.cells,
            "density": self.density,
            "density variable": self.density_variable,
            **{f"density {name}": value for name, value in asdict(self.shaping).items()},
            "start": self.start,
            "seed": self.seed,
            "method": self.method,
        }


def generate(options: MeshOptions, output: Path, history: str, file_format: str) -> VoronoiMesh:
    """Write the mesh that the options ask for; a generation that fails or is interrupted leaves a checkpoint."""
    require_format(file_format)
    require_possible_file(output)
    if options.nested is not None and (options.start, options.method, options.resume) != (None, "lbfgs", False):
        raise MeshError("--start, --method and --resume do not go with --nested, which starts from that mesh")
    begin = time.perf_counter()
    density = find_density(options.density, options.density_variable, options.shaping)
    with _progress(options, output) as callback:
        limits = options.limits.since(begin)
        if options.nested is None:
            result = _from_start(options, density, limits, output, callback)
        else:
            result = _nested(options.nested, options, density, limits, callback)
        if options.well_centered:
            result = _well_centered(result, density, options.limits.since(begin).seconds, options.quiet)
        mesh = mesh_of(result, density)
        write_mesh(mesh, output, history, file_format)
    return mesh


def _well_centered(result: ScvtResult, density: Density, seconds: float, quiet: bool) -> ScvtResult:
    """The result with triangles without obtuse angles; tells the residual that they cost."""
    begin = time.perf_counter()
    better = well_center(result.points, result.triangles, density, result.fixed, seconds=seconds)
    if better.least_quality < GOAL:
        in_time = time.perf_counter() - begin < seconds
        advice = "try another start or seed, or converge it further" if in_time else "allow more time"
        raise MeshError(
            f"the mesh of {len(better.points)} cells keeps a triangle of quality {better.least_quality:.3f}, below "
            f"{GOAL}; {advice}"
        )
    if not quiet:
        typer.echo(
            f"well-centred: the least triangle quality is {better.least_quality:.3f}, and the residual rose from "
            f"{better.residual_before:.1e} to {better.residual:.1e} mean spacings"
        )
    return replace(result, points=better.points, triangles=better.triangles)


def _from_start(options: MeshOptions, density: Density, limits: Limits, output: Path, callback: Callback) -> ScvtResult:
    if options.cells is None:
        raise MeshError("the number of cells is missing; give --cells N")
    request = Request(options.cells, options.start, options.method, density, options.seed)
    if not options.resume:
        return generate_scvt(request, limits, callback)
    points = load_checkpoint(checkpoint_path(output), options.description)
    result = optimize(points, None, options.method, density, limits, callback, options.seed)
    check_converged(result, limits)
    return result


def _nested(
    coarse_file: Path, options: MeshOptions, density: Density, limits: Limits, callback: Callback
) -> ScvtResult:
    coarse = read_mesh(coarse_file, recompute_metrics=True)  # as generators and triangles alone serve
    points, triangles = normalize(coarse.cell_points), coarse.cells_on_vertex
    return nested_scvt(points, triangles, density, options.cells, limits, callback, options.seed)


@contextmanager
def _progress(options: MeshOptions, output: Path) -> Iterator[Callback]:
    """Give a callback that draws the bar and keeps the checkpoint, which is removed when all went well."""
    keeper = CheckpointKeeper(checkpoint_path(output), options.description)
    with convergence_bar(options.limits.tolerance, not options.quiet) as show:

        def both(iterate: Iterate) -> None:
            show(iterate)
            if options.nested is None:
                keeper(iterate)

        try:
            yield both
        except BaseException:
            if keeper.save():
                typer.echo(f"the best points are kept in {checkpoint_path(output)}; go on with --resume", err=True)
            raise
    keeper.remove()

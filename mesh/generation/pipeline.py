"""From the description of a mesh to the mesh, for `scvt_mesh` and the command line alike."""

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mesh.arrays import Array
from mesh.density.named import Density
from mesh.density.record import name_of, source_of
from mesh.discrete.build import mesh_from_points
from mesh.discrete.walls import has_walls
from mesh.errors import MeshError
from mesh.generation.checkpoint import CheckpointKeeper
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Callback, Iterate, Limits, ScvtResult
from mesh.generation.scvt import cells_of, check_converged, converge, density_of, limits_of, optimize
from mesh.generation.well_centered import GOAL, WellCentered, well_center
from mesh.geometry.sphere import normalize
from mesh.mesh_request import MeshRequest
from mesh.plain import plain_count, plain_number
from mesh.validated import remember_validated
from mesh.voronoi_mesh import VoronoiMesh


@dataclass(frozen=True)
class GeneratedMesh:
    """A validated mesh on the unit sphere and, if it was made well-centred, what that cost."""

    mesh: VoronoiMesh
    centring: WellCentered | None = None


def scvt_mesh(
    cells: int | None = MeshRequest.cells,
    density: str | os.PathLike[str] | Density = MeshRequest.density,
    start: str | None = MeshRequest.start,
    method: str = MeshRequest.method,
    tolerance: float | None = MeshRequest.tolerance,
    max_iterations: int = MeshRequest.max_iterations,
    seed: int = MeshRequest.seed,
    callback: Callback | None = None,
    *,
    nested: VoronoiMesh | None = MeshRequest.nested,
    well_centered: bool = MeshRequest.well_centered,
    max_seconds: float = MeshRequest.max_seconds,
    density_variable: str = MeshRequest.density_variable,
    density_floor: float = MeshRequest.density_floor,
    density_power: float = MeshRequest.density_power,
    density_smoothing: int = MeshRequest.density_smoothing,
    checkpoint: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> VoronoiMesh:
    """A validated SCVT on the unit sphere; `mesh.mesh_request.MeshRequest` explains the arguments.

    `callback` is called with each iterate. `checkpoint` names a file that keeps the best points if the generation
    fails or is interrupted; with `resume`, the same call continues from there. Raises `MeshError` if no such mesh can
    be made.
    """
    if not isinstance(nested, VoronoiMesh | None):
        raise MeshError(f"the mesh to refine is {nested!r}; it must be a VoronoiMesh, such as read_mesh gives")
    request = MeshRequest(
        cells=None if cells is None and nested is not None else plain_count("the number of cells", cells),
        density=density,
        start=start,
        method=method,
        tolerance=None if tolerance is None else plain_number("the tolerance", tolerance),
        max_iterations=plain_count("the largest number of iterations", max_iterations),
        seed=plain_count("the seed", seed),
        nested=nested,
        well_centered=well_centered,
        max_seconds=plain_number("the time allowed", max_seconds),
        density_variable=density_variable,
        density_floor=plain_number("the floor of the density", density_floor),
        density_power=plain_number("the power of the density", density_power),
        density_smoothing=plain_count("the number of passes of smoothing", density_smoothing),
    )
    if checkpoint is None:
        if resume:
            raise MeshError("there is no checkpoint to resume from; name its file with checkpoint")
        return generate_mesh(request, callback).mesh
    with CheckpointKeeper(Path(checkpoint), request) as keeper:
        return generate_mesh(request, callback, keeper, resume).mesh


def generate_mesh(
    request: MeshRequest,
    callback: Callback | None = None,
    keeper: CheckpointKeeper | None = None,
    resume: bool = False,
) -> GeneratedMesh:
    """Make the requested mesh; the `keeper` sees each iterate, and with `resume` its points are the start.

    A nested mesh keeps no checkpoint. Raises `MeshError` if the request cannot be met.
    """
    begin = time.perf_counter()
    if request.nested is None:
        cells_of(request)
    else:
        _require_one_start(request, resume)
    density = density_of(request)
    limits = limits_of(request)
    if request.nested is not None:
        result = _refined(request.nested, request, density, limits.since(begin), callback)
    else:
        watching = [each for each in (callback, keeper) if each is not None]
        start = keeper.load() if keeper is not None and resume else None
        result = _from_start(start, request, density, limits.since(begin), _all_of(watching))
    centring = None
    if request.well_centered:
        centring = _well_centered(result, density, limits.since(begin).seconds)
        result = replace(result, points=centring.points, triangles=centring.triangles)
    return GeneratedMesh(mesh_of(result, density), centring)


def mesh_of(result: ScvtResult, density: Density) -> VoronoiMesh:
    """The validated mesh, on the unit sphere, of generators optimised for `density`, which it records."""
    mesh = mesh_from_points(result.points, result.triangles, density, name_of(density))
    mesh = replace(mesh, density_source=source_of(density), fixed_cells=result.fixed)
    remember_validated(mesh)
    return mesh


def _require_one_start(request: MeshRequest, resume: bool) -> None:
    if (request.start, request.method, resume) != (MeshRequest.start, MeshRequest.method, False):
        raise MeshError("--start, --method and --resume do not go with --nested, which starts from that mesh")


def _from_start(
    points: Array | None, request: MeshRequest, density: Density, limits: Limits, callback: Callback
) -> ScvtResult:
    """Converged generators, starting from `points` (n, 3) of a checkpoint if given."""
    if points is None:
        return converge(request, density, limits, callback)
    result = optimize(points, None, request.method, density, limits, callback, request.seed)
    check_converged(result, limits)
    return result


def _refined(
    coarse: VoronoiMesh, request: MeshRequest, density: Density, limits: Limits, callback: Callback | None
) -> ScvtResult:
    coarse.require_sphere("meshes are refined")
    if has_walls(coarse):
        raise MeshError("the mesh to refine has walls; give one of the whole sphere, and cull what comes of it")
    points, triangles = normalize(coarse.cell_points), coarse.cells_on_vertex
    return nested_scvt(points, triangles, density, request.cells, limits, callback, request.seed)


def _well_centered(result: ScvtResult, density: Density, seconds: float) -> WellCentered:
    """The result without obtuse triangles; raise `MeshError` if the goal is missed, as it may be within `seconds`."""
    begin = time.perf_counter()
    better = well_center(result.points, result.triangles, density, result.fixed, seconds=seconds)
    if better.least_quality < GOAL:
        in_time = time.perf_counter() - begin < seconds
        advice = "try another start or seed, or converge it further" if in_time else "allow more time"
        raise MeshError(
            f"the mesh of {len(better.points)} cells keeps a triangle of quality {better.least_quality:.3f}, below "
            f"{GOAL}; {advice}"
        )
    return better


def _all_of(callbacks: Sequence[Callback]) -> Callback:
    """A callback that calls `callbacks` in turn."""

    def call(iterate: Iterate) -> None:
        for each in callbacks:
            each(iterate)

    return call

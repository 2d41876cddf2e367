"""`trisk mesh`: generate a mesh."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from runpy import run_path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trisk.cli.options import FileFormat, Quiet

if TYPE_CHECKING:
    from mesh.generation.checkpoint import CheckpointKeeper
    from mesh.generation.optimizer import Callback
    from mesh.mesh_request import MeshRequest
    from mesh.voronoi_mesh import VoronoiMesh

COAST_FACTOR = 16.0
"""By how much the density is raised at the coast where a width alone is given."""


def _defaults() -> Any:
    """The class that describes a mesh, for the defaults of its fields.

    Its module runs on its own: importing it would import the whole package and make every help text slow.
    """
    package = find_spec("mesh")
    assert package is not None
    assert package.origin is not None
    return run_path(str(Path(package.origin).with_name("mesh_request.py")))["MeshRequest"]


DEFAULTS = _defaults()


def mesh(
    output: Annotated[Path, typer.Option("--output", "-o", help="MPAS mesh file to write.")],
    cells: Annotated[
        int | None, typer.Option("--cells", help="Number of cells; 10*4^k+2 gives an icosahedral mesh.")
    ] = None,
    coast: Annotated[
        str | None,
        typer.Option(
            "--coast",
            metavar="REGION",
            help="Fill the sea of this region with cells that its coast clips: north-atlantic, world-ocean, a box "
            "WEST,EAST,SOUTH,NORTH in degrees, polygons FILE.geojson, or a mask or signed distance FILE.nc:VARIABLE; "
            "on a plane with --periodic none fill a polygon FILE.geojson, in metres, up to its walls.",
        ),
    ] = None,
    density: Annotated[
        str,
        typer.Option(
            "--density",
            help="uniform, refined-circle, refined-box, smooth-transition, or a NetCDF file FILE.nc; "
            "on a plane the first two, or a file with x and y.",
        ),
    ] = DEFAULTS.density,
    density_variable: Annotated[
        str, typer.Option("--density-variable", help="Variable of FILE.nc that holds the density.")
    ] = DEFAULTS.density_variable,
    density_floor: Annotated[
        float, typer.Option("--density-floor", help="Raise smaller values of the field to this.")
    ] = DEFAULTS.density_floor,
    density_power: Annotated[
        float, typer.Option("--density-power", help="Power of the field that gives the density; -4 for cell widths.")
    ] = DEFAULTS.density_power,
    density_smoothing: Annotated[
        int, typer.Option("--density-smoothing", help="Smoothing passes over the field, before the power.")
    ] = DEFAULTS.density_smoothing,
    coast_width: Annotated[
        float | None,
        typer.Option("--coast-width", help="Raise the density towards the coast over this width, in km on the Earth."),
    ] = None,
    coast_factor: Annotated[
        float | None,
        typer.Option(
            "--coast-factor", help="How many times --coast-width raises the density at the coast; by default 16."
        ),
    ] = None,
    plane: Annotated[
        str | None,
        typer.Option(
            "--plane",
            metavar="LX,LY",
            help="Make a mesh on a plane of these lengths, m, in place of the sphere.",
        ),
    ] = None,
    periodic: Annotated[
        str, typer.Option("--periodic", help="Where the plane repeats itself: xy, x (a channel) or none (a box).")
    ] = DEFAULTS.periodic,
    hexagons: Annotated[
        str | None,
        typer.Option(
            "--hexagons",
            metavar="NX,NY",
            help="Regular hexagons of the plane: NY rows of NX; LY must be sqrt(3)/2 NY LX/NX.",
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            "--start",
            help="icosahedral, fibonacci, random or random-root; by default the first, or the "
            "second where the first has no such mesh, and under a density from coarse meshes; with a coast the second, "
            "or under a density points dealt out as it asks; on a plane rows, random or random-root.",
        ),
    ] = DEFAULTS.start,
    seed: Annotated[int, typer.Option("--seed", help="Random seed.", min=0)] = DEFAULTS.seed,
    method: Annotated[
        str, typer.Option("--method", help="lbfgs, lloyd, multilevel, probabilistic or macqueen.")
    ] = DEFAULTS.method,
    nested: Annotated[
        Path | None, typer.Option("--nested", help="Refine this mesh where the density asks for it and keep the rest.")
    ] = None,
    well_centered: Annotated[
        bool,
        typer.Option("--well-centred", help="Trade a little centroidality for a mesh without obtuse triangles."),
    ] = DEFAULTS.well_centered,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance",
            help="Largest distance from generator to centroid, in mean spacings; by default 1e-8, 1e-6 under a "
            "density or with a coast, and more for methods that sample: 0.02 and 0.2 (probabilistic), 0.1 and 0.5 "
            "(macqueen).",
        ),
    ] = DEFAULTS.tolerance,
    max_iterations: Annotated[
        int, typer.Option("--max-iterations", help="Give up after this many iterations.", min=1)
    ] = DEFAULTS.max_iterations,
    max_seconds: Annotated[float, typer.Option("--max-seconds", help="Give up after this many seconds in total.")] = (
        DEFAULTS.max_seconds
    ),
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue from the checkpoint of an interrupted call.")
    ] = False,
    file_format: FileFormat = "netcdf4",
    quiet: Quiet = False,
) -> None:
    """Generate a centroidal Voronoi mesh of the sphere or of a plane, or regular hexagons of a plane."""
    from mesh import MeshError, mesh_on_plane, read_mesh, write_mesh
    from mesh.files.io import least_sizes, require_format
    from mesh.generation.pipeline import generate_mesh
    from mesh.generation.scvt import limits_of
    from mesh.mesh_request import MeshRequest
    from mesh.plane.generation import is_on_plane, require_possible_on_plane
    from postprocess.runs.folders import require_possible_file
    from trisk.arguments.outputs import command_line
    from trisk.arguments.pairs import counts_of, pair_of
    from trisk.report.bars import convergence_bar
    from trisk.report.summaries import print_quality, tell_of_centring

    request = MeshRequest(
        cells=cells,
        density=density,
        start=start,
        method=method,
        tolerance=tolerance,
        max_iterations=max_iterations,
        seed=seed,
        well_centered=well_centered,
        max_seconds=max_seconds,
        density_variable=density_variable,
        density_floor=density_floor,
        density_power=density_power,
        density_smoothing=density_smoothing,
        plane=None if plane is None else pair_of("--plane", plane),
        periodic=periodic,
        hexagons=None if hexagons is None else counts_of("--hexagons", hexagons),
    )
    limits = limits_of(request)
    require_format(file_format, None if cells is None else least_sizes(cells))
    require_possible_file(output)
    if is_on_plane(request):
        _require_no(
            {"--resume": resume, "--nested": nested, "--coast-width": coast_width, "--coast-factor": coast_factor}
        )
        make = mesh_on_plane if coast is None else _in_polygon(coast, request)
        require_possible_on_plane(request)
        with convergence_bar(limits.tolerance, not quiet and hexagons is None) as show:
            on_plane = make(request, show)
        write_mesh(on_plane, output, command_line(), file_format)
        if not quiet:
            print_quality(on_plane, str(output))
        return
    if coast is not None:
        if resume or nested is not None:
            raise MeshError("--resume and --nested do not go with --coast; leave them out")
        made_at_sea = _with_coast(coast, request, _raised(coast_width, coast_factor), quiet)
        write_mesh(made_at_sea, output, command_line(), file_format)
        if not quiet:
            print_quality(made_at_sea, str(output))
        return
    for option, given in (("--coast-width", coast_width), ("--coast-factor", coast_factor)):
        if given is not None:
            raise MeshError(f"{option} goes with --coast alone; name a region, or leave it out")
    if nested is not None:
        # Generators and triangles serve, whatever else the file holds.
        request = replace(request, nested=read_mesh(nested, recompute_metrics=True))
    with _progress(request, output, limits.tolerance, quiet) as (show, keeper):
        made = generate_mesh(request, show, keeper, resume)
        if made.centring is not None and not quiet:
            tell_of_centring(made.centring)
        write_mesh(made.mesh, output, command_line(), file_format)
    if not quiet:
        print_quality(made.mesh, str(output))


def _require_no(options: dict[str, object]) -> None:
    """Raise `MeshError` if one of the options, by name, is given, as meshes on planes have none of them."""
    from mesh import MeshError

    for option, given in options.items():
        if given is not None and given is not False:
            raise MeshError(f"{option} does not go with --plane; leave it out")


def _raised(width: float | None, factor: float | None) -> tuple[float, float] | None:
    """Width, km, and factor by which the density rises towards the coast; raise `MeshError` where there is no such."""
    from mesh import MeshError

    if width is None:
        if factor is not None:
            raise MeshError(f"--coast-factor is {factor:g}, but over no width; give --coast-width too, or leave it out")
        return None
    if not 0.0 < width < math.inf:
        raise MeshError(f"--coast-width is {width:g}; give a positive number of km")
    return width, COAST_FACTOR if factor is None else factor


def _with_coast(coast: str, request: "MeshRequest", raised: tuple[float, float] | None, quiet: bool) -> "VoronoiMesh":
    """The mesh of the cells that the coast of a region clips, with its density `raised` over a width, km, by a factor.

    It keeps no checkpoint.
    """
    from mesh import find_region, region_mesh
    from mesh.coast.generation import Shore, coast_limits
    from swe.constants import EARTH_RADIUS
    from trisk.report.bars import convergence_bar

    shore = None if raised is None else Shore(raised[0] * 1000.0 / EARTH_RADIUS, raised[1])
    with convergence_bar(coast_limits(request).tolerance, not quiet) as show:
        return region_mesh(find_region(coast), request, show, shore)


def _in_polygon(coast: str, request: "MeshRequest") -> "Callable[[MeshRequest, Callback], VoronoiMesh]":
    """What makes the mesh of the polygon in a file; raise `MeshError` where that or the request does not fit."""
    from mesh import MeshError, polygon_mesh
    from mesh.polygon.generation import require_possible_in_polygon
    from mesh.polygon.rings import checked_rings, read_rings
    from mesh.regions.find import GEOJSON

    plane = require_possible_in_polygon(request)
    if not coast.endswith(GEOJSON):
        raise MeshError(f"--coast is {coast}; on a plane give a polygon in metres, FILE.geojson")
    name = f"the polygon of {coast}"
    rings = checked_rings(read_rings(Path(coast)), plane, name)
    return lambda request, show: polygon_mesh(rings, request, show, name)


@contextmanager
def _progress(
    request: "MeshRequest", output: Path, tolerance: float, quiet: bool
) -> "Iterator[tuple[Callback, CheckpointKeeper]]":
    """Show a bar and keep a checkpoint, which stays only if the work fails or is interrupted."""
    from mesh.generation.checkpoint import CheckpointKeeper, checkpoint_path
    from trisk.report.bars import convergence_bar

    path = checkpoint_path(output)
    keeper = CheckpointKeeper(path, request)
    with convergence_bar(tolerance, not quiet) as show:
        try:
            with keeper:
                yield show, keeper
        except BaseException:
            if keeper.has_points:
                typer.echo(f"the best points are kept in {path}; go on with --resume", err=True)
            raise

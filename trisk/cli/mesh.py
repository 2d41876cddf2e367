"""`trisk mesh`: generate a mesh."""

from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Quiet


def mesh(
    output: Annotated[Path, typer.Option("--output", "-o", help="MPAS mesh file to write.")],
    cells: Annotated[
        int | None, typer.Option("--cells", help="Number of cells; 10*4^k+2 gives an icosahedral mesh.")
    ] = None,
    density: Annotated[
        str,
        typer.Option(
            "--density", help="uniform, refined-circle, refined-box, smooth-transition, or a NetCDF file FILE.nc."
        ),
    ] = "uniform",
    density_variable: Annotated[
        str, typer.Option("--density-variable", help="Variable of FILE.nc that holds the density.")
    ] = "density",
    density_floor: Annotated[float, typer.Option("--density-floor", help="Raise smaller values of the field.")] = 0.0,
    density_power: Annotated[
        float, typer.Option("--density-power", help="Power of the field that is the density; -4 for cell widths.")
    ] = 1.0,
    density_smoothing: Annotated[
        int, typer.Option("--density-smoothing", help="Passes of smoothing of the field, before the power.")
    ] = 0,
    start: Annotated[
        str | None,
        typer.Option("--start", help="icosahedral, fibonacci, random or random-root; the first where it exists."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Seed of all that is random.", min=0)] = 0,
    method: Annotated[
        str, typer.Option("--method", help="lbfgs, lloyd, multilevel, probabilistic or macqueen.")
    ] = "lbfgs",
    nested: Annotated[
        Path | None, typer.Option("--nested", help="Refine this mesh where the density asks for it, keep the rest.")
    ] = None,
    well_centered: Annotated[
        bool,
        typer.Option("--well-centred", help="Trade a little centroidality for a mesh without obtuse triangles."),
    ] = False,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance",
            help="Largest distance to centroids, in mean spacings; 1e-8, or 1e-6 under a density, and more for methods "
            "that sample: 0.02 and 0.2 (probabilistic), 0.1 and 0.5 (macqueen).",
        ),
    ] = None,
    max_iterations: Annotated[int, typer.Option("--max-iterations", help="Give up after so many.", min=1)] = 10_000,
    max_seconds: Annotated[float, typer.Option("--max-seconds", help="Give up after so long, all in all.")] = float(
        "inf"
    ),
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint of an interrupted call.")] = False,
    file_format: Annotated[
        str,
        typer.Option("--format", help="netcdf4, or for programs without HDF5: cdf5, or classic, with 64-bit offsets."),
    ] = "netcdf4",
    quiet: Quiet = False,
) -> None:
    """Generate a spherical centroidal Voronoi mesh."""
    from mesh.density.gridded import Shaping
    from mesh.generation.pipeline import default_limits
    from trisk.arguments.generate import MeshOptions, generate
    from trisk.arguments.outputs import command_line
    from trisk.report.summaries import print_quality

    limits = default_limits(density, method, tolerance, max_iterations, max_seconds)
    shaping = Shaping(density_floor, density_power, density_smoothing)
    options = MeshOptions(
        cells, density, density_variable, shaping, start, seed, method, nested, well_centered, limits, resume, quiet
    )
    result = generate(options, output, command_line(), file_format)
    if not quiet:
        print_quality(result, str(output))

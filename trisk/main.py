"""The `trisk` command; packages are imported when a command needs them, so that help is quick."""

import errno
import io
import json
import math
import os
import shlex
import signal
import sys
import warnings
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal, TextIO, cast

import typer

from trisk.cli import study
from trisk.cli.options import CaseName, Quiet, Recompute, Settings
from trisk.cli.streams import ErrorOutput

app = typer.Typer(
    help="Spherical centroidal Voronoi meshes and an energy-conserving shallow-water model on them.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

app.add_typer(study.app, name="study")

ERRORS_OF_PATHS = (
    *(errno.ENOENT, errno.EACCES, errno.EPERM, errno.EEXIST, errno.ENOTDIR, errno.EISDIR),
    *(errno.EINVAL, errno.ENAMETOOLONG, errno.ELOOP, errno.EROFS),
)
"""What the system says of paths that are no use."""

ERRORS_OF_OUTPUT = (errno.ENOSPC, errno.EPIPE, errno.EIO, errno.EFBIG, errno.EDQUOT, errno.EBADF)
"""What the system says, without the name of a file, where the output takes no more."""

NO_THREADING_LAYER = "threading layer could be loaded"
"""What numba says where NUMBA_THREADING_LAYER names one that is not installed."""

RUN_FAILED, BAD_INPUT, STOPPED = 1, 2, 128
"""Exit codes; the last is that of shells, to which the number of the signal is added."""


@app.command()
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
    from trisk.cli.generate import MeshOptions, generate
    from trisk.cli.report import print_quality

    limits = default_limits(density, method, tolerance, max_iterations, max_seconds)
    shaping = Shaping(density_floor, density_power, density_smoothing)
    options = MeshOptions(
        cells, density, density_variable, shaping, start, seed, method, nested, well_centered, limits, resume, quiet
    )
    result = generate(options, output, _command_line(), file_format)
    if not quiet:
        print_quality(result, str(output))


@app.command()
def quality(
    file: Annotated[Path | None, typer.Argument(help="MPAS mesh file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    recompute_metrics: Recompute = False,
    table1: Annotated[
        bool, typer.Option("--table1", help="Make Table 1 of Ju, Ringler and Gunzburger (2011) anew instead.")
    ] = False,
    max_level: Annotated[int, typer.Option("--max-level", help="Last level of the table, up to 9.")] = 6,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write a page with the table and figures to this folder.")
    ] = None,
) -> None:
    """Validate a mesh file and measure its quality."""
    from dataclasses import asdict

    from trisk.cli.report import print_quality, print_table1

    if (file is None) != table1:
        raise typer.BadParameter("give either a mesh file or --table1")
    if table1 and (as_json or recompute_metrics):
        raise typer.BadParameter("--json and --recompute-metrics go with a mesh file")
    if output is not None and not table1:
        raise typer.BadParameter("--output goes with --table1")
    if file is None:
        if output is not None:
            from postprocess.runs.folders import require_possible_folder

            require_possible_folder(output)
        print_table1(max_level, output)
        return
    from mesh import read_mesh
    from mesh.discrete.quality import quality_and_note

    read = read_mesh(file, recompute_metrics)
    if as_json:
        found, note = quality_and_note(read)
        measured = asdict(found)
        if not math.isfinite(measured["residual"]):
            measured["residual"] = None
        typer.echo(json.dumps({**measured, "residual_note": note}))
    else:
        print_quality(read, str(file))


@app.command()
def run(
    case: CaseName,
    output: Annotated[Path, typer.Option("--output", "-o", help="Run directory to create.")],
    mesh_file: Annotated[Path | None, typer.Option("--mesh", help="MPAS mesh file.")] = None,
    cells: Annotated[int | None, typer.Option("--cells", help="Generate a mesh of so many cells instead.")] = None,
    settings: Settings = None,
    means: Annotated[
        bool, typer.Option("--cell-means", help="Start from means over the cells instead of values at their centres.")
    ] = False,
    days: Annotated[
        float | None,
        typer.Option(
            "--days", help="Simulated days since the start; by default those that the paper recommends, or of the run."
        ),
    ] = None,
    time_step: Annotated[
        float | None, typer.Option("--dt", help="Time step in seconds; by default from the mesh and the wave speed.")
    ] = None,
    snapshot_hours: Annotated[float, typer.Option("--snapshot-hours", help="Hours between snapshots.")] = 24.0,
    diagnostics_hours: Annotated[float, typer.Option("--diagnostics-hours", help="Hours between diagnostics.")] = 6.0,
    checkpoint_hours: Annotated[
        float, typer.Option("--checkpoint-hours", help="Simulated hours between checkpoints.")
    ] = 24.0,
    integrator: Annotated[
        Literal["rk4", "rrk4"],
        typer.Option("--integrator", help="rk4, or rrk4, which scales its steps to keep total energy to round-off."),
    ] = "rk4",
    anticipation: Annotated[
        float,
        typer.Option(
            "--apvm", help="Part of a step by which potential vorticity is anticipated (APVM), 0.5 in the literature."
        ),
    ] = 0.0,
    dissipation: Annotated[
        float, typer.Option("--dissipation", help="Coefficient of biharmonic dissipation, m4/s.")
    ] = 0.0,
    force: Annotated[bool, typer.Option("--force", help="Replace a run that the directory holds.")] = False,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", help="Go on with the run in the directory, on its mesh; a finished one to a later --days."
        ),
    ] = False,
    recompute_metrics: Recompute = False,
    quiet: Quiet = False,
) -> None:
    """Run a test case and write snapshots and diagnostics.

    Ctrl-C and SIGTERM stop it with a checkpoint.
    """
    from cases import find_case
    from cases.parameters import split_settings
    from swe import Simulation
    from swe.configuration import Options
    from swe.errors import InputError
    from swe.output.recorder import days_of, run_to_go_on_with
    from trisk.cli.meshes import chosen_mesh, mesh_of_run
    from trisk.cli.report import print_run

    chosen = find_case(case, split_settings(settings or ()))
    options: dict[str, Any] = {
        "time_step": time_step,
        "snapshot_interval": 3600.0 * snapshot_hours,
        "diagnostics_interval": 3600.0 * diagnostics_hours,
        "checkpoint_interval": 3600.0 * checkpoint_hours,
        "sampling": "mean" if means else "point",
        "integrator": integrator,
        "anticipation": anticipation,
        "dissipation": dissipation,
    }
    # What can be refused is so before a mesh is made for nothing.
    Options(**options).require_suitable(chosen.name, chosen.prescribed_wind)
    before = run_to_go_on_with(output, force, resume)
    if days is None:
        days = chosen.recommended_days if before is None else days_of(before, output)
    if not 0.0 < days < float("inf"):
        raise InputError(f"the run is to last {days:g} days; give a number above 0")
    if resume and recompute_metrics and mesh_file is None:
        raise typer.BadParameter("--recompute-metrics goes with --mesh FILE")
    known = mesh_of_run(output, cells) if resume and mesh_file is None else None
    simulation = Simulation(
        known or chosen_mesh(mesh_file, cells, recompute_metrics, quiet),
        chosen,
        output,
        overwrite=force,
        resume=resume,
        **options,
    )
    simulation.run(until=days, progress=not quiet)
    if not quiet:
        print_run(output)


@app.command()
def cases(
    name: Annotated[
        str | None, typer.Argument(help="Name of a test case, or FILE.py:CLASS, to see its parameters.")
    ] = None,
) -> None:
    """List the test cases, or the parameters of one."""
    from cases import CASES, find_case
    from trisk.cli.case_table import print_case, print_cases

    if name is None:
        print_cases([find_case(known) for known in CASES])
    else:
        print_case(find_case(name))


@app.command()
def plot(
    run_directory: Annotated[Path, typer.Argument(help="Directory that a run wrote.")],
    quiet: Quiet = False,
) -> None:
    """Draw maps, the mesh and conservation of a run.

    The figures go to the folder of figures of the run.
    """
    from postprocess.figures.plots import plot_run
    from postprocess.runs.reading import read_run
    from swe.output.files import FIGURES_FOLDER

    paths = plot_run(read_run(run_directory), run_directory / FIGURES_FOLDER)
    if not quiet:
        for path in paths:
            typer.echo(path)


@app.command()
def spectra(
    run_directories: Annotated[list[Path], typer.Argument(help="Directories of runs.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the table and the figure.")],
    days: Annotated[
        list[float] | None, typer.Option("--day", help="Day of a snapshot, repeatable; by default the last.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Write and draw spectra of energy and potential enstrophy.

    Energy is that of the motion, and the wavenumber the total one.
    """
    from postprocess.figures.spectra_figure import write_spectra_of
    from postprocess.runs.reading import read_run

    paths = write_spectra_of([read_run(directory) for directory in run_directories], days or (), output)
    if not quiet:
        for path in paths:
            typer.echo(path)


@app.command()
def reference(
    case: CaseName,
    output: Annotated[Path, typer.Option("--output", "-o", help="File of harmonics to write.")],
    days: Annotated[
        list[float] | None, typer.Option("--day", help="Day to keep, repeatable; by default those of the case.")
    ] = None,
    truncation: Annotated[
        int, typer.Option("--truncation", help="Highest total wavenumber; its half and quarter are run as well.")
    ] = 341,
    damping_hours: Annotated[
        float, typer.Option("--damping-hours", help="Time in which del^8 damps that wavenumber to 1/e; inf for none.")
    ] = 1.0,
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Make a reference solution of a case with the spectral model."""
    from cases import find_case
    from cases.parameters import split_settings
    from trisk.cli.reference import make

    chosen = find_case(case, split_settings(settings or ()))
    make(chosen, days or (), truncation, damping_hours, output, _command_line(), quiet)


@app.command()
def compare(
    run_directories: Annotated[list[Path], typer.Argument(help="Directories of runs of one case, on any meshes.")],
    reference: Annotated[
        str,
        typer.Option(
            "--reference",
            help="exact, a file of a spectral reference, or a run directory; auto is the exact solution, else the "
            "reference that comes with the case, else the first run.",
        ),
    ] = "auto",
    days: Annotated[
        list[float] | None,
        typer.Option("--day", help="Day to compare, repeatable; by default the last that all have."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for maps of the last day; by default figures of the first run."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Compare runs with a solution or with each other.

    Prints error norms and what was conserved, and draws maps.
    """
    from postprocess.compare.comparison import compare_runs, comparison_record
    from postprocess.figures.compare_maps import write_maps
    from postprocess.runs.folders import require_possible_folder
    from swe.output.files import FIGURES_FOLDER
    from trisk.cli.comparison_table import print_comparison

    folder = output or run_directories[0] / FIGURES_FOLDER
    require_possible_folder(folder)
    comparison = compare_runs(*run_directories, reference=reference, days=days or ())
    if not as_json:
        print_comparison(comparison)
    maps = write_maps(comparison, folder)
    if as_json:
        typer.echo(json.dumps({**comparison_record(comparison), "maps": [str(path) for path in maps]}))
        return
    for path in maps:
        typer.echo(path)


@app.command()
def bench(
    cells: Annotated[
        list[int] | None,
        typer.Option("--cells", metavar="N", help="Number of cells, repeatable; by default 10242 and 40962."),
    ] = None,
    mesh_file: Annotated[Path | None, typer.Option("--mesh", help="Time on this mesh instead.")] = None,
    recompute_metrics: Recompute = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print a list of JSON objects.")] = False,
    quiet: Quiet = False,
) -> None:
    """Time the solver.

    Tells the cost of a step of test case 5, beside plain loops and beside what the memory could do.
    """
    from trisk.cli.bench import print_timings, timings

    results = timings(mesh_file, cells or (), recompute_metrics, show=not quiet)
    if as_json:
        typer.echo(json.dumps([asdict(timing) for timing in results]))
    else:
        print_timings(results)


def _command_line() -> str:
    from mesh.safe_files import name_in_text

    return name_in_text(shlex.join(["trisk", *sys.argv[1:]]))


def _warning_line(message: Warning | str, *_: object) -> str:
    return f"warning: {message}\n"


def main() -> None:
    """Run the command line; exit with 0 when done, 1 where a run failed, 2 on bad input."""
    warnings.formatwarning = _warning_line  # type: ignore[assignment]
    # Overflows and the like come of wrong input, which is told of by an error.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files may hold any bytes
    if sys.stderr is not None:
        sys.stderr = cast(TextIO, ErrorOutput(sys.stderr))
    try:
        _call_app()
    except BrokenPipeError:
        sys.exit(STOPPED + signal.SIGPIPE)
    except Exception as error:
        code = _exit_code(error)
        if code is None:
            raise
        typer.echo(f"error: {_in_one_line(error)}", err=True)
        sys.exit(code)


def _call_app() -> None:
    """Run the command and write out what it printed; raise `OSError` where the output takes no more."""
    try:
        try:
            app()
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except SystemExit as stop:
        # Typer ends with a code of its own where the reader of a pipe has gone.
        if isinstance(stop.__context__, BrokenPipeError):
            _drop_output()
            raise stop.__context__ from None
        raise
    except OSError as error:
        if error.filename is None and error.errno in ERRORS_OF_OUTPUT:
            _drop_output()
        raise


def _drop_output() -> None:
    """Let the interpreter not try once more, at its end, to write what cannot be written."""
    with suppress(OSError, ValueError, AttributeError), open(os.devnull, "wb") as nothing:
        os.dup2(nothing.fileno(), sys.stdout.fileno())


def _exit_code(error: Exception) -> int | None:
    """Exit code for a foreseen error; None for a fault of this program."""
    if isinstance(error, OSError):
        return BAD_INPUT if error.errno in ERRORS_OF_PATHS else RUN_FAILED
    from mesh import MeshError
    from swe.errors import InputError, RunError, RunStopped

    if isinstance(error, RunStopped):
        return STOPPED + error.signal
    if isinstance(error, MeshError | InputError) or NO_THREADING_LAYER in str(error):
        return BAD_INPUT
    if isinstance(error, RunError | MemoryError):
        return RUN_FAILED
    return None


def _in_one_line(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return f"the machine has not enough memory for this ({error}); ask for fewer cells"
    if isinstance(error, OSError) and error.filename is None and error.errno in ERRORS_OF_OUTPUT:
        return f"the output cannot be written ({error.strerror}); send it elsewhere, or make room"
    if isinstance(error, OSError) and error.strerror:
        what = "" if error.filename is None else f"{error.filename}: "
        return f"{what}{error.strerror}".replace("\n", " ")
    return str(error).replace("\n", " ")

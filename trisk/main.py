"""The `trisk` command: the app of all commands, its streams, and errors as one line and an exit code."""

import errno
import io
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import TextIO, cast

import typer

from trisk.cli import adapt, bench, cases, reference, run, study
from trisk.mesh_cli import cull, mesh, partition, quality
from trisk.processes.launch import launch_of
from trisk.processes.together import run_together
from trisk.report.streams import ErrorOutput
from trisk.results_cli import compare, convert, film, plot, spectra, view

COMMANDS = (
    *(mesh.mesh, cull.cull, quality.quality, partition.partition, run.run, cases.cases),
    *(plot.plot, view.view, film.film, convert.convert, spectra.spectra),
    *(reference.reference, compare.compare, adapt.adapt, bench.bench),
)
"""In the order of the help."""


def app_of(commands: Iterable[Callable[..., None]]) -> typer.Typer:
    """The app of `commands`, each called as its function is, and of the studies."""
    app = typer.Typer(
        help="Spherical centroidal Voronoi meshes and an energy-conserving shallow-water model on them.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    for command in commands:
        app.command()(command)
    app.add_typer(study.app, name="study")
    return app


app = app_of(COMMANDS)

ERRORS_OF_PATHS = (
    *(errno.ENOENT, errno.EACCES, errno.EPERM, errno.EEXIST, errno.ENOTDIR, errno.EISDIR),
    *(errno.EINVAL, errno.ENAMETOOLONG, errno.ELOOP, errno.EROFS),
)
"""System errors that mean an unusable path."""

ERRORS_OF_OUTPUT = (errno.ENOSPC, errno.EPIPE, errno.EIO, errno.EFBIG, errno.EDQUOT, errno.EBADF)
"""System errors that, without a file name, mean that the output cannot be written."""

NO_THREADING_LAYER = "threading layer could be loaded"
"""Part of numba's message when NUMBA_THREADING_LAYER names a layer that is not installed."""

RUN_FAILED, BAD_INPUT, STOPPED = 1, 2, 128
"""Exit codes; as shells do, the number of the signal is added to the last."""


def _warning_line(message: Warning | str, *_: object) -> str:
    return f"warning: {message}\n"


def main() -> None:
    """Run the command line; exit with 0 when done, 1 if a run failed, 2 on bad input."""
    warnings.formatwarning = _warning_line  # type: ignore[assignment]
    # Overflows and the like come from bad input, which an error reports.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # file names may hold any bytes
    if sys.stderr is not None:
        sys.stderr = cast(TextIO, ErrorOutput(sys.stderr))
    launch = launch_of()
    if launch.size == 1:
        _reported(_call_app)
    else:
        _reported(lambda: run_together(lambda: _reported(_call_app), launch))


def _reported(action: Callable[[], None]) -> None:
    """Call `action`; exit with a line and a code if it fails in a foreseen way."""
    try:
        action()
    except BrokenPipeError:
        sys.exit(STOPPED + signal.SIGPIPE)
    except Exception as error:
        code = _exit_code(error)
        if code is None:
            raise
        typer.echo(f"error: {_in_one_line(error)}", err=True)
        sys.exit(code)


def _call_app() -> None:
    """Run the command and flush its output; raise `OSError` if that cannot be written."""
    try:
        try:
            app()
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except SystemExit as stop:
        # Typer exits with its own code when the reader of a pipe has gone.
        if isinstance(stop.__context__, BrokenPipeError):
            _drop_output()
            raise stop.__context__ from None
        raise
    except OSError as error:
        if error.filename is None and error.errno in ERRORS_OF_OUTPUT:
            _drop_output()
        raise


def _drop_output() -> None:
    """Keep the interpreter from trying again, at exit, to write what cannot be written."""
    with suppress(OSError, ValueError, AttributeError), open(os.devnull, "wb") as nothing:
        os.dup2(nothing.fileno(), sys.stdout.fileno())


def _exit_code(error: Exception) -> int | None:
    """Exit code for a foreseen error; None for a bug."""
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

"""Conversion of a run to one of the formats of other programs."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mesh.safe_files import AnyPath, place_of
from postprocess.convert.contents import Contents, contents_of
from postprocess.convert.ugrid import write_ugrid
from postprocess.convert.vtk_series import PATTERNS, write_vtk
from postprocess.convert.whole_folder import require_replaceable_folder
from postprocess.runs.folders import require_possible_file
from postprocess.runs.reading import Progress, read_run
from swe.errors import InputError
from swe.output.recorder import FILES


@dataclass(frozen=True)
class Format:
    """A format: how it is written, and the patterns of names in the folder that it is, none if it is a file."""

    write: Callable[[Contents, Path, str, Progress], list[Path]]
    patterns: tuple[str, ...] = ()


FORMATS = {"ugrid": Format(write_ugrid), "vtk": Format(write_vtk, PATTERNS)}


def convert_run(
    directory: AnyPath,
    to: str,
    output: AnyPath,
    force: bool = False,
    history: str = "converted by trisk",
    progress: Progress = lambda what, part: None,
) -> list[Path]:
    """Write a run in one of `FORMATS` to the file or folder `output`, snapshot by snapshot; return what to open.

    `history` says how the file was made. With `force`, an earlier result is replaced, once the new one is whole.

    Raises `InputError` where there is no such format or no readable run, or `output` cannot be written or exists, and
    `RunError` where writing fails.
    """
    if to not in FORMATS:
        raise InputError(f"there is no format named '{to}' to convert to; choose one of {', '.join(FORMATS)}")
    directory, output = Path(directory), Path(output)
    _require_possible(output, FORMATS[to], force)
    _require_other_place(output, directory)
    return FORMATS[to].write(contents_of(read_run(directory)), output, history, progress)


def _require_possible(output: Path, chosen: Format, force: bool) -> None:
    """Raise `InputError` unless the result can stand at `output`."""
    if output.exists() and not force:
        raise InputError(f"{output} exists already; choose another place, or replace it (--force)")
    if not chosen.patterns:
        require_possible_file(output)
        return
    if not place_of(output).parent.is_dir():
        raise InputError(f"{output} cannot be written, as there is no such folder; choose another place")
    require_replaceable_folder(output, chosen.patterns)


def _require_other_place(output: Path, directory: Path) -> None:
    """Raise `InputError` where the result would replace a file of the run."""
    if output.resolve() in [(directory / name).resolve() for name in FILES]:
        raise InputError(f"{output} is a file of the run itself; choose another place")

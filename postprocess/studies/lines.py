"""The lines of a study, one for each family of meshes and each scheme, and how tables and figures tell them apart.

Studies with the default scheme alone do not name it; any other is named wherever results are.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast, get_args

from postprocess.studies.study_folder import StudyRow
from swe.configuration import Options, SchemeName
from swe.errors import InputError

STYLES: Sequence[Mapping[str, Any]] = (
    {"linestyle": "-"},
    {"linestyle": "--", "fillstyle": "none"},
    {"linestyle": ":", "fillstyle": "none"},
)
"""Lines and markers of the first scheme of a study, the second, and so on; colours are those of families."""


def chosen_schemes(names: Sequence[str] | None) -> tuple[SchemeName, ...]:
    """The schemes of these names, the default if there are none; raises `InputError` for one that does not exist."""
    known: tuple[SchemeName, ...] = get_args(SchemeName)
    for name in names or ():
        if name not in known:
            raise InputError(f"there is no scheme named '{name}'; choose among {', '.join(known)}")
    return tuple(cast(SchemeName, name) for name in names or (Options.scheme,))


def run_name(name: str, scheme: str) -> str:
    """Name of the folder of a run: that of the scheme is added unless it is the default."""
    return name if scheme == Options.scheme else f"{name}-{scheme}"


def schemes_of(rows: Iterable[StudyRow]) -> list[str]:
    """The schemes of a study in their order."""
    return list(dict.fromkeys(str(row["scheme"]) for row in rows))


def families_of(rows: Iterable[StudyRow]) -> list[str]:
    """The families of a study in their order."""
    return list(dict.fromkeys(str(row["family"]) for row in rows))


def to_be_named(schemes: Iterable[str]) -> bool:
    """Whether results must say which scheme they are of."""
    return any(scheme != Options.scheme for scheme in schemes)


def named(family: str, scheme: str, schemes: Iterable[str]) -> str:
    """What a line is called in a study of these schemes."""
    return f"{family}, {scheme}" if to_be_named(schemes) else family


def lines_of(rows: Sequence[StudyRow]) -> dict[tuple[str, str], list[StudyRow]]:
    """Rows by family and scheme, in their order."""
    lines: dict[tuple[str, str], list[StudyRow]] = {}
    for row in rows:
        lines.setdefault((str(row["family"]), str(row["scheme"])), []).append(row)
    return lines


def heading_with(heading: str, schemes: Sequence[str]) -> str:
    """`heading`, and the scheme if there is but one, which is not the default: lines do not differ by scheme then."""
    return f"{heading}, scheme {schemes[0]}" if len(schemes) == 1 and to_be_named(schemes) else heading

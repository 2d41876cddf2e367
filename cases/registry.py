"""The cases by name."""

from cases.base import Case
from cases.williamson import Williamson2, Williamson5
from swe.errors import SetupError

CASES: dict[str, type[Case]] = {case.name: case for case in (Williamson2, Williamson5)}


def find_case(name: str) -> Case:
    """Return the case called `name`, with the parameters of its paper; raise `SetupError` where there is none."""
    if name not in CASES:
        raise SetupError(f"there is no case named '{name}'; choose one of {', '.join(CASES)}")
    return CASES[name]()

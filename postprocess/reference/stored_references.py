"""Which cases have a spectral reference that comes with the package; asking needs no optional package."""

from pathlib import Path

from cases.registry import CASES

FOLDER = Path(__file__).parent / "stored"
"""Where the references that come with the package are."""


def stored_path(case: str) -> Path | None:
    """The file of the reference of the case of that name; None for a case of a user and where there is no file."""
    if case not in CASES:
        return None
    path = FOLDER / f"{case}.nc"
    return path if path.is_file() else None
